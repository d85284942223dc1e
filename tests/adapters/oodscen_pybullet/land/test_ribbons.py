import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.course import RoadCourse
from oodscen_pybullet._land.ribbons import Ribbons

PIECES = 6


def course(slope: float = 0.0) -> RoadCourse:
    """Return six pieces of 3 m along x."""
    s = 3.0 * np.arange(PIECES + 1)
    return RoadCourse(s=s, x=s, y=0.0 * s, z=slope * s, cos=0.0 * s + 1.0, sin=0.0 * s)


def triangles(ribbons: Ribbons) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners, [n, 3, 3], and the normals of all triangles."""
    mesh = ribbons.mesh()
    return mesh.vertices[mesh.triangles], mesh.normals[mesh.triangles]


@given(st.floats(-0.3, 0.3), st.floats(-5.0, 5.0), st.floats(0.1, 5.0))
def test_a_band_is_seen_and_lit_from_above(slope, right, width):
    ribbons = Ribbons(course(slope))
    ribbons.band(right, right + width, "mark")
    corners, normals = triangles(ribbons)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (faces[:, 2] > 0.0).all()
    assert faces[:, 2].sum() / 2.0 == pytest.approx(18.0 * width)
    assert np.allclose(normals, np.array([-slope, 0.0, 1.0]) / np.sqrt(1.0 + slope * slope))


@pytest.mark.parametrize("is_first", [True, False])
def test_a_band_that_tapers_to_nothing_is_lit_as_the_rest(is_first):
    left = np.zeros(PIECES + 1)
    left[: 1 if is_first else -1] = 0.0
    left[-1 if is_first else 0] = 2.0
    ribbons = Ribbons(course())
    ribbons.band(0.0, left, "mark")
    corners, normals = triangles(ribbons)
    assert np.allclose(normals, [0.0, 0.0, 1.0])
    assert np.ptp(corners[:, :, 0]) == pytest.approx(3.0)


def test_a_band_without_width_is_left_out():
    ribbons = Ribbons(course())
    ribbons.band(1.0, 1.0, "mark")
    assert len(triangles(ribbons)[0]) == 0


@given(st.lists(st.booleans(), min_size=PIECES, max_size=PIECES))
def test_a_mask_chooses_the_pieces(chosen):
    ribbons = Ribbons(course())
    ribbons.band(0.0, 1.0, "mark", where=np.array(chosen))
    corners, _ = triangles(ribbons)
    pieces = (corners.mean(axis=1)[:, 0] // 3.0).astype(int)
    assert pieces.tolist() == [index for index in range(PIECES) if chosen[index] for _ in (0, 1)]


@pytest.mark.parametrize("rows", [(0, 0, 1, 2), (0, 1, 1, 2), (0, 1, 2, 2), (0, 1, 2, 0)])
def test_a_quad_with_a_doubled_corner_is_a_triangle_that_is_lit_as_one(rows):
    corners = np.array([(0.0, 0.0, 0.0), (3.0, 0.0, 0.3), (0.0, 2.0, 0.0)])
    ribbons = Ribbons(course())
    ribbons.add_quads(corners[None, rows], np.zeros((1, 4, 2)))
    shown, normals = triangles(ribbons)
    faces = np.cross(shown[:, 1] - shown[:, 0], shown[:, 2] - shown[:, 0])
    assert faces[:, 2].sum() == pytest.approx(6.0)
    assert np.allclose(normals, np.array([-0.1, 0.0, 1.0]) / np.sqrt(1.01))
