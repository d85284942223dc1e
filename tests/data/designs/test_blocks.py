from typing import Any

from hypothesis import given

from oodscen.data._designs import shapes
from oodscen.data._designs.blocks import blocks_of
from oodscen.data._designs.prop import Prop
from oodscen.data._designs.survey import survey
from tests.made import designs

ROUND = (shapes.Ball, shapes.Heap, shapes.Lathe, shapes.Column)


@given(designs())
def test_blocks_lie_within_the_box_around_their_part(table: dict[str, Any]) -> None:
    """Those of round bodies go beyond it by less than a block; every triangle of a sheet is cut by itself."""
    for leaf in survey(Prop.parse(table).parts).leaves:
        if len(leaf.boxes) != 1:
            continue
        (box,) = leaf.boxes
        margin = 0.5 if isinstance(leaf.part, ROUND) else 1e-6
        blocks = blocks_of(box, leaf.part, leaf.transform)
        triangles = len(leaf.part.sheet) - 2 if isinstance(leaf.part, shapes.Sheet) else 1
        assert 1 <= len(blocks) <= 160 * triangles
        for block in blocks:
            for axis in range(3):
                assert box.low[axis] - margin <= block.low[axis] <= block.high[axis]
                assert block.high[axis] <= box.high[axis] + margin
