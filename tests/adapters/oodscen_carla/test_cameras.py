"""The cameras of a client: which pixels are bodies, which pictures belong to a tick, and what is left on the server."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_carla._cameras import DEPTH_CODES, FARTHEST_M, KINDS, Cameras, decode

from oodscen.protocols import Camera

PIXEL = Camera(width=1, height=1)
CAR, BUILDING, STATIC, SKY = 14, 3, 20, 11


def pictures(number: int = 0, tag: int = 0, code: int = 0, rgb: tuple = (1, 2, 3)) -> dict:
    """Return three pictures of one pixel, in CARLA's format: blue, green, red, alpha."""
    red, green, blue = rgb
    pixels = {
        "rgb": (blue, green, red, 255),
        "depth": (code >> 16, code >> 8 & 255, code & 255, 255),
        "instance_segmentation": (number >> 8 & 255, number & 255, tag, 255),
    }
    return {kind: SimpleNamespace(raw_data=bytes(pixel)) for kind, pixel in pixels.items()}


def seen(number: int, tag: int, ids: list[int], tags: list) -> tuple[int, int]:
    """Return row and tag of the only pixel."""
    frame = decode(pictures(number, tag), PIXEL, ids, tags)
    return int(frame.ids[0, 0]), int(frame.tags[0, 0])


@given(st.lists(st.integers(1, 2**32 - 1), min_size=1, max_size=5, unique_by=lambda n: n % 65536))
def test_a_pixel_with_an_actors_id_and_tag_is_its_body(ids):
    for row, number in enumerate(ids, start=1):
        assert seen(number, CAR, ids, [{CAR}] * len(ids)) == (row, 0)


@given(st.integers(0, 65535), st.integers(1, 65535), st.integers(1, 255))
def test_scenery_is_no_body_even_with_the_number_of_one(number, other, tag):
    row, shown = seen(number, tag, [number], [{CAR}])
    assert (row, shown) == ((1, 0) if tag == CAR else (0, tag))
    if other != number:
        assert seen(number, CAR, [other], [{CAR}]) == (0, CAR)


def test_a_body_may_have_several_tags_or_none_that_is_known():
    assert seen(24, 13, [24], [{13, 18}]) == (1, 0)
    assert seen(24, BUILDING, [24], [{13, 18}]) == (0, BUILDING)
    assert seen(24, 0, [24], [{CAR}]) == (1, 0)
    assert seen(24, STATIC, [24], [set()]) == (1, 0)


@given(st.integers(0, DEPTH_CODES), st.tuples(*[st.integers(0, 255)] * 3))
def test_depth_and_colours_are_those_of_the_pictures(code, rgb):
    frame = decode(pictures(code=code, rgb=rgb, tag=SKY), PIXEL, [], [])
    depth = code * FARTHEST_M / DEPTH_CODES
    expected = depth if depth < FARTHEST_M - 0.01 else np.inf
    assert frame.depth[0, 0] == np.float32(expected)
    assert frame.rgb[0, 0].tolist() == list(rgb)
    assert frame.tags[0, 0] == SKY
    assert frame.rgb.flags["C_CONTIGUOUS"]


class Sensor:
    """A camera on a server that may refuse to destroy it."""

    def __init__(self, number: int) -> None:
        self.id, self.is_gone, self.is_stuck, self.put = number, False, False, None

    def listen(self, put) -> None:
        self.put = put

    def stop(self) -> None:
        self.put = None

    def destroy(self) -> None:
        assert self.put is None, "a camera that listens when it is destroyed ends the process"
        if self.is_stuck:
            raise RuntimeError("time-out")
        self.is_gone = True


class Server:
    """A world that spawns sensors, and the client's module."""

    def __init__(self) -> None:
        self.sensors: list[Sensor] = []
        blueprint = SimpleNamespace(set_attribute=lambda *_: None)
        library = SimpleNamespace(find=lambda _: blueprint)
        self.world = SimpleNamespace(get_blueprint_library=lambda: library, spawn_actor=self._spawn)
        self.carla = SimpleNamespace(
            **dict.fromkeys(("Transform", "Location", "Rotation"), lambda *_, **__: None)
        )

    def _spawn(self, *_, **__) -> Sensor:
        self.sensors.append(Sensor(len(self.sensors) + 1))
        return self.sensors[-1]

    @property
    def left(self) -> list[int]:
        return [sensor.id for sensor in self.sensors if not sensor.is_gone]

    def mount(self, cameras: Cameras, camera: Camera = PIXEL) -> None:
        cameras.mount(self.carla, self.world, SimpleNamespace(id=7), camera)


@pytest.fixture
def server() -> Server:
    return Server()


@pytest.fixture
def cameras(server) -> Cameras:
    made = Cameras()
    server.mount(made)
    return made


def send(server: Server, *frames: int) -> None:
    """Send the pictures of some ticks to every camera that listens."""
    for sensor in server.sensors:
        for frame in frames:
            if sensor.put is not None:
                sensor.put(SimpleNamespace(frame=frame))


def found(cameras: Cameras, tick: int) -> list[int] | None:
    pictures = cameras.pictures(tick, 0.01)
    return None if pictures is None else [pictures[kind].frame for kind in KINDS]


def test_the_pictures_of_a_tick_are_found_behind_older_ones(server, cameras):
    cameras.listen()
    send(server, 1, 2, 3)
    assert found(cameras, 3) == [3, 3, 3]
    assert found(cameras, 3) is None


def test_a_tick_whose_picture_is_lost_or_passed_has_none(server, cameras):
    cameras.listen()
    send(server, 5)
    assert found(cameras, 4) is None
    server.sensors[2].stop()
    send(server, 6)
    assert found(cameras, 6) is None


def test_pictures_from_before_a_sleep_are_not_those_of_a_later_tick(server, cameras):
    cameras.listen()
    send(server, 1)
    cameras.sleep()
    send(server, 2)
    cameras.listen()
    send(server, 3)
    assert found(cameras, 3) == [3, 3, 3]


def test_new_cameras_replace_the_old_ones(server, cameras):
    cameras.listen()
    server.mount(cameras)
    assert cameras.ids == server.left == [4, 5, 6]
    assert not cameras.is_listening


@pytest.mark.parametrize("stuck", [1, 2, 3])
def test_a_camera_that_cannot_be_destroyed_stays_known(server, cameras, stuck):
    camera = server.sensors[stuck - 1]
    camera.is_stuck = True
    with pytest.raises(RuntimeError):
        server.mount(cameras)
    assert cameras.ids == server.left
    assert not cameras.are_mounted(SimpleNamespace(id=7), PIXEL)
    camera.is_stuck = False
    server.mount(cameras)
    assert cameras.ids == server.left == [4, 5, 6]
    assert cameras.are_mounted(SimpleNamespace(id=7), PIXEL)
