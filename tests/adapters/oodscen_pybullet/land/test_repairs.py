"""Repairs and manhole covers on a straight road along x, whose lane lies right of y = 0."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.course import RoadCourse
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.repairs import add_repairs_and_manholes
from oodscen_pybullet._land.ribbons import Ribbons
from oodscen_pybullet._meshes.atlas import swatch_uv

from oodscen.driving._roads.corridor import Corridor, LaneStrip, Structure

S = np.linspace(0.0, 900.0, 901)
FLAT = np.zeros(len(S))


STRAIGHT = Corridor(
    s=S, x=S, y=FLAT, z=FLAT, cos=FLAT + 1.0, sin=FLAT, curvature=FLAT,
    strips=(LaneStrip("driving", 1, FLAT - 3.5, FLAT, "solid"),), start=60.0, speed_limit=14.0,
)  # fmt: skip


def repaired(width: float, seed: int, *, speed_limit: float = 14.0, structures=(), z=FLAT):
    """Return the mesh of the repairs."""
    lane = LaneStrip("driving", 1, FLAT - width, FLAT, "solid")
    road = replace(STRAIGHT, strips=(lane,), speed_limit=speed_limit, z=z)
    way = Ground(replace(road, structures=structures)).ego
    ribbons = Ribbons(way.course)
    add_repairs_and_manholes(way, ribbons, np.random.default_rng(seed))
    return ribbons.mesh()


@given(st.floats(2.51, 6.0), st.integers(0, 99))
def test_repairs_and_covers_lie_in_their_lane(width: float, seed: int) -> None:
    mesh = repaired(width, seed)
    assert len(mesh.triangles) > 0
    low, high = mesh.bounds
    assert -width < low[1] < high[1] < 0.0
    assert 0.0 < low[2] < high[2] < 0.01


@given(st.floats(-0.4, 0.4), st.integers(0, 99))
def test_repairs_lie_in_a_lane_whose_edges_wander(slope: float, seed: int) -> None:
    """They turn every 40 m, and the lane is 4 m wide."""
    right = slope * np.abs((S % 80.0) - 40.0)
    lane = LaneStrip("driving", 1, right, right + 4.0, "solid")
    road = replace(STRAIGHT, strips=(lane,), speed_limit=25.0)
    way = Ground(road).ego
    ribbons = Ribbons(way.course)
    add_repairs_and_manholes(way, ribbons, np.random.default_rng(seed))
    x, y, _ = ribbons.mesh().vertices.T
    inwards = y - np.interp(x, S, right)
    assert inwards.min() > 0.0
    assert inwards.max() < 4.0


def test_a_narrow_lane_has_none() -> None:
    assert all(len(repaired(2.4, seed).triangles) == 0 for seed in range(5))


@given(st.integers(0, 99))
def test_none_begins_in_a_tunnel_or_reaches_into_it(seed: int) -> None:
    tunnel = Structure("tunnel", 100.0, 300.0)
    x = repaired(3.5, seed, structures=(tunnel,)).vertices[:, 0]
    assert not ((x > tunnel.start) & (x < tunnel.end)).any()


@pytest.mark.parametrize(("speed_limit", "has_covers"), [(14.0, True), (20.0, False)])
def test_fast_roads_have_no_manholes(speed_limit: float, has_covers: bool) -> None:
    uvs = np.concatenate([repaired(3.5, seed, speed_limit=speed_limit).uvs for seed in range(5)])
    assert bool((uvs == swatch_uv("asphalt_light")).all(axis=1).any()) == has_covers


@pytest.mark.parametrize(
    "height", [-0.06 * S, 0.0008 * (S - 400.0) ** 2, -0.0008 * (S - 400.0) ** 2]
)
def test_all_lie_on_asphalt_that_slopes_and_bends(height: np.ndarray) -> None:
    for seed in range(5):
        mesh = repaired(3.5, seed, z=height)
        course = RoadCourse.of(replace(STRAIGHT, z=height))
        corners = mesh.vertices[mesh.triangles]
        shares = np.array([(a, b, 4 - a - b) for a in range(5) for b in range(5 - a)]) / 4.0
        points = np.einsum("pk,nkd->npd", shares, corners).reshape(-1, 3)
        above = points[:, 2] - np.interp(points[:, 0], course.s, course.z)
        assert above.min() > 0.0
        assert above.max() < 0.01
