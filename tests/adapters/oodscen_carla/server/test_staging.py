"""A script that knows only CARLA's client finds in a scene what the library does."""

import math
import runpy
from argparse import Namespace
from pathlib import Path

import pytest

from oodscen import simulate
from oodscen.driving._motion.actions import action_driver
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator

carla = pytest.importorskip("carla")

SCRIPT = Path(__file__).parents[4] / "examples" / "carla" / "actions.py"
REACTION = 0.5


@pytest.fixture(scope="module")
def library():
    with FlatSimulator() as simulator:
        return simulate(
            example_scene(), simulator, render=False, traces=True, reaction=(REACTION,), horizon=4.0
        )


@pytest.mark.parametrize(
    "action", ["keep_speed", "emergency_brake", "change_lane_left", "pull_over"]
)
def test_a_script_drives_an_action_as_the_library_does(server, library, action):
    client = carla.Client("127.0.0.1", server.port)
    client.set_timeout(20.0)
    times = Namespace(decision=library.episode.decision_s, horizon=4.0, base=2.7)
    script = runpy.run_path(str(SCRIPT))
    found = script["drive"](client, example_scene().id, action, script["Driver"](REACTION), times)
    expected = library.episode.actions[action]
    assert found["available"] is not expected.unavailable
    if expected.unavailable:
        return
    assert tuple(found["hit"]) == expected.contacts
    assert found["off_road"] == expected.off_road
    x, y = (library.rollouts[action][name][1:, 0].tolist() for name in "xy")
    assert len(found["path"]) == len(x)
    for (a, b, _), *own in zip(found["path"], x, y, strict=True):
        assert math.dist((a, -b), own) < 1e-3


def test_a_script_changes_the_heros_speed_and_the_roads_friction(server):
    client = carla.Client("127.0.0.1", server.port)
    client.set_timeout(20.0)
    script, example = runpy.run_path(str(SCRIPT)), example_scene()
    with FlatSimulator() as simulator:
        library = simulate(example, simulator, render=False, reaction=(REACTION,), horizon=4.0)
        decision = library.episode.decision_s
        times = Namespace(decision=decision, horizon=4.0, base=2.7)
        for action in ("slow_down", "emergency_brake"):
            for friction, speed in ((0.3, 1.0), (1.0, 1.5), (0.9, 0.95)):
                simulator.reset(example, 0)
                for _ in range(round(decision / simulator.dt)):
                    simulator.step(action_driver("keep_speed").act(simulator.observe()))
                passes = simulator.rehearse(
                    action, 4.0, reaction_s=REACTION, friction=friction, speed=speed
                )
                driver = script["Driver"](REACTION, friction, speed)
                found = script["drive"](client, example.id, action, driver, times)
                assert passes is not (bool(found["hit"]) or found["off_road"])
                first, second = found["path"][0], found["path"][1]
                assert second[0] - first[0] == pytest.approx(8.0 * speed * 0.05, abs=0.01)
