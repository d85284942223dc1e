"""Scenes that a CARLA client shows are those of every other simulator; nothing stays behind."""

import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from oodscen_carla import CarlaSimulator, load_catalogue
from oodscen_carla import _connection as connection
from oodscen_carla._blueprints import blueprint_of, own_id
from oodscen_carla.server import CarlaTestServer
from oodscen_pybullet import PyBulletSimulator
from oodscen_pybullet._meshes.tags import Tag

from oodscen import simulate
from oodscen.data import Actor, Behaviour, Placement, Weather
from oodscen.errors import SceneError, SimulatorError, SpawnError, UsageError
from oodscen.protocols import Camera, Control
from oodscen.testing import check_simulator, example_scene
from oodscen.testing._flat import FlatSimulator

carla = pytest.importorskip("carla")

CAMERA = Camera(width=160, height=120)
SCENE = example_scene()


@pytest.fixture(scope="module")
def server():
    with CarlaTestServer() as made:
        yield made


@pytest.fixture
def simulator(server):
    with CarlaSimulator(server.address, catalogue="flat") as made:
        yield made


def rounded(kind: type) -> object:
    """Return a simulator whose poses are rounded as the 32-bit floats of the wire are."""

    class Rounded(kind):
        def place(self, poses, speeds):
            wire = poses.copy()
            wire[:, :3] = poses[:, :3].astype(np.float32)
            degrees = [float(np.float32(-math.degrees(yaw))) for yaw in poses[:, 3]]
            wire[:, 3] = [-math.radians(angle) for angle in degrees]
            super().place(wire, speeds)

    return Rounded()


def frames(simulator, scene, steps: int = 8) -> list:
    simulator.reset(scene, 0)
    found = []
    for _ in range(steps):
        simulator.step(Control(acceleration=-1.5, steering=0.01))
        found.append(simulator.render(CAMERA))
    return found


def test_episodes_equal_those_of_another_simulator(simulator):
    with FlatSimulator() as flat:
        expected, found = simulate(SCENE, flat).episode, simulate(SCENE, simulator).episode
    assert found.safe_set == expected.safe_set
    assert found.trace_sha256 == expected.trace_sha256


def test_frames_equal_those_of_the_simulator_that_draws(simulator):
    with rounded(FlatSimulator) as flat:
        for mine, other in zip(frames(simulator, SCENE), frames(flat, SCENE), strict=True):
            assert np.array_equal(mine.rgb, other.rgb)
            assert np.array_equal(mine.ids, other.ids)
            near = other.depth < 999.9
            assert np.abs(mine.depth[near] - other.depth[near]).max() < 1e-3
            assert np.isinf(mine.depth[~near]).all()


QUEUE = tuple(
    Actor(
        id=name,
        asset="car",
        placement=Placement(ahead_m=ahead, lane=max(lane, 0), offset_m=min(3.4 * lane, 0.0)),
        behaviour=Behaviour(name=behaviour, parameters=given),
    )
    for name, ahead, lane, behaviour, given in (
        ("waits", 40.0, 0, "follow_lane", {"speed": 0.0}),
        ("comes", 60.0, 1, "follow_lane", {"speed": 8.0}),
        ("parks", 30.0, -1, "stand", {}),
    )
)
SEEN = (
    Weather(precipitation="rain", precipitation_mm_h=8.0, cloud_cover=0.9, friction=0.7),
    Weather(sun_elevation_deg=-20.0),
    Weather(sun_elevation_deg=-12.0, precipitation="snow", precipitation_mm_h=2.0, friction=0.4),
    Weather(fog_visual_range_m=80.0, sun_elevation_deg=4.0),
)


def test_a_scene_that_the_server_has_staged_is_in_no_picture():
    night = SCENE.model_copy(update={"weather": Weather(sun_elevation_deg=-20.0)})
    with (
        CarlaTestServer([SCENE]) as server,
        CarlaSimulator(server.address, catalogue="flat") as simulator,
        rounded(FlatSimulator) as flat,
    ):
        for scene in (SCENE, night):
            pairs = zip(frames(simulator, scene), frames(flat, scene), strict=True)
            assert all(np.array_equal(mine.rgb, other.rgb) for mine, other in pairs)


def test_frames_equal_those_of_pybullet():
    with (
        CarlaTestServer(simulator="pybullet") as server,
        CarlaSimulator(server.address, catalogue="pybullet") as mine,
        rounded(PyBulletSimulator) as other,
    ):
        queued = SCENE.model_copy(update={"actors": QUEUE})
        scenes = [SCENE, *(queued.model_copy(update={"weather": one}) for one in SEEN)]
        for scene in scenes:
            for one, two in zip(frames(mine, scene, 2), frames(other, scene, 2), strict=True):
                assert np.array_equal(one.rgb, two.rgb), scene.weather
                assert np.array_equal(one.ids, two.ids)
                assert np.array_equal(one.tags, two.tags)
                assert {Tag.ROADS, Tag.ROAD_LINES, Tag.SKY} <= set(one.tags.ravel())


def test_it_keeps_the_promises_of_the_protocol(server):
    made = partial(CarlaSimulator, server.address)
    parts = ("catalogue", "weather", "controls", "snapshot", "frames", "turning", "refusals")
    check_simulator(made, parts=parts)


def test_nothing_is_left_on_the_server(server):
    client = carla.Client("127.0.0.1", server.port)
    client.set_timeout(20.0)
    before = client.get_world().get_settings()
    with CarlaSimulator(server.address, catalogue="flat") as simulator:
        frames(simulator, SCENE)
        assert client.get_world().get_settings().synchronous_mode
        assert len(client.get_world().get_actors().filter("vehicle.*"))
    world = client.get_world()
    client.get_world().wait_for_tick(20.0)
    assert [one.type_id for one in world.get_actors()] == ["spectator"]
    assert world.get_settings().synchronous_mode == before.synchronous_mode


def test_the_world_of_another_client_keeps_its_settings(server):
    client = carla.Client("127.0.0.1", server.port)
    client.set_timeout(20.0)
    with CarlaSimulator(server.address, catalogue="flat") as simulator:
        frames(simulator, SCENE, 1)
        world = client.load_world("urban_avenue")
        before, settings = world.get_settings(), world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.04
        world.apply_settings(settings)
    kept = world.get_settings()
    world.apply_settings(before)
    assert (kept.synchronous_mode, kept.fixed_delta_seconds) == (True, pytest.approx(0.04))


@pytest.mark.parametrize("fault", ["late", "drop"])
def test_pictures_that_come_late_or_never_are_the_right_ones(server, fault):
    with (
        rounded(FlatSimulator) as flat,
        CarlaSimulator(server.address, catalogue="flat", timeout_s=3.0) as simulator,
    ):
        simulator.reset(SCENE, 0)
        simulator.render(CAMERA)
        server.fault(fault, after=2)
        mine, other = frames(simulator, SCENE, 4), frames(flat, SCENE, 4)
        assert all(np.array_equal(a.rgb, b.rgb) for a, b in zip(mine, other, strict=True))


def test_a_server_that_is_restarted_is_found_again():
    with CarlaTestServer() as first:
        folder = Path(first._folder.name)
        assert list(folder.glob("oodscen-carla-*"))
        simulator = CarlaSimulator(first.address, catalogue="flat", timeout_s=2.0)
        simulator.reset(SCENE, 0)
        first.fault("die")
        with pytest.raises(SimulatorError, match="failed to"):
            simulator.step(Control())
        assert not first.is_alive
    assert not folder.exists()
    with CarlaTestServer(port=first.port):
        assert simulator.reset(SCENE, 0).ids[0] == "ego"
        simulator.close()
    simulator.close()


def test_a_missing_server_and_other_versions_are_refused(server, monkeypatch):
    with pytest.raises(SimulatorError, match="failed to connect"):
        CarlaSimulator("127.0.0.1:9", timeout_s=0.2).reset(example_on_town(), 0)
    for address in ("localhost", "host:port", "host:99999", ":2000"):
        with pytest.raises(UsageError, match="host:port"):
            CarlaSimulator(address)
    monkeypatch.setattr(connection, "VERSION", "0.9.14")
    with pytest.raises(SimulatorError, match=r"version 0\.9\.16"):
        CarlaSimulator(server.address).reset(example_on_town(), 0)


def example_on_town():
    """Return the example with a blueprint of CARLA's own catalogue."""
    actors = tuple(
        actor.model_copy(update={"asset": "static.prop.box01"}) for actor in SCENE.actors
    )
    return SCENE.model_copy(update={"actors": actors})


def test_the_servers_own_map_is_kept(server, tmp_path):
    file = tmp_path / "town.xodr"
    with CarlaSimulator(server.address) as simulator:
        simulator.save_map(file)
        scene = example_on_town().model_copy(update={"map": str(file)})
        state = simulator.reset(scene, 0)
        assert state.ids[0] == "ego"
        client = carla.Client("127.0.0.1", server.port)
        client.set_timeout(20.0)
        assert client.get_world().get_map().to_opendrive() == file.read_text()


def test_an_unknown_blueprint_is_refused(simulator, monkeypatch):
    monkeypatch.setattr(connection.Connection, "blueprints", frozenset({"walker.pedestrian.0001"}))
    with pytest.raises((SpawnError, SceneError), match="no blueprint"):
        simulator.reset(SCENE, 0)


def test_assets_get_the_blueprint_of_the_same_thing_or_of_their_size():
    known = load_catalogue()
    offered = {asset.id for asset in known.assets}
    wanted = PyBulletSimulator().catalogue().assets
    chosen = {one.id: blueprint_of(one, offered, known.assets) for one in wanted}
    assert chosen["fire_truck"] == "vehicle.carlamotors.firetruck"
    assert chosen["ambulance"] == "vehicle.ford.ambulance"
    for one in wanted:
        if one.category in ("vehicle", "cyclist", "pedestrian"):
            assert (chosen[one.id] or "").split(".")[0] == own_id(one).split(".")[0]
    assert None not in chosen.values()
