"""The room that a design takes up: the boxes around its parts, and what drawing them costs."""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from oodscen.data import _shapes as shapes
from oodscen.data._lettering import strokes
from oodscen.data._shapes import Part, Point

_SQUARE = math.sqrt(2.0)
"""Ratio of a square's side to the radius of the circle around it."""
STEP = 0.5
"""Longest stretch of a slanted bar that is boxed as one, m."""
_SLANT = 0.05
"""Share of a bar's length along a second axis from which it is slanted."""
_LEAST = 1e-4
"""Least length of a straight piece, m."""
_SAGGING = 8
"""Straight pieces of a stretch that sags."""
_MOST_BANDS = 40
"""Bands of a stretch of a tube, and columns or rows of a panel's pattern, at most."""
LONGEST_WALK = 2_000
"""Number of parts after repetition beyond which a walk ends; far more than any design may have."""
ASSET_TRIANGLES = 1_500
"""Triangles that a thing of the catalogue counts for; none has more."""

Row = tuple[float, float, float]
Size = tuple[float, float, float]


class Extent(NamedTuple):
    """A box along the axes."""

    low: Point
    high: Point
    is_airy: bool = False
    """True for what floats by itself: dust, a swarm."""

    def touches(self, other: "Extent", reach: float) -> bool:
        """Return whether two boxes are at most `reach` apart along every axis."""
        return all(
            self.low[axis] - reach <= other.high[axis]
            and other.low[axis] - reach <= self.high[axis]
            for axis in range(3)
        )


@dataclass(frozen=True)
class Place:
    """A rotation, a mirror image or a scale, then a shift."""

    rows: tuple[Row, Row, Row] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    shift: Point = (0.0, 0.0, 0.0)

    def direction(self, way: Sequence[float]) -> Point:
        """Return a direction as seen from outside."""
        x, y, z = (sum(a * b for a, b in zip(row, way, strict=True)) for row in self.rows)
        return x, y, z

    def point(self, point: Sequence[float]) -> Point:
        """Return a point as seen from outside."""
        x, y, z = (a + b for a, b in zip(self.direction(point), self.shift, strict=True))
        return x, y, z

    def box(self, points: Iterable[Sequence[float]], is_airy: bool = False) -> Extent:
        """Return the box around points, as seen from outside."""
        return around([self.point(point) for point in points], is_airy)

    def moved(self, offset: Point) -> "Place":
        """Return the place of what is moved within this one."""
        return Place(self.rows, self.point(offset))

    def mirrored(self) -> "Place":
        """Return the place of the mirror image in y."""
        rows = tuple((x, -y, z) for x, y, z in self.rows)
        return Place((rows[0], rows[1], rows[2]), self.shift)

    def turned(self, roll: float, yaw: float, to: Point, scale: float = 1.0) -> "Place":
        """Return the place of what is scaled, turned about x, then about z, then moved; angles in degrees."""
        cos_roll, sin_roll = math.cos(math.radians(roll)), math.sin(math.radians(roll))
        cos, sin = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
        inner = (
            (cos, -sin * cos_roll, sin * sin_roll),
            (sin, cos * cos_roll, -cos * sin_roll),
            (0.0, sin_roll, cos_roll),
        )
        columns = [self.direction([scale * row[axis] for row in inner]) for axis in range(3)]
        rows = tuple((columns[0][i], columns[1][i], columns[2][i]) for i in range(3))
        return Place((rows[0], rows[1], rows[2]), self.point(to))


@dataclass
class Measured:
    """The findings of a walk through a design."""

    spaces: list[tuple[str, Extent]] = field(default_factory=list)
    """The boxes, each with the path of its part."""
    made_of: list[tuple[Part, Place]] = field(default_factory=list)
    """The part and the place of each box."""
    parts: int = 0
    solids: int = 0
    """Parts after repetition."""
    triangles: int = 0
    lamps: int = 0
    puffs: int = 0
    texts: list[tuple[str, str]] = field(default_factory=list)
    shipped: list[tuple[str, str]] = field(default_factory=list)
    """Ids of the catalogue's things that are parts, each with its path."""
    words: list[tuple[str, str]] = field(default_factory=list)
    """Words of conditions, each with its path."""
    colours: set[str] = field(default_factory=set)

    @property
    def bounds(self) -> Extent:
        """The box around everything; that of parts of unknown size is a point."""
        boxes = [space for _, space in self.spaces] or [Extent((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))]
        return around([point for box in boxes for point in (box.low, box.high)])


def measured(
    parts: Sequence[Part], state: str | None = None, sizes: Mapping[str, Size] | None = None
) -> Measured:
    """Walk through a design.

    Args:
        parts: The design.
        state: The state that is shown; `None` for all of them at once.
        sizes: Length, width and height of the catalogue's things; one of unknown size has none.
    """
    found = Measured()
    _Walk(found, state, sizes or {}).through(parts, Place(), "parts")
    return found


class _Walk:
    def __init__(self, found: Measured, state: str | None, sizes: Mapping[str, Size]) -> None:
        self.found, self.state, self.sizes = found, state, sizes
        self.seen: set[int] = set()

    def through(self, parts: Sequence[Part], place: Place, path: str) -> None:
        for index, part in enumerate(parts):
            if self.found.solids > LONGEST_WALK:
                return
            self.part(part, place, f"{path}[{index}]")

    def part(self, part: Part, place: Place, path: str) -> None:
        found = self.found
        if id(part) not in self.seen:
            self.seen.add(id(part))
            found.parts += 1
        match part:
            case shapes.BothSidesOf():
                self.through(part.both_sides, place.mirrored(), f"{path}.both_sides")
                self.through(part.both_sides, place, f"{path}.both_sides")
            case shapes.RowOf():
                for k in range(part.repeat):
                    x, y, z = part.step
                    here = place.moved((k * x, k * y, k * z))
                    self.through(part.parts, here, f"{path}.parts")
            case shapes.CopiesOf():
                for offset in part.at:
                    self.through(part.parts, place.moved(offset), f"{path}.parts")
            case shapes.ConditionOf():
                found.words += [(f"{path}.when", word) for word in part.when.split()]
                is_on = self.state is not None and set(part.when.split()) <= {self.state}
                if self.state is None or is_on:
                    self.through(part.parts, place, f"{path}.parts")
                if self.state is None or not is_on:
                    self.through(part.otherwise, place, f"{path}.otherwise")
            case shapes.TurnedOf():
                inner = place.turned(part.roll, part.yaw, part.to)
                self.through(part.turned, inner, f"{path}.turned")
            case _:
                self.leaf(part, place, path)

    def leaf(self, part: Part, place: Place, path: str) -> None:
        found = self.found
        found.solids += 1
        found.triangles += triangles(part)
        found.colours |= set(colours(part))
        if isinstance(part, shapes.LampPart):
            found.lamps += 1
            return
        if isinstance(part, shapes.Text):
            found.texts.append((f"{path}.text", part.text))
        if isinstance(part, shapes.Veil):
            found.puffs += part.puffs
        if isinstance(part, shapes.AssetPart):
            found.shipped.append((f"{path}.asset", part.asset))
            size = self.sizes.get(part.asset)
            if size is not None:
                inner = place.turned(part.roll, part.yaw, part.to, part.scale)
                found.spaces.append((path, _upright(inner, (0.0, 0.0, size[2] / 2), size)))
                found.made_of.append((part, place))
            return
        boxes = spaces(part, place)
        found.spaces += [(path, space) for space in boxes]
        found.made_of += [(part, place)] * len(boxes)


def colours(part: Part) -> Iterator[str]:
    """Yield the colours of one part."""
    names = ("colour", "second_colour", "cap_colour", "back", "ink", "paper", "hub")
    for name in names:
        value = getattr(part, name, None)
        if isinstance(value, str):
            yield value
    for name in ("colours", "sides"):
        value = getattr(part, name, None)
        if isinstance(value, tuple):
            yield from value


# ---------------------------------------------------------------------- boxes


def spaces(part: Part, place: Place) -> list[Extent]:
    """Return the boxes around one part that is no group, lamp or thing of the catalogue."""
    match part:
        case shapes.Box():
            return [_upright(place, part.box, part.size)]
        case shapes.Hull():
            ends = (part.hull, part.top)
            return [place.box((x, y, end[4]) for end in ends for x in end[:2] for y in end[2:4])]
        case shapes.Beam():
            last = part.width if part.end_width is None else part.end_width
            start, end = place.point(part.beam), place.point(part.to)
            return list(_bar(start, end, part.width / _SQUARE, last / _SQUARE))
        case shapes.Tube():
            points, radius = [place.point(one) for one in hung(part)], part.width / _SQUARE
            pieces = itertools.pairwise(points)
            return [box for start, end in pieces for box in _bar(start, end, radius, radius)]
        case shapes.Cylinder():
            last = part.radius if part.end_radius is None else part.end_radius
            return list(_bar(place.point(part.cylinder), place.point(part.to), part.radius, last))
        case shapes.Lathe():
            rings = [(place.point(ring[:3]), ring[3]) for ring in part.lathe]
            pairs = itertools.pairwise(rings)
            return [box for (a, r), (b, q) in pairs for box in _bar(a, b, r, q)]
        case shapes.Ball():
            return [_round_box(part, place)]
        case shapes.Column():
            return list(_sections(part, place))
        case shapes.Wheel():
            (x, y), r = part.wheel, part.radius
            return [_upright(place, (x, y, r), (2 * r, part.width, 2 * r))]
        case shapes.Sheet(sheet=points) | shapes.Panel(panel=points) | shapes.Text(on=points):
            return [place.box(points)]
        case shapes.Heap():
            return [_upright(place, (*part.heap, part.size[2] / 2), part.size)]
        case shapes.Veil():
            x, y, z = part.veil
            return [_upright(place, (x, y, z + part.size[2] / 2), part.size, is_airy=True)]
        case shapes.Swarm():
            return [_upright(place, part.swarm, part.size, is_airy=True)]
        case shapes.Blot():
            return [_upright(place, (*part.blot, part.height / 2), (*part.size, part.height))]
        case shapes.Strip():
            return [place.box(corners) for corners in _stripes(part)]
        case _:
            raise TypeError(f"{type(part).__name__} has no box")


def around(points: Sequence[Sequence[float]], is_airy: bool = False) -> Extent:
    """Return the box around points."""
    low = tuple(min(p[axis] for p in points) for axis in range(3))
    high = tuple(max(p[axis] for p in points) for axis in range(3))
    return Extent((low[0], low[1], low[2]), (high[0], high[1], high[2]), is_airy)


def corners_of(centre: Sequence[float], size: Sequence[float]) -> list[Point]:
    """Return the corners of a box: y changes fastest, then x, then z."""
    (x, y, z), (a, b, c) = centre, (value / 2 for value in size)
    return [(x + i * a, y + j * b, z + k * c) for k in (-1, 1) for i in (-1, 1) for j in (-1, 1)]


def _upright(
    place: Place, centre: Sequence[float], size: Sequence[float], is_airy: bool = False
) -> Extent:
    return place.box(corners_of(centre, size), is_airy)


def length_of(way: Sequence[float]) -> float:
    """Return the length of a vector."""
    return math.sqrt(sum(w * w for w in way))


def is_slanted(way: Sequence[float]) -> bool:
    """Return whether a vector runs along more than one axis."""
    length = length_of(way)
    return sum(abs(w) > _SLANT * length for w in way) > 1


def _bar(start: Point, end: Point, radius: float, last: float) -> Iterator[Extent]:
    """Yield the boxes along a round bar between two points that are placed already."""
    way = [b - a for a, b in zip(start, end, strict=True)]
    length = length_of(way)
    aside = [math.sqrt(max(0.0, 1.0 - (w / length) ** 2)) for w in way]
    count = max(1, math.ceil(length / STEP)) if is_slanted(way) else 1
    for k in range(count):
        ends = []
        for share in (k / count, (k + 1) / count):
            wide = radius + share * (last - radius)
            middle = [a + share * w for a, w in zip(start, way, strict=True)]
            ends += [
                [m + sign * wide * off for m, off in zip(middle, aside, strict=True)]
                for sign in (-1, 1)
            ]
        yield around(ends)


def _round_box(part: shapes.Ball, place: Place) -> Extent:
    """Return the box around an ellipsoid."""
    x, y, z = place.point(part.ball)
    grown = [radius * (1.0 + part.jitter) for radius in part.radii]
    a, b, c = (
        math.sqrt(sum((m * r) ** 2 for m, r in zip(row, grown, strict=True))) for row in place.rows
    )
    return Extent((x - a, y - b, z - c), (x + a, y + b, z + c))


def _sections(part: shapes.Column, place: Place) -> Iterator[Extent]:
    """Yield the boxes between the rings of a column."""
    rings = []
    for x, y, z, one, two in _rings(part):
        offsets = [(i * one, j * two) for i in (-1, 1) for j in (-1, 1)]
        if part.axis == "x":
            rings.append([place.point((x, y + a, z + b)) for a, b in offsets])
        else:
            rings.append([place.point((x + a, y + b, z)) for a, b in offsets])
    for ring, after in itertools.pairwise(rings):
        yield around([*ring, *after])


def _rings(part: shapes.Column) -> Iterator[tuple[float, ...]]:
    """Yield the rings of a column, with further ones on long stretches."""
    for start, end in itertools.pairwise(part.column):
        count = max(1, math.ceil(math.dist(start[:3], end[:3]) / STEP))
        for k in range(count):
            yield tuple(a + k / count * (b - a) for a, b in zip(start, end, strict=True))
    yield part.column[-1]


def _stripes(part: shapes.Strip) -> Iterator[list[Point]]:
    """Yield the corners of the boxes along a strip."""
    for (x0, y0), (x1, y1) in itertools.pairwise(part.strip):
        length = math.hypot(x1 - x0, y1 - y0)
        a, b = part.width / 2 * (y1 - y0) / length, part.width / 2 * (x1 - x0) / length
        yield [
            (x + sign * a, y - sign * b, z)
            for x, y in ((x0, y0), (x1, y1))
            for sign in (-1, 1)
            for z in (0.0, part.height)
        ]


def hung(part: shapes.Tube) -> list[Point]:
    """Return the points of a tube, with the sag of its stretches."""
    if not part.sag:
        return list(part.tube)
    points = [part.tube[0]]
    for start, end in zip(part.tube, part.tube[1:], strict=False):
        for k in range(1, _SAGGING + 1):
            u = k / _SAGGING
            x, y, z = (a + u * (b - a) for a, b in zip(start, end, strict=True))
            # A parabola that is lowest, by the sag, in the middle.
            point = (x, y, z - 4.0 * part.sag * u * (1.0 - u))
            # An upright stretch that sags turns back on itself.
            if math.dist(point, points[-1]) > _LEAST:
                points.append(point)
    return points


def bands(part: shapes.Tube, start: Point, end: Point) -> int:
    """Return the number of bands of one stretch of a tube."""
    if not part.second_colour:
        return 1
    return min(_MOST_BANDS, max(1, round(math.dist(start, end) / part.pitch)))


def cells(part: shapes.Panel) -> tuple[int, int]:
    """Return the columns and rows of a panel's pattern."""
    width, height = math.dist(*part.panel[:2]), math.dist(part.panel[0], part.panel[3])
    across, up = (min(_MOST_BANDS, max(1, round(size / part.pitch))) for size in (width, height))
    if part.pattern == "stripes":
        return (across, 1) if width >= height else (1, up)
    if part.pattern == "planks":
        return 1, up
    return (1, 1) if part.pattern == "plain" else (across, up)


# ---------------------------------------------------------------------- cost

LUMP = 42
"""Triangles of a lump of a heap."""
SPECK = 8
"""Triangles of a speck of a swarm."""
OUTLINE = 24
"""Corners of a blot."""


def _round(sides: int) -> int:
    return 4 * sides - 4


_COSTS: dict[type[Part], Callable[..., int]] = {
    shapes.Box: lambda part: 12,
    shapes.Hull: lambda part: 12,
    shapes.Beam: lambda part: 12,
    shapes.Cylinder: lambda part: _round(part.sides),
    shapes.Lathe: lambda part: (len(part.lathe) - 1) * _round(part.sides),
    shapes.Ball: lambda part: part.around * (2 * part.down - 2),
    shapes.Column: lambda part: 2 * len(part.column) * part.sides,
    shapes.Sheet: lambda part: 2 * len(part.sheet),
    shapes.Wheel: lambda part: _round(14) + _round(10),
    shapes.LampPart: lambda part: 0,
    shapes.Text: lambda part: 2 + 2 * len(strokes(part.text)),
    shapes.Heap: lambda part: LUMP * part.lumps,
    shapes.Veil: lambda part: 0,
    shapes.Swarm: lambda part: SPECK * part.count,
    shapes.Blot: lambda part: OUTLINE,
    shapes.Strip: lambda part: 2 * (40 if part.dash else 1) * (len(part.strip) - 1),
    shapes.AssetPart: lambda part: ASSET_TRIANGLES,
}


_PATTERN_COSTS = {"bricks": 6, "windows": 6, "net": 0, "speckle": 4, "planks": 4}


def triangles(part: Part) -> int:
    """Return the largest number of triangles of one part, before it is drawn."""
    if isinstance(part, shapes.Tube):
        points = hung(part)
        return 12 * sum(bands(part, a, b) for a, b in itertools.pairwise(points))
    if isinstance(part, shapes.Panel):
        across, up = cells(part)
        each = _PATTERN_COSTS.get(part.pattern, 2)
        count = each * across * up + (4 * (across + up + 2) if part.pattern == "net" else 0)
        return 2 + count * (2 if part.back else 1)
    return _COSTS[type(part)](part)
