"""The shapes of which designs are made.

A part is one inline table of a design; a key tells its kind: `{ box = [0, 0, 0.5], size = [1, 1, 1],
colour = "red" }` is a red cube on the ground. Lengths are in metres, x forward, y left, z up.
"""

import itertools
from dataclasses import dataclass
from typing import Annotated, Literal, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from oodscen_pybullet._meshes.atlas import COLOURS, REGIONS
from oodscen_pybullet._meshes.builder import MeshBuilder, Point
from oodscen_pybullet._meshes.look import Appearance


def _known_colour(name: str) -> str:
    if name not in COLOURS and name != "paint":
        raise ValueError(f"there is no colour {name!r}")
    return name


def _known_region(name: str) -> str:
    if name not in REGIONS:
        raise ValueError(f"there is no printed region {name!r}")
    return name


Colour = Annotated[str, AfterValidator(_known_colour)]
"""A colour of the atlas, or `paint` for the paint of the asset that is shown."""
Region = Annotated[str, AfterValidator(_known_region)]
"""A printed region of the atlas."""
Length = Annotated[float, Field(gt=0)]
PartT = TypeVar("PartT", bound="Part")
Pair = tuple[float, float]
Rectangle = tuple[float, float, float, float, float]
"""x0, x1, y0, y1 and z of an upright box's lower or upper face."""
Sides = Annotated[int, Field(ge=3, le=64)]
Caps = Literal["bt", "b", "t", ""]
"""The ends that are closed: bottom, top, both or none."""


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


class Part(BaseModel):
    """One part of a design."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the part to a mesh."""
        raise NotImplementedError


class Box(Part):
    """An upright box."""

    box: Point
    """Its centre."""
    size: tuple[Length, Length, Length]
    colour: Colour
    caps: Caps = "bt"

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the box."""
        mesh.box(place.point(self.box), self.size, shown.colour(self.colour), caps=self.caps)


class Hull(Part):
    """A box whose top differs from its bottom."""

    hull: Rectangle
    """The bottom."""
    top: Rectangle
    colour: Colour
    caps: Caps = "bt"
    cap_colour: Colour | None = None
    """Colour of both ends, if it differs."""
    sides: tuple[Colour, Colour, Colour, Colour] | None = None
    """Colours of the sides right, front, left and back, if they differ."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the hull."""
        mesh.hull(
            place.rectangle(self.hull),
            place.rectangle(self.top),
            shown.colour(self.colour),
            caps=self.caps,
            cap_colour=shown.colour(self.cap_colour or ""),
            sides=[shown.colour(side) for side in self.sides or ()],
        )


class Beam(Part):
    """A square bar, tapered if `end_width` is given."""

    beam: Point
    """Its start."""
    to: Point
    width: Length
    end_width: Length | None = None
    colour: Colour

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the bar."""
        start, end, colour = place.point(self.beam), place.point(self.to), shown.colour(self.colour)
        mesh.beam(start, end, self.width, colour, end_width=self.end_width)


class Tube(Part):
    """Square bars from point to point."""

    tube: Annotated[tuple[Point, ...], Field(min_length=2)]
    width: Length
    colour: Colour

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add a bar for each stretch."""
        points = [place.point(point) for point in self.tube]
        for start, end in itertools.pairwise(points):
            mesh.beam(start, end, self.width, shown.colour(self.colour))


class Cylinder(Part):
    """A round bar or disc; a cone if `end_radius` is given."""

    cylinder: Point
    """The centre of its first end."""
    to: Point
    radius: Length
    end_radius: Length | None = None
    colour: Colour
    cap_colour: Colour | None = None
    """Colour of both ends, if it differs."""
    sides: Sides = 10

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the cylinder."""
        mesh.cylinder(
            place.point(self.cylinder),
            place.point(self.to),
            self.radius,
            shown.colour(self.colour),
            sides=self.sides,
            end_radius=self.end_radius,
            cap_colour=shown.colour(self.cap_colour or self.colour),
        )


def _one_colour_per_stretch(part: PartT, rings: int, colours: tuple[str, ...]) -> PartT:
    if len(colours) != rings - 1:
        raise ValueError(f"{rings} rings need {rings - 1} colours, not {len(colours)}")
    return part


class Lathe(Part):
    """A body of revolution, of one colour from each ring to the next."""

    lathe: Annotated[tuple[tuple[float, float, float, Length], ...], Field(min_length=2)]
    """x, y, z and radius of the rings."""
    colours: tuple[Colour, ...]
    cap_colour: Colour | None = None
    sides: Sides = 10

    @model_validator(mode="after")
    def _colours_fit(self) -> Self:
        return _one_colour_per_stretch(self, len(self.lathe), self.colours)

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add a cone for each stretch."""
        for one, two, colour in zip(self.lathe[:-1], self.lathe[1:], self.colours, strict=True):
            start, end = place.point(one[:3]), place.point(two[:3])
            cap = shown.colour(self.cap_colour or colour)
            mesh.cylinder(
                start, end, one[3], shown.colour(colour),
                sides=self.sides, end_radius=two[3], cap_colour=cap,
            )  # fmt: skip


class Ball(Part):
    """An ellipsoid; `jitter` makes it a rock, a bush or a heap."""

    ball: Point
    """Its centre."""
    radii: tuple[Length, Length, Length]
    colour: Colour
    second_colour: Colour | None = None
    """Colour of every other patch, if it differs."""
    around: Sides = 8
    down: Sides = 5
    jitter: Annotated[float, Field(ge=0, lt=1)] = 0.0
    """Fraction of the radius by which corners move in or out."""
    key: int = 0
    """Seed of the jitter."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the ball."""
        mesh.ball(
            place.point(self.ball),
            self.radii,
            shown.colour(self.colour),
            around=self.around,
            down=self.down,
            jitter=self.jitter,
            key=self.key,
            second_colour=shown.colour(self.second_colour or ""),
        )


class Column(Part):
    """A smooth body through elliptic rings, for example a trunk or a torso."""

    column: Annotated[tuple[Rectangle, ...], Field(min_length=2)]
    """x, y, z and two radii of each ring: along x and y, or y and z for a body along x."""
    colour: Colour | None = None
    colours: tuple[Colour, ...] = ()
    """One colour from each ring to the next, in place of `colour`."""
    axis: Literal["x", "z"] = "z"
    sides: Sides = 8
    caps: Caps = "bt"

    @model_validator(mode="after")
    def _colours_fit(self) -> Self:
        if self.colour:
            return self
        return _one_colour_per_stretch(self, len(self.column), self.colours)

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the body."""
        rings = [(place.point((x, y, z)), one, two) for x, y, z, one, two in self.column]
        names = (self.colour,) * (len(rings) - 1) if self.colour else self.colours
        colours = [shown.colour(name) for name in names]
        mesh.column(rings, colours, axis=self.axis, sides=self.sides, caps=self.caps)


class Sheet(Part):
    """A flat convex polygon."""

    sheet: Annotated[tuple[Point, ...], Field(min_length=3)]
    """Its corners, counter-clockwise seen from the side that shows."""
    colour: Colour
    back: Colour | None = None
    """Colour of the back, which is invisible otherwise."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the polygon."""
        corners = place.outline(self.sheet)
        mesh.polygon(corners, shown.colour(self.colour))
        if self.back:
            mesh.polygon(corners[::-1], shown.colour(self.back))


class Picture(Part):
    """A quad that shows a printed region."""

    picture: Region
    on: tuple[Point, Point, Point, Point]
    """Bottom left, bottom right, top right and top left, as a viewer sees them."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the quad; a mirrored one stays readable."""
        one, two, three, four = (place.point(point) for point in self.on)
        mesh.picture(
            [one, two, three, four] if place.side > 0 else [two, one, four, three], self.picture
        )


class LampPart(Part):
    """A light that glows in the dark."""

    lamp: Point
    light: Point
    """Red, green and blue, 0 to 1."""
    facing: Point = (0.0, 0.0, 0.0)
    """Direction of the beam; zero shines in all directions."""
    power: Length = 1.0

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the lamp."""
        mesh.lamp(place.point(self.lamp), self.light, place.direction(self.facing), self.power)
