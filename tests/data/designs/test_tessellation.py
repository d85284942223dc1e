import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._designs import shapes
from oodscen.data._designs.tessellation import MAX_BANDS, bands, cells, sagging_points, triangles

LENGTHS = st.floats(0.05, 19)
PITCHES = st.floats(0.05, 5)


def panel(width: float, height: float, pattern: str, pitch: float) -> shapes.Panel:
    """Return an upright panel."""
    corners = [[0, 0, 0], [0, -width, 0], [0, -width, height], [0, 0, height]]
    return shapes.Panel.model_validate(
        {"panel": corners, "colour": "red", "pattern": pattern, "pitch": pitch}
    )


@given(LENGTHS, st.floats(0, 4), st.integers(2, 5))
def test_a_tube_hangs_between_its_points(length: float, sag: float, count: int) -> None:
    ends = tuple((k * length / 5, 0.0, 10.0) for k in range(count))
    points = sagging_points(shapes.Tube(tube=ends, width=0.1, sag=sag, colour="red"))
    assert [point for point in points if point in ends] == list(ends)
    assert min(z for _, _, z in points) == pytest.approx(10.0 - sag)


@given(LENGTHS, PITCHES)
def test_bands_are_about_as_long_as_their_pitch(length: float, pitch: float) -> None:
    start, end = (0.0, 0.0, 0.0), (length, 0.0, 0.0)
    plain = shapes.Tube(tube=(start, end), width=0.1, pitch=pitch, colour="red")
    banded = plain.model_copy(update={"second_colour": "white"})
    count = bands(banded, start, end)
    assert bands(plain, start, end) == 1
    assert abs(count - length / pitch) <= 0.5 or count in (1, MAX_BANDS)
    assert triangles(banded) == count * triangles(plain)


@given(LENGTHS, LENGTHS, PITCHES)
def test_a_pattern_fills_a_panel_in_its_own_direction(
    width: float, height: float, pitch: float
) -> None:
    columns, rows = cells(panel(width, height, "checks", pitch))
    assert 1 <= columns <= MAX_BANDS
    assert 1 <= rows <= MAX_BANDS
    assert cells(panel(width, height, "plain", pitch)) == (1, 1)
    assert cells(panel(width, height, "planks", pitch)) == (1, rows)
    stripes = (columns, 1) if width >= height else (1, rows)
    assert cells(panel(width, height, "stripes", pitch)) == stripes


def test_a_panel_that_shows_from_behind_costs_its_pattern_twice() -> None:
    both = panel(2, 1, "net", 0.5)
    front = both.model_copy(update={"back": False})
    assert triangles(both) - 2 == 2 * (triangles(front) - 2) == 2 * 4 * (4 + 2 + 2)


def test_an_upright_stretch_that_sags_has_no_piece_of_no_length() -> None:
    tube = shapes.Tube(tube=((0, 0, 0), (0, 0, 1)), width=0.1, sag=0.25, colour="red")
    points = sagging_points(tube)
    assert all(math.dist(a, b) > 0 for a, b in itertools.pairwise(points))
