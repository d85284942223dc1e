import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.adaptive_grid import Squares, crossing
from oodscen_pybullet._land.ground import Ground

from oodscen.driving._roads.building import load_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS


def area(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    three = points[rows]
    a, b = three[:, 1] - three[:, 0], three[:, 2] - three[:, 0]
    return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def test_the_net_does_not_tear() -> None:
    road = next(road for road in SHIPPED_MAPS if road.id == "roundabout")
    net = Squares.around(Ground(load_corridor(road)), np.zeros((0, 2)), 100.0)
    points, rows, owners = net.triangles()
    pieces = area(points, rows)
    assert (pieces > 0.0).all()
    whole = np.bincount(owners, pieces)
    assert np.allclose(whole, (net.sizes * 0.75) ** 2)
    local = net.texture_coordinates(points[rows], owners)
    assert (local > -1e-9).all()
    assert (local < 1.0 + 1e-9).all()
    sides = np.sort(np.stack([rows, np.roll(rows, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    single, count = np.unique(sides, axis=0, return_counts=True)
    assert (count <= 2).all()
    ends = points[single[count == 1]]
    inner = points[np.unique(rows)]
    middle, half = ends.mean(axis=1), np.abs(ends[:, 1] - ends[:, 0]).sum(axis=1) / 2
    for place, reach in zip(middle.tolist(), half.tolist(), strict=True):
        gap = np.abs(inner - place)
        flat = (gap.min(axis=1) < 1e-9) & (gap.max(axis=1) < reach - 1e-9)
        assert not flat.any()


@given(st.floats(0.5, 5.0), st.floats(-3.0, 3.0), st.floats(6.5, 12.0), st.floats(-3.0, 3.0))
def test_lines_cross_the_edge_of_a_disc_where_they_are_cut(
    x: float, y: float, far: float, other: float
) -> None:
    def distance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        away = np.sqrt(a * a + b * b) - 6.0
        return np.where(away < 0.0, np.maximum(away, -0.1), np.minimum(away, 2.5))

    one, two = np.array([[x, y]]), np.array([[far, other]])
    ends = [distance(p[:, 0], p[:, 1]) for p in (one, two)]
    if ends[0][0] >= 0.0:
        return
    share = crossing(distance, one, two, *ends)
    place = one + share * (two - one)
    assert abs(float(np.sqrt((place**2).sum())) - 6.0) < 0.05
