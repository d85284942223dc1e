"""Sensors measure in their own axes, at whatever they are attached to."""

import math

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_carla.server._geometry import matrix
from oodscen_carla.server._sensors import SensorSender, aimed
from oodscen_carla.server._values import Transform

from oodscen.driving._motion.bodies import GRAVITY
from oodscen.protocols import Camera, Frame
from oodscen.testing import example_scene

CAR, IMU, CAMERA = "vehicle.tesla.model3", "sensor.other.imu", "sensor.camera.rgb"
COLLISION = "sensor.other.collision"
AHEAD = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
HEADER = 48
GO = [1.0, 0.0, 0.0, False, False, False, 0]
SIZE = Camera(64, 48, 90.0)


class Heard:
    """Streams that keep what is sent."""

    def __init__(self) -> None:
        self.sent: list[tuple[int, bytes]] = []

    def is_heard(self, stream: int) -> bool:
        return True

    def send(self, stream: int, head: bytes, body: bytes = b"") -> None:
        self.sent.append((stream, head))


def attach(served, kind: str, parent: int, mount: list = AHEAD) -> int:
    return served.get("spawn_actor_with_parent", [1, kind, []], mount, parent)[0]


def measured(served, sensor: int, ticks: int = 1) -> list:
    """Return the events of a sensor in the last of some ticks."""
    for _ in range(ticks):
        served.get("tick_cue")
    streams = Heard()
    SensorSender(served.world, None, streams).sense()
    return [msgpack.unpackb(head[HEADER:]) for stream, head in streams.sent if stream == sensor]


@pytest.mark.parametrize("yaw", [0.0, 90.0, 180.0, -37.0])
def test_a_car_that_accelerates_feels_it_ahead_wherever_it_goes(served, yaw):
    car = served.spawn(CAR, 100.0, 1.7, yaw=yaw)
    imu = attach(served, IMU, car)
    served.get("apply_control_to_vehicle", car, GO)
    ((accelerometer, _, compass),) = measured(served, imu, ticks=3)
    assert accelerometer == pytest.approx([3.88, 0.0, GRAVITY], abs=0.05)
    assert math.degrees(compass) == pytest.approx((yaw + 90.0) % 360.0)


@pytest.mark.parametrize(
    ("rotation", "felt"),
    [
        ([0.0, 90.0, 0.0], [0.0, -3.88, GRAVITY]),
        ([90.0, 0.0, 0.0], [GRAVITY, 0.0, -3.88]),
        ([0.0, 0.0, 180.0], [3.88, 0.0, -GRAVITY]),
    ],
)
def test_a_mount_turns_what_an_imu_feels(served, rotation, felt):
    car = served.spawn(CAR, 100.0, 1.7, yaw=30.0)
    imu = attach(served, IMU, car, [[0.0, 0.0, 0.0], rotation])
    served.get("apply_control_to_vehicle", car, GO)
    ((accelerometer, *_),) = measured(served, imu, ticks=3)
    assert accelerometer == pytest.approx(felt, abs=0.05)


def test_an_imu_on_a_camera_on_a_car_moves_with_the_car(served):
    car = served.spawn(CAR, 100.0, 1.7)
    imu = attach(served, IMU, attach(served, CAMERA, car))
    assert served.world.carrier_of(served.world.actors[imu]).id == car


def test_nothing_is_attached_to_no_actor(served):
    message = served.error("spawn_actor_with_parent", [1, IMU, []], AHEAD, 0)
    assert "parent actor not found" in message


def test_a_crash_is_sent_with_its_impulse(served):
    car, wall = served.spawn(CAR, 100.0, 1.7), served.spawn("static.prop.haybale", 103.5, 1.7)
    collisions = attach(served, COLLISION, car)
    served.get("apply_control_to_vehicle", car, GO)
    served.world.actors[car].speed = 20.0
    ((actor, other, impulse),) = measured(served, collisions)
    assert (actor[0], other[0]) == (car, wall)
    assert impulse == pytest.approx([30_000.0, 0.0, 0.0], rel=0.02)


@pytest.mark.parametrize("size", ["0", "-1", "4097", "x", "800.5"])
def test_a_picture_of_no_size_is_refused_in_words(served, size):
    message = served.error("spawn_actor", [1, CAMERA, [["image_size_x", 4, size]]], AHEAD)
    assert "1 to 4096 pixels" in message or "must be whole numbers" in message


def ways(view) -> list[list[float]]:
    """Return where a camera looks, and its right, in CARLA's axes."""
    x, y, z, yaw = view.mount
    rotation = (
        -view.camera.pitch_deg,
        -math.degrees(yaw) - view.camera.yaw_deg,
        view.roll_deg,
    )
    return matrix(Transform((x, y, z), rotation))[:3, :2].T.tolist()


@given(
    st.floats(-360.0, 360.0),
    st.floats(-180.0, 180.0),
    st.sampled_from((0.0, 20.0)),
    st.booleans(),
)
def test_a_camera_looks_where_it_is_turned_to(pitch, yaw, roll, is_mounted):
    place = Transform((0.0, 0.0, 0.0), (pitch, yaw, roll))
    view = aimed(SIZE, place, place, (0.0,) * 4 if is_mounted else None, 0.0)
    for found, expected in zip(ways(view), matrix(place)[:3, :2].T.tolist(), strict=True):
        assert found == pytest.approx(expected, abs=1e-6)


class Looking:
    """A renderer that keeps the views it is asked for."""

    def __init__(self) -> None:
        self.views: list = []

    def take(self, scene, seed, shown, view, *, has_host):
        self.views.append(view)
        frame = Frame(
            rgb=np.zeros((600, 800, 3), np.uint8),
            depth=np.ones((600, 800), np.float32),
            ids=np.zeros((600, 800), np.int32),
        )
        return frame, np.zeros(len(shown) + 1, np.int32)


def test_a_camera_on_what_a_tilted_vehicle_carries_is_tilted(served):
    car = served.spawn(CAR, 100.0, 1.7)
    served.world.actors[car].place = Transform((100.0, 1.7, 0.5), (20.0, 0.0, 0.0))
    carried = attach(served, CAR, car, [[0.0, 0.0, 2.0], [0.0, 0.0, 0.0]])
    camera = served.world.actors[attach(served, CAMERA, carried)]
    renderer = Looking()
    SensorSender(served.world, renderer, Heard()).sense()
    expected = matrix(served.world.place_of(camera))[:3, :2].T
    assert np.allclose(ways(renderer.views[0]), expected, atol=1e-6)


@pytest.mark.parametrize(
    ("tick", "step", "rate"),
    [(0.12, 0.05, 1 / 0.12), (0.03, 0.02, 1 / 0.03), (0.1, 0.05, 10.0), (0.01, 0.05, 20.0)],
)
def test_a_sensor_sends_as_often_as_its_tick_asks(served, tick, step, rate):
    car = served.spawn(CAR, 100.0, 1.7)
    imu = served.world.actors[attach(served, IMU, car)]
    imu.attributes["sensor_tick"] = str(tick)
    streams = Heard()
    sender = SensorSender(served.world, None, streams)
    for index in range(601):
        served.world.time = index * step
        sender.sense()
    assert len(streams.sent) == pytest.approx(600 * step * rate, abs=2)


ROLES = (
    "ego",
    "Ego",
    "hero",
    "npc",
    "npc",
    "a26",
    "x" * 50,
    "",
    "default",
    "é",
    "-",
    "1",
    "none",
    "nan",
)


def test_lit_vehicles_of_any_roles_make_a_scene_and_no_two_have_one_name(served):
    for index, role in enumerate(ROLES):
        car = served.spawn(CAR, 10.0 + 8.0 * index, 1.7, role_name=role)
        served.get("set_vehicle_light_state", car, 3)
    lit = served.world.scene().actors
    assert len({actor.id for actor in lit}) == len(lit) == len(ROLES)
    assert {"hero", "npc", "1"} <= {actor.id for actor in lit}
    assert {body.name for body in served.world.bodies()} == {actor.id for actor in lit}


def test_a_clients_actor_has_no_name_of_a_staged_one(staged):
    (name,) = (actor.id for actor in example_scene().actors)
    car = staged.spawn(CAR, 300.0, 1.7, role_name=name)
    names = [body.name for body in staged.world.bodies()]
    assert names == ["ego", name, f"a{car}"]
