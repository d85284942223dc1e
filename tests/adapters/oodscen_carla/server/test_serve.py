"""The server in this process: refusals that name the reason, and an end after the tick at work."""

import socket
import threading
import time

import pytest
from oodscen_carla.server import serve
from oodscen_carla.server._cameras import BodyRenderer, CameraRenderer
from oodscen_carla.server._listener import FREE_RUN_S
from oodscen_carla.server._world import World

from oodscen import make_simulator
from oodscen.errors import SceneError, UsageError
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator

MAPS = [road.id for road in FlatSimulator().catalogue().maps]


def named(*names):
    return [example_scene().model_copy(update={"id": name}) for name in names]


def test_a_simulator_that_draws_from_its_ego_alone_is_refused_and_closed(monkeypatch):
    closed = []
    monkeypatch.delattr(FlatSimulator, "draw_from")
    monkeypatch.setattr(FlatSimulator, "close", lambda simulator: closed.append(simulator))
    with (
        pytest.raises(UsageError, match="'flat' cannot draw for a server"),
        serve(simulator="flat"),
    ):
        pass
    assert len(closed) == 1


@pytest.mark.parametrize("name", ["flat", "pybullet"])
def test_the_simulators_that_draw_from_anywhere_are_known(name):
    with make_simulator(name) as simulator:
        assert isinstance(simulator, BodyRenderer)


@pytest.mark.parametrize("names", [["a", "b", "a"], [MAPS[-1]], ["a", "OpenDriveMap"]])
def test_a_name_that_would_hide_another_is_refused(names):
    with (
        pytest.raises(UsageError, match=f"two maps are called '{names[-1]}'"),
        serve(named(*names), simulator="flat"),
    ):
        pass


def test_every_name_is_served_once_scenes_first():
    with serve(named("b", "a"), simulator="flat") as server:
        assert server.maps[:2] == ("b", "a")
        assert sorted(server.maps[2:]) == sorted(MAPS)


@pytest.mark.parametrize("port", [0, 40_000])
def test_a_host_that_does_not_exist_is_told(port, monkeypatch):
    monkeypatch.delenv(
        "OODSCEN_OFFLINE"
    )  # Once a client was made, the switch would answer for the resolver.
    with pytest.raises(socket.gaierror) as known:
        socket.getaddrinfo("no such host", 0)
    with (
        pytest.raises(UsageError, match="cannot listen on no such host") as found,
        serve(simulator="flat", host="no such host", port=port),
    ):
        pass
    assert str(found.value).endswith(str(known.value))


@pytest.mark.parametrize("host", ["a\0b", "\udc80", "." * 300])
def test_a_host_that_cannot_be_a_name_is_told_and_no_socket_stays_open(host, monkeypatch):
    opened = []

    class Recorded(socket.socket):
        def __init__(self, *arguments, **named):
            super().__init__(*arguments, **named)
            opened.append(self)

    monkeypatch.setattr(socket, "socket", Recorded)
    with pytest.raises(UsageError, match="cannot listen on"), serve(simulator="flat", host=host):
        pass
    assert len(opened) == 2
    assert all(one.fileno() == -1 for one in opened)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        *[({"port": port}, "port must be a whole number") for port in (65_535, 70_000, -5, "5")],
        *[({"seed": seed}, "seed must be a whole number") for seed in ("x", -1, 1.5, True)],
        ({"scenes": example_scene()}, "scenes must be"),
        ({"scenes": ["a"]}, "scenes"),
        ({"host": None}, "host must be"),
        ({"host": ""}, "host is empty"),
    ],
)
def test_an_argument_that_does_not_fit_is_told_at_once(arguments, message):
    with (
        pytest.raises(UsageError, match=message),
        serve(**{"simulator": "flat", **arguments}),
    ):
        pass


def test_no_folder_is_left_if_the_first_scene_cannot_be_staged(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    scene = example_scene().model_copy(update={"map": "nowhere"})
    with pytest.raises(SceneError) as caught, serve([scene], simulator="flat"):
        pass
    assert caught.value.__traceback__  # Keeps what failed alive.
    assert not list(tmp_path.iterdir())


def test_a_port_that_is_taken_is_told():
    with (
        serve(simulator="flat") as first,
        pytest.raises(UsageError, match=f"ports {first.port} and .* in use"),
        serve(simulator="flat", port=first.port),
    ):
        pass


def test_the_simulator_is_closed_after_the_tick_at_work_and_no_tick_follows(monkeypatch):
    events, is_ticking = [], threading.Event()

    def advance(world):
        is_ticking.set()
        time.sleep(2.0 * FREE_RUN_S)
        events.append("tick")

    monkeypatch.setattr(World, "advance", advance)
    monkeypatch.setattr(CameraRenderer, "close", lambda renderer: events.append("close"))
    with (
        serve(simulator="flat") as server,
        socket.create_connection(("127.0.0.1", server.port), 20),
    ):
        assert is_ticking.wait(20.0)
        is_ticking.clear()
        assert is_ticking.wait(20.0)
    time.sleep(4.0 * FREE_RUN_S)
    assert events[-1] == "close"
    assert events.count("tick") == len(events) - 1 >= 2


def test_a_tick_that_fails_does_not_stop_the_clock(monkeypatch, capfd):
    whole, frames = World.advance, []

    def fail_once(world):
        frames.append(world.frame)
        if len(frames) == 1:
            raise ZeroDivisionError
        whole(world)

    monkeypatch.setattr(World, "advance", fail_once)
    with (
        serve(simulator="flat") as server,
        socket.create_connection(("127.0.0.1", server.port), 20),
    ):
        until = time.monotonic() + 20.0
        while len(frames) < 3 and time.monotonic() < until:
            time.sleep(FREE_RUN_S)
    assert len(frames) >= 3
    assert "ZeroDivisionError" in capfd.readouterr().err
