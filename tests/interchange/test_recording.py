"""Recorded runs: what is derived from their poses, and the simulators that they come from."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scene import Scene, Trigger
from oodscen.driving._exclusive import exclusive
from oodscen.errors import SimulatorCrash, UnknownComponent, UsageError
from oodscen.interchange._recording import RecordedRun, ordinary_twin
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

SPEEDS = st.floats(-50.0, 50.0)
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


@given(st.integers(3, 20), SPEEDS, st.floats(-9.0, 9.0))
def test_even_acceleration_has_its_velocities_and_itself_at_every_step(steps, speed, acceleration):
    time = 0.05 * np.arange(steps)
    poses = np.zeros((steps, 1, 4))
    poses[:, 0, 1] = speed * time + 0.5 * acceleration * time**2
    along = speed + acceleration * time
    run = RecordedRun(("ego",), time, poses, along[:, None], np.zeros((steps, 1, 2)))
    np.testing.assert_allclose(run.velocities[:, 0, 1], along, atol=1e-9)
    np.testing.assert_allclose(run.rates(run.velocities)[:, 0, 1], acceleration, atol=1e-7)


@given(st.sampled_from([1, 2]), SPEEDS)
def test_a_run_of_a_step_or_two_has_its_speed(steps, speed):
    time = 0.05 * np.arange(steps)
    poses = np.zeros((steps, 1, 4))
    poses[:, 0, 0] = speed * time
    run = RecordedRun(("ego",), time, poses, np.full((steps, 1), speed), np.zeros((steps, 1, 2)))
    np.testing.assert_allclose(run.velocities[:, 0, 0], speed, atol=1e-9)
    np.testing.assert_allclose(run.rates(run.velocities), 0.0, atol=1e-7)


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


def test_a_run_that_ends_before_the_decision_has_no_action(scene):
    (exact,) = scene.to_openscenario(FLAT_CATALOGUE, action="stop").notes
    assert "the ego's action stop from" in exact
    late = scene.model_copy(update={"decision": Trigger(kind="time", value=60.0)})
    (exact,) = late.to_openscenario(FLAT_CATALOGUE, action="stop").notes
    assert "before its action" in exact
