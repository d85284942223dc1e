"""Simulators that are lent for runs: what they raise is named, and no two threads use one."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from oodscen.data._scene import Scene
from oodscen.driving._exclusive import exclusive
from oodscen.errors import SimulatorCrash, UnknownComponent, UsageError
from oodscen.interchange._recording import ordinary_twin
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

WRITING = pytest.mark.parametrize(
    "write",
    [
        lambda scene, simulator: scene.to_osi(FLAT_CATALOGUE, simulator=simulator),
        lambda scene, simulator: scene.to_openscenario(FLAT_CATALOGUE, simulator=simulator),
        lambda scene, simulator: ordinary_twin(scene, FLAT_CATALOGUE, simulator=simulator),
    ],
)


class OwnSimulator(FlatSimulator):
    """Has a motion of its own, so that files hold its run and not the kinematic world's."""

    steps = 10_000

    def step(self, control):
        self.steps -= 1
        if not self.steps:
            raise RuntimeError("the engine is gone")
        return super().step(control)


@pytest.fixture
def scene():
    return Scene.parse(
        {
            "id": "cone",
            "scenario_id": "cone",
            "map": "urban_three_lane",
            "ego": {"speed": 8.0},
            "actors": [{"id": "cone", "asset": "cone", "placement": {"ahead_m": 40.0}}],
            "hazard": {"actors": {"cone": None}},
            "decision": {"kind": "distance", "value": 25.0, "actor": "cone"},
        }
    )


@WRITING
def test_a_simulator_that_fails_is_named(write, scene):
    simulator = OwnSimulator()
    simulator.steps = 3
    with pytest.raises(SimulatorCrash, match="engine is gone"):
        write(scene, simulator)


@WRITING
def test_no_two_threads_use_one_simulator(write, scene):
    simulator = OwnSimulator()
    with exclusive(simulator), ThreadPoolExecutor(1) as pool:
        written = pool.submit(write, scene, simulator)
    with pytest.raises(UsageError, match="another thread"):
        written.result()
    assert write(scene, simulator)


@pytest.mark.parametrize(
    ("choice", "error"),
    [
        ({"action": "fly"}, UnknownComponent),
        ({"action": "change_lane_right"}, UsageError),
        ({"reaction_s": -1.0}, UsageError),
        ({"seed": -1}, UsageError),
    ],
)
def test_a_choice_that_is_refused_is_no_failure_of_the_simulator(choice, error, scene):
    for write in (scene.to_osi, scene.to_openscenario):
        with pytest.raises(error):
            write(FLAT_CATALOGUE, simulator=OwnSimulator(), **choice)
