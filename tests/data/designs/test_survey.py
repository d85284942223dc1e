import time
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._designs import shapes
from oodscen.data._designs.prop import Prop, check_prop
from oodscen.data._designs.survey import all_parts, survey
from oodscen.errors import DataError
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from tests.made import WALL, designs

BOX = WALL["parts"][0]
POLE = {"box": [1, 1, 0.5], "size": [0.2, 0.2, 1], "colour": "white"}


def parse(*parts: dict[str, Any], **fields: Any) -> Prop:
    """Return a design of some parts."""
    return Prop.parse({**WALL, "parts": parts, **fields})


def faults(*parts: dict[str, Any], **fields: Any) -> list[str]:
    """Return the faults of a design, each with its path."""
    with pytest.raises(DataError) as caught:
        parse(*parts, **fields)
    return [f"{issue.path}: {issue.message}" for issue in caught.value.issues]


@given(designs())
def test_the_bounds_hold_every_box(table: dict[str, Any]) -> None:
    drawn = survey(Prop.parse(table).parts)
    low, high, _ = drawn.bounds
    for _, box in drawn.boxes:
        assert all(
            a <= b <= c <= d for a, b, c, d in zip(low, box.low, box.high, high, strict=True)
        )


@settings(max_examples=20)
@given(designs(), st.integers(2, 9))
def test_a_row_has_so_many_of_everything(table: dict[str, Any], count: int) -> None:
    parts = Prop.parse(table).parts
    row = {"repeat": count, "step": [0.1, 0, 0], "parts": table["parts"]}
    try:
        repeated = survey(Prop.parse({**table, "parts": [row]}).parts)
    except DataError:
        return
    drawn = survey(parts)
    assert len(repeated.leaves) == count * len(drawn.leaves)
    assert repeated.triangles == count * drawn.triangles
    assert repeated.colours == drawn.colours
    assert len(repeated.texts) == len(drawn.texts)


@pytest.mark.parametrize(
    ("group", "xs"),
    [
        ({"both_sides": [POLE]}, [1, 1]),
        ({"repeat": 3, "step": [2, 0, 0], "parts": [POLE]}, [1, 3, 5]),
        ({"at": [[0, 0, 0], [-1, 0, 0]], "parts": [POLE]}, [1, 0]),
        ({"turned": [POLE], "yaw": 180}, [-1]),
        ({"turned": [POLE], "yaw": 90}, [-1]),
        ({"turned": [POLE], "to": [2, 0, 0]}, [3]),
    ],
)
def test_groups_repeat_mirror_turn_and_move(group: dict[str, Any], xs: list[float]) -> None:
    boxes = [box for _, box in survey(parse(BOX, group).parts).boxes[1:]]
    assert [(box.low[0] + box.high[0]) / 2 for box in boxes] == pytest.approx(xs)
    if "both_sides" in group:
        assert [box.low[1] > 0 for box in boxes] == [False, True]


def test_a_state_shows_its_parts_alone() -> None:
    condition = {"when": "up", "parts": [POLE], "otherwise": [BOX, BOX]}
    parts = parse(condition, states=["down", "up"]).parts
    shown = {state: len(survey(parts, state).leaves) for state in (None, "down", "up")}
    assert shown == {None: 3, "down": 2, "up": 1}


def test_a_thing_of_the_catalogue_has_a_box_if_its_size_is_known() -> None:
    parts = parse(BOX, {"asset": "cone", "scale": 2, "to": [1, 0, 0]}).parts
    assert len(survey(parts).boxes) == 1
    _, box = survey(parts, sizes={"cone": (0.4, 0.6, 0.8)}).boxes[1]
    assert box.low == pytest.approx((0.6, -0.6, 0.0))
    assert box.high == pytest.approx((1.4, 0.6, 1.6))


def test_every_part_is_told_once_with_its_path() -> None:
    row = {"repeat": 9, "step": [0.1, 0, 0], "parts": [BOX, {"both_sides": [POLE]}]}
    assert [path for path, _ in all_parts(parse(BOX, row).parts)] == [
        "parts[0]", "parts[1]", "parts[1].parts[0]", "parts[1].parts[1]",
        "parts[1].parts[1].both_sides[0]",
    ]  # fmt: skip


def test_a_fault_of_a_repeated_part_is_told_once() -> None:
    row = {"repeat": 9, "step": [0.1, 0, 0], "parts": [{"when": "ajar", "parts": [BOX]}]}
    assert faults(row) == ["parts[0].parts[0].when: 'ajar' is none of its states"]
    row = {"repeat": 3, "step": [0.1, 0, 0], "parts": [{"asset": "no_such_thing"}]}
    assert [issue.path for issue in check_prop(parse(BOX, row), FLAT_CATALOGUE.assets)] == [
        "parts[1].parts[0].asset"
    ]


def test_groups_of_nothing_are_refused_at_once_however_often_they_repeat() -> None:
    group: dict[str, Any] = {"when": "ajar", "parts": []}
    for _ in range(3):
        group = {"repeat": 64, "step": [1, 0, 0], "parts": [group]}
    start = time.process_time()
    assert faults(BOX, group) == ["parts: at most 400 parts after repetition"]
    assert time.process_time() - start < 1.0


def test_a_part_that_is_used_again_counts_each_time() -> None:
    box = parse(BOX).parts[0]
    turned = shapes.Turned(turned=(box,) * 30)
    prop = {"id": "low_wall", "description": "a low wall", "mass_kg": 9}
    with pytest.raises(DataError, match="at most 40 parts, not 62"):
        Prop(**prop, parts=(turned, turned))
