"""Figures of a drive: its jerk is that of its accelerations, however its steps are spaced."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._trace import Trace
from oodscen.stages._safe_actions import peak_jerk

STEPS = st.lists(st.floats(0.01, 0.03), min_size=50, max_size=90)


def drive(steps: list[float], jerk: float) -> Trace:
    """Return the times and accelerations of a drive with a constant jerk."""
    time = np.cumsum([0.0, *steps])[:, None]
    return Trace(("ego",), {"time": time, "acceleration": jerk * time})


@given(STEPS, st.floats(-9.0, 9.0))
def test_the_jerk_of_a_recording_with_uneven_steps_is_its_own(steps, jerk):
    assert peak_jerk(drive(steps, jerk)) == pytest.approx(abs(jerk), abs=1e-3)


@given(st.lists(st.floats(0.05, 0.1), max_size=2))
def test_a_trace_shorter_than_jerks_are_measured_over_has_none(steps):
    assert peak_jerk(drive(steps, 1.0)) is None
