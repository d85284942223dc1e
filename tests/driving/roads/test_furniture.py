"""Outlines of objects beside and on a road, in the road's coordinates."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._roads.surroundings import painted_areas
from tests.driving.networks import file, lane, read_road, road

CORNERS = [(-2.0, -1.0), (2.0, -1.0), (2.0, 1.5), (-2.0, 1.5)]
OBJECT = '<objects><object id="c" type="crosswalk" {where}>{inner}</object></objects>'


def corners(where: str, inner: str = "") -> list[tuple[float, float]]:
    more = OBJECT.format(where=where, inner=inner)
    read = read_road(file(road("1", 100.0, right=lane(-1), more=more)))
    (patch,) = read.patches
    return [pytest.approx(corner, abs=1e-9) for corner in patch.corners]


@given(st.floats(0, 100), st.floats(-5, 5), st.floats(-3, 3))
def test_local_corners_turn_with_the_object(s: float, t: float, heading: float) -> None:
    inner = "".join(f'<cornerLocal u="{u}" v="{v}"/>' for u, v in CORNERS)
    found = corners(f's="{s!r}" t="{t!r}" hdg="{heading!r}"', f"<outline>{inner}</outline>")
    cos, sin = math.cos(heading), math.sin(heading)
    assert found == [(s + u * cos - v * sin, t + u * sin + v * cos) for u, v in CORNERS]


def test_corners_on_the_road_are_taken_as_they_are() -> None:
    inner = "".join(f'<cornerRoad s="{s}" t="{t}"/>' for s, t in CORNERS)
    outline = f"<outlines><outline>{inner}</outline></outlines>"
    assert corners('s="50" t="1" hdg="0.5"', outline) == CORNERS


def test_without_an_outline_the_box_counts() -> None:
    found = corners('s="50" t="1" hdg="0" length="4" width="2"')
    assert found == [(48.0, 0.0), (52.0, 0.0), (52.0, 2.0), (48.0, 2.0)]


@pytest.mark.parametrize("is_closed", [True, False])
@pytest.mark.parametrize("is_clockwise", [True, False])
def test_areas_end_with_their_first_corner(is_closed: bool, is_clockwise: bool) -> None:
    places = CORNERS[::-1] if is_clockwise else CORNERS
    inner = "".join(
        f'<cornerLocal u="{u}" v="{v}"/>' for u, v in [*places, *places[:1]][: 4 + is_closed]
    )
    more = OBJECT.format(where='s="50" t="1" hdg="0"', inner=f"<outline>{inner}</outline>")
    (area,) = painted_areas(read_road(file(road("1", 100.0, right=lane(-1), more=more))))
    assert len(area.points) == 5
    assert (area.points[0] == area.points[-1]).all()
    (ax, ay), (bx, by), (cx, cy) = area.points[:3].tolist()
    assert (bx - ax) * (cy - by) - (by - ay) * (cx - bx) == pytest.approx(10.0)
