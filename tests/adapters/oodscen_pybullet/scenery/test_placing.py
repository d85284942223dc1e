"""Rectangles that things claim beside a straight road along x."""

import math
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.terrain import Terrain
from oodscen_pybullet._scenery.placing import FAR_M, RoadsidePlace, Site
from oodscen_pybullet._scenery.themes import trees

from oodscen.driving._roads.corridor import Corridor, LaneStrip, Structure

LENGTH_M, WIDTH_M, START_M = 400.0, 7.0, 60.0
S = np.linspace(0.0, LENGTH_M, 401)
FLAT = np.zeros(len(S))
ROAD = Corridor(
    s=S, x=S, y=FLAT, z=FLAT, cos=FLAT + 1.0, sin=FLAT, curvature=FLAT,
    strips=(LaneStrip("driving", 1, FLAT - WIDTH_M, FLAT, "solid"),), start=START_M,
    speed_limit=13.9,
)  # fmt: skip
GROUND = Ground(ROAD)
TERRAIN = Terrain(GROUND, "rural", np.random.default_rng(0))
SHARES = np.linspace(-1.0, 1.0, 9)

CLAIMS = st.tuples(
    st.floats(100.0, 140.0), st.floats(-30.0, 30.0), st.floats(0.0, 3.1), st.floats(0.2, 9.0),
    st.floats(0.2, 9.0),
)  # fmt: skip


def site() -> Site:
    return Site(GROUND, TERRAIN, np.random.default_rng(0))


def points(x: float, y: float, turn: float, half_x: float, half_y: float) -> np.ndarray:
    """Return points of a rectangle, [n, 2]."""
    a, b = (grid.ravel() for grid in np.meshgrid(half_x * SHARES, half_y * SHARES))
    c, s = math.cos(turn), math.sin(turn)
    return np.stack([x + c * a - s * b, y + s * a + c * b], axis=1)


def is_within(spots: np.ndarray, x: float, y: float, turn: float, a: float, b: float) -> bool:
    """Return whether a point lies in a rectangle and not just on its edge."""
    c, s = math.cos(turn), math.sin(turn)
    dx, dy = spots[:, 0] - x, spots[:, 1] - y
    along, across = np.abs(c * dx + s * dy), np.abs(c * dy - s * dx)
    return bool(((along < a - 1e-6) & (across < b - 1e-6)).any())


@settings(max_examples=60)
@given(st.lists(CLAIMS, min_size=2, max_size=8))
def test_no_two_claims_overlap(claims) -> None:
    land, taken = site(), []
    for claim in claims:
        x, y, turn, half_x, half_y = claim
        heading = (math.cos(turn), math.sin(turn))
        overlaps = any(
            is_within(points(*claim), *other) or is_within(points(*other), *claim)
            for other in taken
        )
        if land.claim(x, y, heading, half_x, half_y, margin=0.0):
            assert not overlaps
            taken.append(claim)
        else:
            assert taken


@given(st.floats(0.5, 4.0), st.floats(0.0, 20.0))
def test_a_claim_keeps_its_margin_from_asphalt(margin, away) -> None:
    is_claimed = site().claim(200.0, away, (1.0, 0.0), 2.0, 2.0, margin=margin)
    if abs(away - 2.0 - margin) > 0.1:
        assert is_claimed == (away - 2.0 > margin)


def test_what_touches_at_a_corner_or_along_a_side_fits() -> None:
    land = site()
    assert land.claim(200.0, 30.0, (1.0, 0.0), 2.0, 2.0, margin=0.0)
    assert land.claim(204.01, 30.0, (1.0, 0.0), 2.0, 2.0, margin=0.0)
    assert not land.claim(203.9, 33.9, (1.0, 0.0), 2.0, 2.0, margin=0.0)
    assert land.claim(200.0 + 3.6, 30.0 + 3.6, (0.6, 0.8), 1.0, 1.0, margin=0.0)


def test_places_follow_the_edge_of_the_road_and_face_along_it() -> None:
    way = GROUND.ego
    for side, y, heading in ((1, 0.0, (1.0, 0.0)), (-1, -WIDTH_M, (-1.0, 0.0))):
        spots = site().spots(way, side, 20.0, first=5.0)
        assert len(spots) > 5
        assert all((spot.y, spot.heading, spot.side) == (y, heading, side) for spot in spots)
        assert np.allclose(np.diff([spot.x for spot in spots]), 20.0)
        assert all(abs(spot.beside(3.0, 2.0)[1] - y) == 2.0 for spot in spots)


def test_a_spot_is_far_ahead_behind_or_aside() -> None:
    def is_far(x: float, y: float) -> bool:
        return site().is_far(RoadsidePlace(x, y, (1.0, 0.0), x, 1))

    assert not is_far(START_M, 5.0)
    assert is_far(START_M + FAR_M + 1.0, 5.0)
    assert is_far(START_M - 41.0, 5.0)
    assert is_far(START_M, 0.36 * FAR_M)


def test_the_horizon_is_wooded_beside_a_tunnel_and_not_beside_a_bridge(monkeypatch) -> None:
    places: list[float] = []
    monkeypatch.setattr(trees, "add_tree", lambda site, spot, *others: places.append(spot.s))
    tunnel, bridge = Structure("tunnel", 100.0, 200.0), Structure("bridge", 250.0, 350.0)
    ground = Ground(replace(ROAD, structures=(tunnel, bridge)))
    trees.add_horizon(Site(ground, TERRAIN, np.random.default_rng(0)), 70.0)
    assert sum(100.0 < s < 200.0 for s in places) >= 4
    assert not any(250.0 < s < 350.0 for s in places)
