"""The shapes of which things are made.

A part is one small mapping; a key names its kind: `{"box": [0, 0, 0.5], "size": [1, 1, 1], "colour": "red"}` is
a red cube on the ground. Lengths are in metres, x forward, y left, z up; angles are in degrees.
"""

import itertools
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from oodscen.data._base import Data, no_truth_value
from oodscen.data._designs.colours import Colour
from oodscen.data._issues import MOST_PARTS


def _number(value: object) -> object:
    """Return a value unless pydantic takes it for a number though it is none: `true`, `1_0` in quotes."""
    if isinstance(value, str) and "_" in value:
        raise ValueError("must be a number, without underscores")
    return no_truth_value(value)


A_NUMBER = BeforeValidator(_number)
Metres = Annotated[float, Field(ge=-20, le=20), A_NUMBER]
Length = Annotated[float, Field(gt=0, le=20), A_NUMBER]
Degrees = Annotated[float, Field(ge=-360, le=360), A_NUMBER]
Share = Annotated[float, Field(ge=0, le=1), A_NUMBER]
Point = tuple[Metres, Metres, Metres]
Pair = tuple[Metres, Metres]
Corners = tuple[Point, Point, Point, Point]
"""Bottom left, bottom right, top right and top left, as a viewer sees them."""
Rectangle = tuple[Metres, Metres, Metres, Metres, Metres]
"""x0, x1, y0, y1 and z of an upright box's lower or upper face."""
Sides = Annotated[int, Field(ge=3, le=64), A_NUMBER]
Caps = Literal["bt", "b", "t", ""]
"""The ends that are closed: bottom, top, both or none."""
Key = Annotated[int, Field(ge=0, le=1_000_000), A_NUMBER]


class Part(Data):
    """One part of a design."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        self._check()
        return self

    def _check(self) -> None:
        """Raise a `ValueError` if the fields do not fit together."""


class Box(Part):
    """An upright box."""

    box: Point
    """Its centre."""
    size: tuple[Length, Length, Length]
    colour: Colour
    caps: Caps = "bt"


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

    def _check(self) -> None:
        for x0, x1, y0, y1, _ in (self.hull, self.top):
            if x0 > x1 or y0 > y1:
                raise ValueError("the order of a face is x0, x1, y0, y1, z, the smaller first")
        if self.hull[4] >= self.top[4]:
            raise ValueError("the top must be above the bottom")


class Beam(Part):
    """A square bar, tapered if `end_width` is given."""

    beam: Point
    """Its start."""
    to: Point
    width: Length
    end_width: Length | None = None
    colour: Colour

    def _check(self) -> None:
        _check_apart((self.beam, self.to))


class Tube(Part):
    """Square bars from point to point."""

    tube: Annotated[tuple[Point, ...], Field(min_length=2, max_length=64)]
    width: Length
    colour: Colour
    second_colour: Colour | None = None
    """Colour of every other band of `pitch`, if it is banded."""
    pitch: Annotated[float, Field(ge=0.05, le=5), A_NUMBER] = 0.5
    """Length of a band, m."""
    sag: Annotated[float, Field(ge=0, le=4), A_NUMBER] = 0.0
    """Distance by which the middle of every stretch hangs down, m."""

    def _check(self) -> None:
        _check_apart(self.tube)


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

    def _check(self) -> None:
        _check_apart((self.cylinder, self.to))


class Lathe(Part):
    """A body of revolution, of one colour from each ring to the next."""

    lathe: Annotated[
        tuple[tuple[Metres, Metres, Metres, Length], ...], Field(min_length=2, max_length=24)
    ]
    """x, y, z and radius of the rings."""
    colours: tuple[Colour, ...]
    cap_colour: Colour | None = None
    sides: Sides = 10

    def _check(self) -> None:
        _check_apart(tuple(ring[:3] for ring in self.lathe))
        _check_colours(len(self.lathe), self.colours)


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
    jitter: Annotated[float, Field(ge=0, lt=1), A_NUMBER] = 0.0
    """Fraction of the radius by which corners move in or out."""
    key: Key = 0
    """Seed of the jitter."""


class Column(Part):
    """A smooth body through elliptic rings, for example a trunk or a torso."""

    column: Annotated[
        tuple[tuple[Metres, Metres, Metres, Length, Length], ...],
        Field(min_length=2, max_length=24),
    ]
    """x, y, z and two radii of each ring: along x and y, or y and z for a body along x."""
    colour: Colour | None = None
    colours: tuple[Colour, ...] = ()
    """One colour from each ring to the next, in place of `colour`."""
    axis: Literal["x", "z"] = "z"
    sides: Sides = 8
    caps: Caps = "bt"

    def _check(self) -> None:
        along = [ring[0 if self.axis == "x" else 2] for ring in self.column]
        if any(b < a for a, b in itertools.pairwise(along)):
            raise ValueError("the rings must be ordered upwards, or forwards along x")
        if not self.colour:
            _check_colours(len(self.column), self.colours)
        elif self.colours:
            raise ValueError("it has one colour or one from each ring to the next, not both")


class Sheet(Part):
    """A flat convex polygon."""

    sheet: Annotated[tuple[Point, ...], Field(min_length=3, max_length=24)]
    """Its corners, counter-clockwise seen from the side that shows."""
    colour: Colour
    back: Colour | None = None
    """Colour of the back, which is invisible otherwise."""

    def _check(self) -> None:
        _check_area(self.sheet)


class Wheel(Part):
    """A wheel that stands on the ground, with its hub facing away from y = 0."""

    wheel: Pair
    """x and y of its middle."""
    radius: Length
    width: Length
    hub: Colour = "hub"


class LampPart(Part):
    """A light that glows in the dark."""

    lamp: Point
    light: tuple[Share, Share, Share]
    """Red, green and blue, 0 to 1."""
    facing: Point = (0.0, 0.0, 0.0)
    """Direction of the beam, of any length; zero shines in all directions."""
    power: Annotated[float, Field(gt=0, le=6), A_NUMBER] = 1.0


class Panel(Part):
    """A quad with a pattern."""

    panel: Corners
    pattern: Literal["plain", "stripes", "checks", "planks", "bricks", "windows", "net", "speckle"]
    colour: Colour
    second_colour: Colour = "white"
    pitch: Annotated[float, Field(ge=0.05, le=5), A_NUMBER] = 0.25
    """Width of a stripe, board, brick, window or mesh, m."""
    back: bool = True
    """True if it shows from behind as well."""
    key: Key = 0
    """Seed of the speckle."""

    def _check(self) -> None:
        _check_area(self.panel)


class Text(Part):
    """Words in capitals on a quad."""

    text: Annotated[str, Field(min_length=1, max_length=24, pattern=r"^[A-Z0-9 .!?-]+$")]
    on: Corners
    ink: Colour = "black"
    paper: Colour | None = None
    """Colour of the ground; left out if it stands on another part."""

    def _check(self) -> None:
        _check_apart((*self.on, self.on[0]))
        _check_area(self.on)


class Heap(Part):
    """A heap of lumps on the ground: foam, rubble, sand, fruit."""

    heap: Pair
    """x and y of its middle."""
    size: tuple[Length, Length, Length]
    colour: Colour
    second_colour: Colour | None = None
    """Colour of every third lump, if it differs."""
    lumps: Annotated[int, Field(ge=3, le=80), A_NUMBER] = 30
    rough: Annotated[float, Field(ge=0, le=0.5), A_NUMBER] = 0.0
    """0 for round lumps such as foam; 0.3 makes rubble."""
    key: Key = 0


class Veil(Part):
    """Soft balls of dust, smoke, steam or spray; what is behind them is hidden."""

    veil: Point
    """The middle of its underside."""
    size: tuple[Length, Length, Length]
    colour: Colour
    form: Literal["cloud", "funnel", "jet"] = "cloud"
    """A `funnel` is thin below and wide above, a `jet` thin and dense."""
    density: Annotated[float, Field(ge=0.05, le=1), A_NUMBER] = 0.6
    puffs: Annotated[int, Field(ge=3, le=40), A_NUMBER] = 20
    bright: bool = False
    """True for fire and sparks."""
    key: Key = 0


class Swarm(Part):
    """Specks in the air: bees, sparks, hail, confetti."""

    swarm: Point
    """Its middle."""
    size: tuple[Length, Length, Length]
    speck: Annotated[float, Field(ge=0.02, le=0.5), A_NUMBER]
    """Size of a speck, m."""
    colour: Colour
    second_colour: Colour | None = None
    count: Annotated[int, Field(ge=3, le=300), A_NUMBER] = 80
    key: Key = 0


class Blot(Part):
    """A patch of irregular outline that lies on the road: liquid, mud, paint."""

    blot: Pair
    """x and y of its middle."""
    size: tuple[Length, Length]
    colour: Colour
    ragged: Annotated[float, Field(ge=0, le=0.5), A_NUMBER] = 0.15
    """Fraction by which the outline moves inwards."""
    height: Annotated[float, Field(ge=0.005, le=0.07), A_NUMBER] = 0.014
    """Height above the road, m; of two that overlap the higher one shows."""
    key: Key = 0


class Strip(Part):
    """A line painted on the road."""

    strip: Annotated[tuple[Pair, ...], Field(min_length=2, max_length=32)]
    width: Annotated[float, Field(ge=0.03, le=5), A_NUMBER]
    colour: Colour
    dash: Annotated[float, Field(ge=0, le=10), A_NUMBER] = 0.0
    """Length of a dash and of a gap, m; 0 for an unbroken line."""
    height: Annotated[float, Field(ge=0.005, le=0.07), A_NUMBER] = 0.016

    def _check(self) -> None:
        _check_apart(tuple((x, y, 0.0) for x, y in self.strip))


class BothSidesOf(Part):
    """Parts on the left side, and their mirror images on the right."""

    both_sides: tuple[Part, ...]


class RowOf(Part):
    """Parts repeated at equal steps."""

    repeat: Annotated[int, Field(ge=2, le=64), A_NUMBER]
    step: Point
    parts: tuple[Part, ...]


class CopiesOf(Part):
    """Parts repeated at given places."""

    at: Annotated[tuple[Point, ...], Field(max_length=64)]
    parts: tuple[Part, ...]


class ConditionOf(Part):
    """Parts that show only while a state or a lamp is on."""

    when: Annotated[str, Field(min_length=1, max_length=60)]
    """Words that must all apply: states of the thing."""
    parts: tuple[Part, ...]
    otherwise: tuple[Part, ...] = ()

    def _check(self) -> None:
        if not self.when.split():
            raise ValueError("the condition names no state")


class TurnedOf(Part):
    """Parts that are turned about x, then z, and moved."""

    turned: tuple[Part, ...]
    roll: Degrees = 0.0
    """Angle about x."""
    yaw: Degrees = 0.0
    """Angle about z."""
    to: Point = (0.0, 0.0, 0.0)


class AssetPart(Part):
    """A thing of the catalogue as a part."""

    asset: Annotated[str, Field(min_length=1, max_length=60)]
    """Its id."""
    state: Annotated[str, Field(max_length=40)] = ""
    to: Point = (0.0, 0.0, 0.0)
    """New place of the middle of its footprint."""
    roll: Degrees = 0.0
    yaw: Degrees = 0.0
    scale: Annotated[float, Field(ge=0.1, le=5), A_NUMBER] = 1.0


class BothSides(BothSidesOf):
    """Parts on the left side, and their mirror images on the right."""

    both_sides: "Parts"


class Row(RowOf):
    """Parts repeated at equal steps."""

    parts: "Parts"


class Copies(CopiesOf):
    """Parts repeated at given places."""

    parts: "Parts"


class Condition(ConditionOf):
    """Parts that show only while a state is on."""

    parts: "Parts"
    otherwise: "Parts" = ()


class Turned(TurnedOf):
    """Parts that are turned about x, then z, and moved."""

    turned: "Parts"


KINDS = (
    "box", "hull", "beam", "tube", "cylinder", "lathe", "ball", "column", "sheet", "wheel", "lamp",
    "panel", "text", "heap", "veil", "swarm", "blot", "strip", "both_sides", "repeat", "at", "when",
    "turned", "asset",
)  # fmt: skip
"""The keys that name the kind of a part."""


def kind_of(part: object) -> str | None:
    """Return the key that names the kind of a part."""
    keys = part if isinstance(part, dict) else getattr(type(part), "model_fields", ())
    return next((key for key in KINDS if key in keys), None)


AnyPart = Annotated[
    Annotated[Box, Tag("box")]
    | Annotated[Hull, Tag("hull")]
    | Annotated[Beam, Tag("beam")]
    | Annotated[Tube, Tag("tube")]
    | Annotated[Cylinder, Tag("cylinder")]
    | Annotated[Lathe, Tag("lathe")]
    | Annotated[Ball, Tag("ball")]
    | Annotated[Column, Tag("column")]
    | Annotated[Sheet, Tag("sheet")]
    | Annotated[Wheel, Tag("wheel")]
    | Annotated[LampPart, Tag("lamp")]
    | Annotated[Panel, Tag("panel")]
    | Annotated[Text, Tag("text")]
    | Annotated[Heap, Tag("heap")]
    | Annotated[Veil, Tag("veil")]
    | Annotated[Swarm, Tag("swarm")]
    | Annotated[Blot, Tag("blot")]
    | Annotated[Strip, Tag("strip")]
    | Annotated[BothSides, Tag("both_sides")]
    | Annotated[Row, Tag("repeat")]
    | Annotated[Copies, Tag("at")]
    | Annotated[Condition, Tag("when")]
    | Annotated[Turned, Tag("turned")]
    | Annotated[AssetPart, Tag("asset")],
    Discriminator(
        kind_of,
        custom_error_type="part_kind",
        custom_error_message=f"a part has one key that names its kind: {', '.join(KINDS)}",
    ),
]
"""A part of a thing that is described as data."""
Parts = Annotated[tuple[AnyPart, ...], Field(max_length=MOST_PARTS)]


def _check_apart(points: tuple[Point, ...]) -> None:
    for one, two in itertools.pairwise(points):
        if sum((a - b) ** 2 for a, b in zip(one, two, strict=True)) < 1e-8:
            raise ValueError("points that follow each other must be apart")


def _check_colours(rings: int, colours: tuple[str, ...]) -> None:
    if len(colours) != rings - 1:
        raise ValueError(f"{rings} rings need {rings - 1} colours, not {len(colours)}")


def _check_area(corners: tuple[Point, ...]) -> None:
    nx = ny = nz = 0.0
    for (x0, y0, z0), (x1, y1, z1) in zip(corners, (*corners[1:], corners[0]), strict=True):
        nx += (y0 - y1) * (z0 + z1)
        ny += (z0 - z1) * (x0 + x1)
        nz += (x0 - x1) * (y0 + y1)
    if nx * nx + ny * ny + nz * nz < 1e-8:
        raise ValueError("the corners enclose no area")
