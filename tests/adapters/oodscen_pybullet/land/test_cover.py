import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.cover import REACH_M, Cover, band_triangles

numbers = st.floats(-12.0, 12.0).map(lambda x: round(x, 2))
corners = st.lists(st.tuples(*[numbers] * 6), min_size=1, max_size=8).map(
    lambda rows: np.array(rows, np.float64).reshape(-1, 3, 2)
)
points = st.lists(st.tuples(numbers, numbers), min_size=1, max_size=8).map(
    lambda rows: np.array(rows, np.float64)
)


def distance(x: float, y: float, triangles: np.ndarray) -> float:
    best = REACH_M
    for triangle in triangles:
        (ax, ay), (bx, by), (cx, cy) = triangle
        turn = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(turn) < 1e-6:
            continue
        sides = list(zip(triangle, np.roll(triangle, -1, axis=0), strict=True))
        crosses = [(q - p)[0] * (y - p[1]) - (q - p)[1] * (x - p[0]) for p, q in sides]
        away = []
        for p, q in sides:
            share = (((x, y) - p) * (q - p)).sum() / ((q - p) ** 2).sum()
            foot = p + min(max(share, 0.0), 1.0) * (q - p)
            away.append(float(np.hypot(x - foot[0], y - foot[1])))
        is_inside = all(c * turn >= 0.0 for c in crosses)
        best = min(best, -min(away) if is_inside else min(away))
    return best


@given(corners, points)
def test_distances_are_those_of_the_nearest_triangle(triangles: np.ndarray, at: np.ndarray) -> None:
    found = Cover(triangles).distance(at[:, 0], at[:, 1])
    expected = [distance(x, y, triangles) for x, y in at.tolist()]
    assert np.allclose(found, expected, atol=1e-9)


@given(points)
def test_points_are_on_a_band_exactly_between_its_edges(at: np.ndarray) -> None:
    s = np.linspace(-20.0, 20.0, 9)
    band = band_triangles(
        [(np.stack([s, 0.0 * s - 2.0], axis=1), np.stack([s, 0.0 * s + 3.0], axis=1))]
    )
    found = Cover(band).distance(at[:, 0], at[:, 1])
    outside = np.maximum(-2.0 - at[:, 1], at[:, 1] - 3.0)
    assert ((found > 0.0) == (outside > 0.0)).all()
    assert np.allclose(found[outside > 0.0], np.minimum(outside[outside > 0.0], REACH_M))


def test_nothing_covers_nothing() -> None:
    assert Cover(np.zeros((0, 3, 2))).distance(np.zeros(2), np.ones(2)).tolist() == [REACH_M] * 2
