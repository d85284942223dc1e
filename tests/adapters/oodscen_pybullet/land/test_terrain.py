from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.terrain import Terrain
from oodscen_pybullet._meshes import Mesh

from oodscen.data._catalogue import RoadMap
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, LaneStrip, OtherRoad
from oodscen.driving.maps._shipped import SHIPPED_MAPS

DEPTH = 0.1
"""So far may the ground reach into a lane, m."""


def one_way(turn: float, bend: float, *, forward: bool) -> Corridor:
    """Return a road of 240 m with a lane and a pavement on its right, one of two that touch."""
    count = 481
    s = np.linspace(0.0, 240.0, count)
    curvature = np.where((s > 80.0) & (s < 160.0), bend, 0.0)
    yaw = turn + np.concatenate([[0.0], np.cumsum(curvature[1:] * 0.5)])
    middle = 0.5 * (yaw[1:] + yaw[:-1])
    x = np.concatenate([[0.0], np.cumsum(0.5 * np.cos(middle))])
    y = np.concatenate([[0.0], np.cumsum(0.5 * np.sin(middle))])
    if not forward:
        x, y, yaw, curvature = x[::-1], y[::-1], yaw[::-1] + np.pi, -curvature[::-1]
    flat = np.zeros(count)
    return Corridor(
        s=s,
        x=x,
        y=y,
        z=flat,
        cos=np.cos(yaw),
        sin=np.sin(yaw),
        curvature=curvature,
        strips=(
            LaneStrip("sidewalk", 0, flat - 5.2, flat - 3.2, "curb"),
            LaneStrip("driving", 1, flat - 3.2, flat, "solid"),
        ),
        start=60.0,
        speed_limit=13.9,
    )


def inlaid(corridor: Corridor, ground: Ground) -> np.ndarray:
    """Return points just inside both edges of all driving lanes near the start, [n, 2]."""
    x, y, _, _ = corridor.point(corridor.start + 100.0, 0.0)
    found = []
    for way in ground.ways:
        road = way.corridor
        for strip in road.strips:
            wide = strip.left - strip.right > 0.5
            near = (road.x - x) ** 2 + (road.y - y) ** 2 < 150.0**2
            near[:1] = near[-1:] = False
            rows = np.flatnonzero(wide & near)[::2]
            if strip.kind == "driving":
                rx, ry, z = road.x[rows], road.y[rows], road.z[rows]
                cos, sin = road.cos[rows], road.sin[rows]
                found += [
                    np.stack([rx - t * sin, ry + t * cos, z], axis=1)
                    for t in (strip.right[rows] + DEPTH, strip.left[rows] - DEPTH)
                ]
    return np.concatenate(found)


def covered(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Tell which points, [n, 3], lie below the ground, by no more than 3 m."""
    faces = mesh.vertices[mesh.triangles]
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    faces = faces[normal[:, 2] > 2e-4]
    size = 8.0
    low = np.floor(faces[:, :, :2].min(axis=1) / size).astype(int)
    high = np.floor(faces[:, :, :2].max(axis=1) / size).astype(int)
    bins: dict[tuple[int, int], list[int]] = {}
    for row, ((a, b), (c, d)) in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
        for i in range(a, c + 1):
            for j in range(b, d + 1):
                bins.setdefault((i, j), []).append(row)
    found = np.zeros(len(points), bool)
    cells = np.floor(points[:, :2] / size).astype(int)
    for i, j in np.unique(cells, axis=0).tolist():
        rows = np.flatnonzero((cells == (i, j)).all(axis=1))
        some = faces[bins.get((i, j), [])]
        a = some[None, :, :, :2] - points[rows][:, None, None, :2]
        b = np.roll(a, -1, axis=2)
        cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        height = some[:, :, 2].mean(axis=1) - points[rows, 2][:, None]
        inside = (cross > -1e-9).all(axis=2) & (height > -0.3) & (height < 3.0)
        found[rows] = inside.any(axis=1)
    return found


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_the_ground_never_reaches_into_a_lane_of_a_shipped_map(road: RoadMap) -> None:
    corridor = load_corridor(road)
    ground = Ground(corridor)
    mesh = Terrain(ground, "urban", np.random.default_rng(0)).mesh()
    points = inlaid(corridor, ground)
    bad = covered(mesh, points)
    assert not bad.any(), points[bad][:5]


@settings(max_examples=3)
@given(st.floats(0.0, 6.2), st.floats(-0.03, 0.03))
def test_the_ground_never_reaches_into_roads_that_touch(turn: float, bend: float) -> None:
    other = OtherRoad(one_way(turn, bend, forward=False), "back", is_connecting=False)
    corridor = replace(one_way(turn, bend, forward=True), others=(other,))
    ground = Ground(corridor)
    mesh = Terrain(ground, "urban", np.random.default_rng(0)).mesh()
    points = inlaid(corridor, ground)
    bad = covered(mesh, points)
    assert not bad.any(), points[bad][:5]
    kerbs = np.concatenate([np.full(9, -3.4), np.full(9, 3.4)])
    along = np.tile(np.linspace(30.0, 210.0, 9), 2)
    beside = np.array([corridor.point(s, t)[:3] for s, t in zip(along, kerbs, strict=True)])
    assert covered(mesh, beside).all()
