"""Which parts hold each other: turned, tapered and round ones by more than the box around them."""

import itertools
from typing import Any

import pytest
from hypothesis import given

from oodscen.data._designs.holding import Solid, held
from oodscen.data._designs.prop import Prop
from oodscen.data._designs.survey import survey
from oodscen.errors import DataError
from tests.made import WALL, designs

BAR = {"turned": [{"box": [0, 0, 0.5], "size": [6, 0.2, 1], "colour": "red"}], "yaw": 45}
DOME = {"ball": [0, 0, 1], "radii": [1, 1, 1], "colour": "red"}
DISC = {"cylinder": [0, 0, 0], "to": [0, 0, 1], "radius": 2, "colour": "red"}
PYRAMID = {"hull": [-2, 2, -2, 2, 0], "top": [-0.1, 0.1, -0.1, 0.1, 2], "colour": "red"}
CONE = {"lathe": [[0, 0, 0, 2], [0, 0, 2, 0.1]], "colours": ["red"]}
TRUNK = {"column": [[0, 0, 0, 2, 2], [0, 0, 2, 0.1, 0.1]], "colour": "red"}
HEAP = {"heap": [0, 0], "size": [4, 4, 2], "colour": "red"}
PANE = {"panel": [[-1.5, 1.5, 0], [1.5, -1.5, 0], [1.5, -1.5, 2], [-1.5, 1.5, 2]], "pattern": "plain", "colour": "red"}  # fmt: skip
SHEET = {"sheet": PANE["panel"], "colour": "red"}


def small(x: float, y: float, z: float) -> dict[str, Any]:
    """Return a small box."""
    return {"box": [x, y, z], "size": [0.2, 0.2, 0.2], "colour": "white"}


@pytest.mark.parametrize(
    ("body", "held", "loose"),
    [
        (BAR, small(1.5, 1.5, 0.8), small(1.5, -1.5, 0.8)),
        (DOME, small(0, 0, 2), small(0.95, 0.95, 1.95)),
        (DISC, small(1.4, 1.4, 0.9), small(1.9, 1.9, 0.9)),
        (PYRAMID, small(0, 0, 2), small(1.5, 1.5, 1.8)),
        (CONE, small(0, 0, 2), small(1.5, 1.5, 1.5)),
        (TRUNK, small(0, 0, 2), small(1.5, 1.5, 1.5)),
        (HEAP, small(0, 0, 2), small(1.8, 1.8, 1.8)),
        (PANE, small(-1, 1, 1), small(1.2, 1.2, 1)),
        (SHEET, small(-1, 1, 1), small(1.2, 1.2, 1)),
    ],
)
def test_what_is_near_the_box_but_not_near_the_body_floats(
    body: dict[str, Any], held: dict[str, Any], loose: dict[str, Any]
) -> None:
    assert Prop.parse({**WALL, "parts": [body, held]})
    with pytest.raises(DataError) as caught:
        Prop.parse({**WALL, "parts": [body, loose]})
    assert [issue.path for issue in caught.value.issues] == ["parts[1]"]


def test_letters_without_a_ground_need_something_behind_them() -> None:
    text = {"text": "HELLO", "on": [[-0.21, 1, 0], [-0.21, -1, 0], [-0.21, -1, 2], [-0.21, 1, 2]]}
    assert Prop.parse({**WALL, "parts": [*WALL["parts"], text]})
    assert Prop.parse({**WALL, "parts": [{**text, "paper": "white"}]})
    with pytest.raises(DataError):
        Prop.parse({**WALL, "parts": [text]})


def test_a_sagging_stretch_that_turns_back_on_itself_has_a_box() -> None:
    for sag in range(1, 20):
        tube = {"tube": [[0, 0, 0], [0, 0, 1]], "width": 0.1, "sag": sag / 40, "colour": "red"}
        assert Prop.parse({**WALL, "parts": [*WALL["parts"], tube]}).space().high[2] >= 1


@given(designs())
def test_the_order_of_parts_decides_nothing_about_what_the_road_holds(
    table: dict[str, Any],
) -> None:
    leaves = survey(Prop.parse(table).parts, sizes={"cone": (0.3, 0.3, 0.7)}).leaves
    solids = [Solid(box, leaf.part, leaf.transform) for leaf in leaves for box in leaf.boxes]
    expected = held(solids, is_standing=True)
    assert held(solids[::-1], is_standing=True) == expected[::-1]
    for one, other in itertools.combinations(solids[:8], 2):
        assert one.touches(other) == other.touches(one)


def test_nothing_holds_nothing() -> None:
    assert held([], is_standing=True) == held([], is_standing=False) == []
