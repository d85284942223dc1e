"""Raised medians on a straight road along x, in six pieces of 3 m."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.course import RoadCourse
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.kerbs import Band, kerb_medians, raise_pavement
from oodscen_pybullet._land.ribbons import Ribbons
from oodscen_pybullet._land.surfaces import lay_roads
from oodscen_pybullet._meshes.atlas import swatch_uv

from oodscen.driving._roads.corridor import Corridor, LaneStrip

PIECES = 6
PLACES = st.lists(st.booleans(), min_size=PIECES, max_size=PIECES)


def ribbons() -> Ribbons:
    s = 3.0 * np.arange(PIECES + 1)
    return Ribbons(RoadCourse(s=s, x=s, y=0.0 * s, z=0.0 * s, cos=0.0 * s + 1.0, sin=0.0 * s))


def band(right: float, left: float, where: list[bool]) -> Band:
    return Band(np.full(PIECES + 1, right), np.full(PIECES + 1, left), np.array(where))


def faces(laid: Ribbons, colour: str) -> np.ndarray:
    """Return the corners of the triangles of a colour, [n, 3, 3]."""
    mesh = laid.mesh()
    corners = mesh.triangles[(mesh.uvs[mesh.triangles[:, 0]] == swatch_uv(colour)).all(axis=1)]
    return mesh.vertices[corners]


@given(PLACES)
def test_a_median_has_a_closed_end_wherever_it_begins_or_ends(where: list[bool]) -> None:
    laid = ribbons()
    kerb_medians(laid, [band(-1.0, 1.0, where)])
    sides = faces(laid, "kerb_side")
    ends = sides[np.ptp(sides[:, :, 0], axis=1) < 1e-9]
    changes = np.flatnonzero(np.diff([False, *where, False]))
    assert sorted(ends[::2, 0, 0].tolist()) == [3.0 * change for change in changes]
    turns = np.cross(ends[:, 1] - ends[:, 0], ends[:, 2] - ends[:, 0])[::2, 0]
    begins = np.isin(ends[::2, 0, 0], 3.0 * changes[::2])
    assert ((turns < 0.0) == begins).all()


def test_two_medians_that_touch_have_no_kerb_between_them() -> None:
    laid = ribbons()
    everywhere = [True] * PIECES
    kerb_medians(laid, [band(-1.0, 0.0, everywhere), band(0.0, 1.0, everywhere)])
    edges = np.abs(faces(laid, "kerb")[:, :, 1])
    assert edges.min() == pytest.approx(1.0 - 0.16)


@pytest.mark.parametrize("is_reversed", [False, True])
def test_where_one_of_two_medians_that_touch_ends_its_end_is_closed_and_no_kerb_crosses_the_road(
    is_reversed: bool,
) -> None:
    laid, halfway = ribbons(), [True] * 3 + [False] * 3
    where = halfway[::-1] if is_reversed else halfway
    kerb_medians(laid, [band(-1.0, 0.0, [True] * PIECES), band(0.0, 2.0, where)])
    tops, sides = faces(laid, "kerb"), faces(laid, "kerb_side")
    assert np.ptp(tops[:, :, 1], axis=1).max() < 0.17
    outer = tops[(tops[:, :, 1] > 1.0).all(axis=1)]
    begins, ends = (9.0, 18.0) if is_reversed else (0.0, 9.0)
    assert outer[:, :, 0].min() == begins
    assert outer[:, :, 0].max() == ends
    across = sides[(np.ptp(sides[:, :, 0], axis=1) < 1e-9) & (sides[:, :, 0] == 9.0).all(axis=1)]
    assert len(across) == 2
    assert (across[:, :, 1].min(), across[:, :, 1].max()) == (0.0, 2.0)
    turn = np.cross(across[0, 1] - across[0, 0], across[0, 2] - across[0, 0])[0]
    assert (turn < 0.0) == is_reversed


def test_a_median_that_goes_on_elsewhere_is_closed_at_both_ends() -> None:
    laid, first = ribbons(), [True] * 3 + [False] * 3
    kerb_medians(laid, [band(-2.0, -1.0, first), band(1.0, 2.0, first[::-1])])
    assert np.ptp(faces(laid, "kerb")[:, :, 1], axis=1).max() < 0.17
    sides = faces(laid, "kerb_side")
    across = sides[(np.ptp(sides[:, :, 0], axis=1) < 1e-9) & (sides[:, :, 0] == 9.0).all(axis=1)]
    assert sorted(set(across[:, :, 1].ravel().tolist())) == [-2.0, -1.0, 1.0, 2.0]


def test_medians_beside_a_lane_have_kerbs_of_their_own_and_leave_the_lane_free() -> None:
    s = np.linspace(0.0, 240.0, 241)
    edges = (("driving", -6.0, -3.0), ("median", -3.0, -2.0), ("driving", -2.0, 2.0),
             ("median", 2.0, 3.0), ("driving", 3.0, 6.0))  # fmt: skip
    strips = [
        LaneStrip(kind, 0, 0.0 * s + low, 0.0 * s + high, "none") for kind, low, high in edges
    ]
    road = Corridor(
        s=s, x=s, y=0.0 * s, z=0.0 * s, cos=0.0 * s + 1.0, sin=0.0 * s, curvature=0.0 * s,
        strips=tuple(strips), start=60.0, speed_limit=8.0,
    )  # fmt: skip
    mesh = lay_roads(Ground(road), "urban", np.random.default_rng(0))
    corners = mesh.vertices[mesh.triangles]
    y = corners[(corners[:, :, 2] > 0.05).any(axis=1)][:, :, 1]
    assert not ((y.min(axis=1) < 1.9) & (y.max(axis=1) > -1.9)).any()
    is_side = np.ptp(y, axis=1) < 0.01
    for edge in (-3.0, -2.0, 2.0, 3.0):
        assert (np.abs(y[is_side] - edge) < 0.01).any()


def test_no_medians_have_no_kerbs() -> None:
    laid = ribbons()
    kerb_medians(laid, [])
    assert len(laid.mesh().triangles) == 0


@given(st.floats(0.0, 1.0))
def test_the_kerbs_of_a_narrow_pavement_do_not_overlap(width: float) -> None:
    laid = ribbons()
    raise_pavement(laid, band(2.0, 2.0 + width, [True] * PIECES))
    kerbs = faces(laid, "kerb")
    a, b = kerbs[:, 1] - kerbs[:, 0], kerbs[:, 2] - kerbs[:, 0]
    area = 0.5 * np.cross(a, b)[:, 2]
    assert (area > 0.0).all()
    assert area.sum() == pytest.approx(18.0 * min(width, 2 * 0.16), abs=1e-4)
