"""Reference drivers see the solid bodies ahead, with speeds along and across the road."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._drivers.perception import WIDTHS_M, Perception
from oodscen.protocols import State


def state(time, bodies, gaps, *, placed=True):
    """Return a state of the ego at the origin, and bodies of (s, t, speed, yaw)."""
    rows = np.array([(0.0, 0.0, 10.0, 0.0), *bodies], np.float64)
    poses = np.stack([rows[:, 0], rows[:, 1], 0.0 * rows[:, 0], rows[:, 3]], axis=1)
    return State(
        step=round(time / 0.05),
        time=time,
        ids=("ego", *(f"b{row}" for row in range(len(bodies)))),
        poses=poses,
        speeds=rows[:, 2],
        gaps=np.array([math.inf, *gaps]),
        off_road=False,
        places=rows[:, :2].copy() if placed else None,
    )


@given(st.floats(-8.0, 8.0), st.floats(1.0, 40.0))
def test_the_gap_along_the_road_is_found_from_the_gap_between_boxes(aside, ahead):
    gap = math.hypot(ahead, max(0.0, abs(aside) - WIDTHS_M))
    (seen,) = Perception().look(state(0.0, [(ahead + 4.7, aside, 0.0, 0.0)], [gap]))
    assert seen.gap == pytest.approx(ahead)
    assert seen.is_in_the_way == (abs(aside) <= WIDTHS_M)


def test_speeds_are_measured_along_and_across_the_road():
    eyes = Perception()
    (first,) = eyes.look(state(0.0, [(30.0, 3.0, 8.0, math.pi / 2)], [25.0]))
    assert (first.along, first.across) == (pytest.approx(0.0), pytest.approx(8.0))
    (then,) = eyes.look(state(0.05, [(30.5, 2.95, 8.0, 0.0)], [25.0]))
    assert (then.along, then.across) == (pytest.approx(10.0), pytest.approx(-1.0))
    assert then.time_to_collision(9.0) == math.inf
    assert then.time_to_collision(20.0) == pytest.approx(then.gap / 10.0)


def test_what_is_behind_beyond_sight_or_passable_is_not_seen():
    eyes = Perception()
    bodies = [(-10.0, 0.0, 0.0, 0.0), (20.0, 0.0, 0.0, 0.0), (80.0, 0.0, 0.0, 0.0)]
    gaps = [6.0, math.inf, math.inf]
    assert [one.id for one in eyes.look(state(0.0, bodies, gaps))] == ["b2"]
    assert eyes.look(state(0.05, bodies, gaps), visual_range_m=50.0) == []
    assert eyes.look(state(0.1, bodies, gaps, placed=False)) == []
