import math
from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet.bodies import Bodies, Pose
from oodscen_pybullet.engine import load_pybullet
from oodscen_pybullet.meshes import asset_mesh

from oodscen.driving import Box, gap

EGO = Box(0.0, 0.0, 0.0, 4.5, 1.85)
BOXES = ("cardboard_box", "barrier", "sofa", "wheelie_bin", "road_closed_sign", "bus")

poses = st.tuples(st.floats(-12, 12), st.floats(-8, 8), st.just(0.0), st.floats(-math.pi, math.pi))


@pytest.fixture(scope="module")
def bodies() -> Iterator[Bodies]:
    world = Bodies(load_pybullet())
    assert world.add("ego_car")
    assert all(world.add(name) for name in (*BOXES, "puddle", "cardboard_box"))
    world.move(0, (0.0, 0.0, 0.0, 0.0))
    yield world
    world.close()
    world.close()


@settings(max_examples=60, deadline=None)
@given(row=st.integers(1, len(BOXES)), pose=poses)
def test_gaps_of_boxes_are_those_of_plane_geometry(bodies: Bodies, row: int, pose: Pose) -> None:
    (cx, cy, _), (half_x, half_y, _) = asset_mesh(BOXES[row - 1]).solids[0]
    x, y, _, yaw = pose
    cos, sin = math.cos(yaw), math.sin(yaw)
    box = Box(x + cos * cx - sin * cy, y + sin * cx + cos * cy, yaw, 2 * half_x, 2 * half_y)
    bodies.move(row, pose)
    assert bodies.distance(0, row, 40.0) == pytest.approx(gap(EGO, box), abs=2e-3)


@settings(max_examples=30, deadline=None)
@given(pose=poses, shift=st.tuples(st.floats(-300, 300), st.floats(-300, 300)))
def test_gaps_do_not_depend_on_where_in_the_world(
    bodies: Bodies, pose: Pose, shift: tuple[float, float]
) -> None:
    row = len(BOXES) + 2
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


def test_a_puddle_is_nothing_to_hit(bodies: Bodies) -> None:
    row = len(BOXES) + 1
    bodies.move(row, (0.0, 0.0, 0.0, 0.0))
    assert bodies.distance(0, row, 20.0) == math.inf
