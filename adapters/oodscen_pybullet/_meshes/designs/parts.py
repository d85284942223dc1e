"""Draws the shapes of which designs are made (`oodscen.data._designs.shapes`)."""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import singledispatch
from typing import Annotated

from pydantic import AfterValidator

from oodscen.data._designs import shapes
from oodscen.data._designs.shapes import Part, Point, Rectangle
from oodscen.data._designs.tessellation import bands, sagging_points
from oodscen_pybullet._meshes.atlas import REGIONS
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance


def _check_region(name: str) -> str:
    if name not in REGIONS:
        raise ValueError(f"unknown printed region {name!r}")
    return name


Region = Annotated[str, AfterValidator(_check_region)]
"""A printed region of the atlas."""


@dataclass(frozen=True)
class Placing:
    """The place of a part in the finished mesh: moved, and mirrored to the right side or not."""

    shift: Point = (0.0, 0.0, 0.0)
    side: float = 1.0
    """-1 mirrors y before the part is moved."""

    def point(self, point: Point) -> Point:
        """Return where a point of the part lies."""
        (x, y, z), (dx, dy, dz) = point, self.shift
        return x + dx, self.side * y + dy, z + dz

    def direction(self, way: Point) -> Point:
        """Return a direction, mirrored as the part is."""
        return way[0], self.side * way[1], way[2]

    def rectangle(self, flat: Rectangle) -> Rectangle:
        """Return where an upright box's lower or upper face lies."""
        x0, x1, y0, y1, z = flat
        corners = self.point((x0, y0, z)), self.point((x1, y1, z))
        (x0, y0, z), (x1, y1, _) = corners
        return x0, x1, min(y0, y1), max(y0, y1), z

    def outline(self, points: tuple[Point, ...]) -> list[Point]:
        """Return a polygon's corners, in the order that keeps its face outwards."""
        placed = [self.point(point) for point in points]
        return placed if self.side > 0 else placed[::-1]

    def moved(self, offset: Point) -> "Placing":
        """Return the placing of what is moved within this one."""
        return Placing(self.point(offset), self.side)

    def mirrored(self) -> "Placing":
        """Return the placing of this one's mirror image."""
        return Placing(self.shift, -self.side)


class DrawnPart(Part):
    """A part that only this adapter knows."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the part to a mesh."""
        raise NotImplementedError


class Picture(DrawnPart):
    """A quad that shows a printed region."""

    picture: Region
    on: shapes.Corners
    """Bottom left, bottom right, top right and top left, as a viewer sees them."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the quad."""
        add_picture(mesh, self.on, self.picture, place)


def add_picture(mesh: MeshBuilder, on: Sequence[Point], region: str, place: Placing) -> None:
    """Add a quad that shows a printed region; a mirrored one stays readable."""
    corners = [place.point(point) for point in on]
    order = (0, 1, 2, 3) if place.side > 0 else (1, 0, 3, 2)
    mesh.textured_quad([corners[index] for index in order], region)


Holder = shapes.BothSidesOf | shapes.RowOf | shapes.CopiesOf | shapes.ConditionOf
"""A part that only holds others."""


def placed_parts(
    part: Holder, place: Placing, applies: Callable[[str, float], bool]
) -> Iterator[tuple[Part, Placing]]:
    """Return the parts that a part holds, each with its place.

    Args:
        part: The part that holds them.
        place: Its own place.
        applies: Returns whether a word of a condition is met on a side.
    """
    parts: tuple[Part, ...] = ()
    places = [place]
    match part:
        case shapes.BothSidesOf():
            parts, places = part.both_sides, [place.mirrored(), place]
        case shapes.RowOf():
            (x, y, z), parts = part.step, part.parts
            places = [place.moved((k * x, k * y, k * z)) for k in range(part.repeat)]
        case shapes.CopiesOf():
            parts, places = part.parts, [place.moved(offset) for offset in part.at]
        case shapes.ConditionOf():
            is_on = all(applies(word, place.side) for word in part.when.split())
            parts = part.parts if is_on else part.otherwise
    return ((inner, inner_place) for inner_place in places for inner in parts)


@singledispatch
def add(part: Part, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    """Add a part to a mesh."""
    raise TypeError(f"{type(part).__name__} cannot be drawn")


@add.register
def _(part: DrawnPart, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    part.add(mesh, shown, place)


@add.register
def _(part: shapes.Box, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    mesh.box(place.point(part.box), part.size, shown.colour(part.colour), caps=part.caps)


@add.register
def _(part: shapes.Hull, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    mesh.hull(
        place.rectangle(part.hull),
        place.rectangle(part.top),
        shown.colour(part.colour),
        caps=part.caps,
        cap_colour=shown.colour(part.cap_colour or ""),
        sides=[shown.colour(side) for side in part.sides or ()],
    )


@add.register
def _(part: shapes.Beam, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    start, end, colour = place.point(part.beam), place.point(part.to), shown.colour(part.colour)
    mesh.beam(start, end, part.width, colour, end_width=part.end_width)


@add.register
def _(part: shapes.Tube, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    colours = [shown.colour(part.colour), shown.colour(part.second_colour or "")]
    for start, end in itertools.pairwise(sagging_points(part)):
        count = bands(part, start, end)
        for k in range(count):
            ends = (_between(start, end, share / count) for share in (k, k + 1))
            near, far = (place.point(point) for point in ends)
            mesh.beam(near, far, part.width, colours[k % 2])


def _between(start: Point, end: Point, share: float) -> Point:
    """Return the point at a share of the way; both ends are exact."""
    if share == 0.0:
        return start
    if share == 1.0:
        return end
    x, y, z = (a + share * (b - a) for a, b in zip(start, end, strict=True))
    return x, y, z


@add.register
def _(part: shapes.Cylinder, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    mesh.cylinder(
        place.point(part.cylinder),
        place.point(part.to),
        part.radius,
        shown.colour(part.colour),
        sides=part.sides,
        end_radius=part.end_radius,
        cap_colour=shown.colour(part.cap_colour or part.colour),
    )


@add.register
def _(part: shapes.Lathe, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    sections = zip(itertools.pairwise(part.lathe), part.colours, strict=True)
    for ((x0, y0, z0, radius), (x1, y1, z1, end_radius)), colour in sections:
        mesh.cylinder(
            place.point((x0, y0, z0)), place.point((x1, y1, z1)), radius, shown.colour(colour),
            sides=part.sides, end_radius=end_radius,
            cap_colour=shown.colour(part.cap_colour or colour),
        )  # fmt: skip


@add.register
def _(part: shapes.Ball, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    mesh.ball(
        place.point(part.ball),
        part.radii,
        shown.colour(part.colour),
        around=part.around,
        down=part.down,
        jitter=part.jitter,
        key=part.key,
        second_colour=shown.colour(part.second_colour or ""),
    )


@add.register
def _(part: shapes.Column, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    rings = [(place.point((x, y, z)), one, two) for x, y, z, one, two in part.column]
    names = (part.colour,) * (len(rings) - 1) if part.colour else part.colours
    colours = [shown.colour(name) for name in names]
    mesh.column(rings, colours, axis=part.axis, sides=part.sides, caps=part.caps)


@add.register
def _(part: shapes.Sheet, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    corners = place.outline(part.sheet)
    mesh.polygon(corners, shown.colour(part.colour))
    if part.back:
        mesh.polygon(corners[::-1], shown.colour(part.back))


@add.register
def _(part: shapes.Wheel, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    x, y, z = place.point((*part.wheel, 0.0))
    if x < 0.0 < y and shown.has("wheel_off"):
        _add_removed_wheel(part, mesh, (x, y, z))
    elif z == 0.0:
        mesh.wheel(x, y, part.radius, part.width, hub=part.hub)
    else:
        wheel = MeshBuilder().wheel(x, y, part.radius, part.width, hub=part.hub)
        mesh.add_surface(wheel.build(), (0.0, 0.0, z))


def _add_removed_wheel(part: shapes.Wheel, mesh: MeshBuilder, at: Point) -> None:
    """Add a bare hub, a jack beside it, and the wheel on the road."""
    (x, y, z), radius = at, part.radius
    hub = y - 0.4 * part.width
    mesh.cylinder(
        (x, hub, z + radius), (x, hub + 0.06, z + radius), 0.6 * radius, "metal", sides=12
    )
    mesh.cylinder((x, hub, z + radius), (x, y, z + radius), 0.2 * radius, "rust", sides=8)
    jack = (x + 1.7 * radius, y, z)
    mesh.beam(jack, (jack[0], y, z + 0.8 * radius), 0.1, "red", end_width=0.05)
    mesh.box((jack[0], y, z + 0.03), (0.26, 0.22, 0.06), "red")
    mesh.beam((jack[0], y, z + 0.1), (jack[0], y + 0.6, z + 0.16), 0.03, "silver")
    foot = (x - 0.5 * radius, y + 0.75, z)
    top = (foot[0], foot[1], z + part.width)
    mesh.cylinder(foot, top, radius, "tyre", sides=14)
    mesh.cylinder(top, (*top[:2], top[2] + 0.006), 0.62 * radius, part.hub, sides=10)


@add.register
def _(part: shapes.LampPart, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    mesh.lamp(place.point(part.lamp), part.light, place.direction(part.facing), part.power)
