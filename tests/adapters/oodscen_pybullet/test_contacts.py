import math
from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._contacts import Bodies
from oodscen_pybullet._engine import load_pybullet
from oodscen_pybullet._types import Pose

from oodscen.driving._motion.boxes import Footprint, gap

EGO = (4.5, 1.85, 1.5)
SIZES = ((0.91, 1.1, 1.02), (0.6, 2.0, 1.0), (0.8, 0.6, 0.1), (0.1, 0.84, 2.64), (10.9, 2.88, 3.0))

poses = st.tuples(st.floats(-12, 12), st.floats(-8, 8), st.just(0.0), st.floats(-math.pi, math.pi))


@pytest.fixture(scope="module")
def bodies() -> Iterator[Bodies]:
    world = Bodies(load_pybullet())
    assert all(world.add(*size) for size in (EGO, *SIZES))
    world.move(0, (0.0, 0.0, 0.0, 0.0))
    yield world
    world.close()
    world.close()


@settings(max_examples=100, deadline=None)
@given(row=st.integers(1, len(SIZES)), pose=poses, lift=st.floats(0.0, 4.0))
def test_gaps_are_those_of_upright_boxes(bodies: Bodies, row: int, pose: Pose, lift: float) -> None:
    x, y, _, yaw = pose
    length, width, _ = SIZES[row - 1]
    bodies.move(row, (x, y, lift, yaw))
    level = gap(Footprint(0.0, 0.0, 0.0, *EGO[:2]), Footprint(x, y, yaw, length, width))
    expected = math.hypot(level, max(0.0, lift - EGO[2]))
    assert bodies.distance(0, row, 40.0) == pytest.approx(expected, abs=2e-3)


@settings(max_examples=30, deadline=None)
@given(pose=poses, shift=st.tuples(st.floats(-300, 300), st.floats(-300, 300)))
def test_gaps_do_not_depend_on_where_in_the_world(
    bodies: Bodies, pose: Pose, shift: tuple[float, float]
) -> None:
    row = len(SIZES)
    bodies.move(0, (0.0, 0.0, 0.0, 0.0))
    bodies.move(row, pose)
    here = bodies.distance(0, row, 40.0)
    bodies.move(0, (*shift, 0.0, 0.0))
    bodies.move(row, (pose[0] + shift[0], pose[1] + shift[1], pose[2], pose[3]))
    there = bodies.distance(0, row, 40.0)
    bodies.move(0, (0.0, 0.0, 0.0, 0.0))
    assert there == pytest.approx(here, abs=1e-3)


def test_overlap_is_contact_and_beyond_reach_is_infinite(bodies: Bodies) -> None:
    bodies.move(1, (1.0, 0.2, 0.0, 0.4))
    assert bodies.distance(0, 1, 20.0) == 0.0
    bodies.move(1, (60.0, 0.0, 0.0, 0.0))
    assert bodies.distance(0, 1, 20.0) == math.inf
