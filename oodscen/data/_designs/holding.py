"""The hold of a design's parts on each other."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from oodscen.data._designs import shapes
from oodscen.data._designs.blocks import blocks_of
from oodscen.data._designs.extents import Extent, Transform
from oodscen.data._designs.shapes import Part

REACH_M = 0.06
"""Gap up to which parts hold each other, m."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A part, or a piece of it."""

    box: Extent
    """The box around it."""
    part: Part
    transform: Transform

    @cached_property
    def blocks(self) -> list[Extent]:
        """Small boxes that fill it more closely than the box around it."""
        return blocks_of(self.box, self.part, self.transform)

    @property
    def reaches_road(self) -> bool:
        """True if the road holds it."""
        if self.box.low[2] > REACH_M:
            return False
        is_text = isinstance(self.part, shapes.Text)
        return not is_text or min(block.low[2] for block in self.blocks) <= REACH_M

    def touches(self, other: "Solid") -> bool:
        """Return whether two solids hold each other."""
        if not self.box.touches(other.box, REACH_M):
            return False
        near = [block for block in self.blocks if block.touches(other.box, REACH_M)]
        others = [block for block in other.blocks if block.touches(self.box, REACH_M)]
        return any(block.touches(other_block, REACH_M) for block in near for other_block in others)


def held(solids: Sequence[Solid], *, is_standing: bool) -> list[bool]:
    """Return for each solid whether the road holds it, directly or by others.

    Args:
        solids: The solids in the order of the design.
        is_standing: True if the road holds what reaches it; otherwise the first solid is held.
    """
    if is_standing:
        are_held = [solid.reaches_road for solid in solids]
    else:
        are_held = [index == 0 for index in range(len(solids))]
    holders = [solid for solid, is_held in zip(solids, are_held, strict=True) if is_held]
    while holders:
        holder = holders.pop()
        for index, solid in enumerate(solids):
            if not are_held[index] and holder.touches(solid):
                are_held[index] = True
                holders.append(solid)
    return are_held
