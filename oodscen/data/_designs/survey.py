"""The parts of a design as they are drawn: repeated, mirrored and turned, each with its boxes."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from oodscen.data._designs import shapes
from oodscen.data._designs.extents import Extent, Transform, around, corners_of, extents_of
from oodscen.data._designs.shapes import Part
from oodscen.data._designs.tessellation import triangles

MAX_VISITS = 2_000
"""Parts after repetition at which a survey ends; far more than any design may have."""

Size = tuple[float, float, float]
"""Length, width and height, m."""

_GROUPS = (
    shapes.BothSidesOf, shapes.RowOf, shapes.CopiesOf, shapes.ConditionOf, shapes.TurnedOf
)  # fmt: skip
_MEMBER_FIELDS = ("parts", "both_sides", "turned", "otherwise")


@dataclass(frozen=True)
class Leaf:
    """One part that is drawn."""

    path: str
    part: Part
    transform: Transform
    boxes: tuple[Extent, ...]
    """The boxes around it; none around a lamp, or a thing of the catalogue of unknown size."""


@dataclass(frozen=True)
class Survey:
    """The parts of a design that are drawn, after repetition."""

    leaves: tuple[Leaf, ...]
    is_complete: bool
    """False if the design has more parts than a survey visits."""

    @cached_property
    def boxes(self) -> list[tuple[str, Extent]]:
        """The boxes, each with the path of its part."""
        return [(leaf.path, box) for leaf in self.leaves for box in leaf.boxes]

    @cached_property
    def bounds(self) -> Extent:
        """The box around everything; that of parts of unknown size is a point."""
        points = [point for _, box in self.boxes for point in (box.low, box.high)]
        return around(points or [(0.0, 0.0, 0.0)])

    @property
    def triangles(self) -> int:
        """Largest number of triangles."""
        return sum(triangles(leaf.part) for leaf in self.leaves)

    @property
    def lamps(self) -> int:
        """Number of lamps."""
        return sum(isinstance(leaf.part, shapes.LampPart) for leaf in self.leaves)

    @property
    def puffs(self) -> int:
        """Number of puffs of veils."""
        return sum(leaf.part.puffs for leaf in self.leaves if isinstance(leaf.part, shapes.Veil))

    @property
    def texts(self) -> dict[str, str]:
        """The words on it, by path."""
        return {
            f"{leaf.path}.text": leaf.part.text
            for leaf in self.leaves
            if isinstance(leaf.part, shapes.Text)
        }

    @property
    def assets(self) -> list[tuple[str, str]]:
        """Path and id of each thing of the catalogue that is a part."""
        return [
            (f"{leaf.path}.asset", leaf.part.asset)
            for leaf in self.leaves
            if isinstance(leaf.part, shapes.AssetPart)
        ]

    @property
    def colours(self) -> set[str]:
        """Names of all colours."""
        return {colour for leaf in self.leaves for colour in _colours(leaf.part)}


def survey(
    parts: Sequence[Part], state: str | None = None, sizes: Mapping[str, Size] | None = None
) -> Survey:
    """Return the parts of a design that are drawn.

    Args:
        parts: The design.
        state: The state that is shown; `None` for all of them at once.
        sizes: Sizes of the catalogue's things by id; one that is not listed has no box.
    """
    walk = _visits(parts, Transform(), "parts", state)
    visits = list(itertools.islice(walk, MAX_VISITS + 1))
    leaves = (
        Leaf(path, part, transform, _boxes(part, transform, sizes or {}))
        for path, part, transform in visits
        if not isinstance(part, _GROUPS)
    )
    return Survey(tuple(leaves), is_complete=len(visits) <= MAX_VISITS)


def all_parts(parts: Sequence[Part], path: str = "parts") -> Iterator[tuple[str, Part]]:
    """Yield the path and the part of everything in a design as it is written, groups included."""
    for index, part in enumerate(parts):
        part_path = f"{path}[{index}]"
        yield part_path, part
        if isinstance(part, _GROUPS):
            for field in _MEMBER_FIELDS:
                yield from all_parts(getattr(part, field, ()), f"{part_path}.{field}")


def is_deeper(parts: Sequence[Part], depth: int) -> bool:
    """Return whether parts are nested deeper than a depth, without recursion beyond it."""
    level = list(parts)
    for _ in range(depth):
        level = [
            member
            for part in level
            if isinstance(part, _GROUPS)
            for field in _MEMBER_FIELDS
            for member in getattr(part, field, ())
        ]
    return bool(level)


def _visits(
    parts: Sequence[Part], transform: Transform, path: str, state: str | None
) -> Iterator[tuple[str, Part, Transform]]:
    """Yield every part that is shown, groups included, once for each of its copies."""
    for index, part in enumerate(parts):
        part_path = f"{path}[{index}]"
        yield part_path, part, transform
        for field, members, inner in _members(part, transform, state):
            yield from _visits(members, inner, f"{part_path}.{field}", state)


def _members(
    part: Part, transform: Transform, state: str | None
) -> Iterator[tuple[str, Sequence[Part], Transform]]:
    """Yield the parts that a group holds, with their field, once for each of its copies."""
    match part:
        case shapes.BothSidesOf():
            yield "both_sides", part.both_sides, transform.mirrored()
            yield "both_sides", part.both_sides, transform
        case shapes.RowOf():
            x, y, z = part.step
            for k in range(part.repeat):
                yield "parts", part.parts, transform.translated((k * x, k * y, k * z))
        case shapes.CopiesOf():
            for offset in part.at:
                yield "parts", part.parts, transform.translated(offset)
        case shapes.ConditionOf():
            applies = state is not None and set(part.when.split()) <= {state}
            if state is None or applies:
                yield "parts", part.parts, transform
            if not applies:
                yield "otherwise", part.otherwise, transform
        case shapes.TurnedOf():
            yield "turned", part.turned, transform.rotated(part.roll, part.yaw, part.to)


def _boxes(part: Part, transform: Transform, sizes: Mapping[str, Size]) -> tuple[Extent, ...]:
    match part:
        case shapes.LampPart():
            return ()
        case shapes.AssetPart():
            if part.asset not in sizes:
                return ()
            size = sizes[part.asset]
            inner = transform.rotated(part.roll, part.yaw, part.to, part.scale)
            return (inner.box(corners_of((0.0, 0.0, size[2] / 2), size)),)
        case _:
            return tuple(extents_of(part, transform))


def _colours(part: Part) -> Iterator[str]:
    for field in ("colour", "second_colour", "cap_colour", "back", "ink", "paper", "hub"):
        value = getattr(part, field, None)
        if isinstance(value, str):
            yield value
    for field in ("colours", "sides"):
        value = getattr(part, field, None)
        if isinstance(value, tuple):
            yield from value
