"""Recorded runs: what is derived from their poses."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scene import Trigger
from oodscen.interchange._recording import RecordedRun
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._scenes import example_scene

SPEEDS = st.floats(-50.0, 50.0)


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


def test_a_run_that_ends_before_the_decision_has_no_action():
    scene = example_scene()
    (exact,) = scene.to_openscenario(FLAT_CATALOGUE, action="stop").notes
    assert "the ego's action stop from" in exact
    late = scene.model_copy(update={"decision": Trigger(kind="time", value=60.0)})
    (exact,) = late.to_openscenario(FLAT_CATALOGUE, action="stop").notes
    assert "before its action" in exact
