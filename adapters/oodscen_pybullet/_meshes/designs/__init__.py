"""Designs: assets that are described as data, and their compiler.

The TOML files beside this module hold one table per asset. A table whose name starts with an
underscore is a component, which other designs use as a part.
"""

import math
import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated, get_args

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, TypeAdapter

from oodscen_pybullet._meshes.builder import MeshBuilder, Point
from oodscen_pybullet._meshes.designs import fittings, parts
from oodscen_pybullet._meshes.designs.parts import Colour, Part, Placing
from oodscen_pybullet._meshes.look import Appearance


class BothSides(Part):
    """Parts on the left side, and their mirror images on the right."""

    both_sides: "PlacedParts"

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the right side, then the left."""
        for one in (place.mirrored(), place):
            _add(self.both_sides, mesh, shown, one)


class Row(Part):
    """Parts repeated at equal steps."""

    repeat: Annotated[int, Field(ge=2, le=64)]
    step: Point
    parts: "PlacedParts"

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add every copy."""
        x, y, z = self.step
        for k in range(self.repeat):
            _add(self.parts, mesh, shown, place.moved((k * x, k * y, k * z)))


class Copies(Part):
    """Parts repeated at given places."""

    at: tuple[Point, ...]
    parts: "PlacedParts"

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add every copy."""
        for offset in self.at:
            _add(self.parts, mesh, shown, place.moved(offset))


class Condition(Part):
    """Parts that show only while a state or a lamp is on."""

    when: Annotated[str, Field(min_length=1)]
    """Words that must all apply, see `Appearance.applies`."""
    parts: "PlacedParts"
    otherwise: "PlacedParts" = ()

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the parts that apply."""
        is_on = all(shown.applies(word, place.side) for word in self.when.split())
        _add(self.parts if is_on else self.otherwise, mesh, shown, place)


class Turned(Part):
    """Parts that are turned about x, then z, and moved."""

    turned: "Parts"
    roll: float = 0.0
    """Angle about x, degrees."""
    yaw: float = 0.0
    """Angle about z, degrees."""
    to: Point = (0.0, 0.0, 0.0)

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the turned parts; their lamps are left out."""
        whole = MeshBuilder()
        _add(self.turned, whole, shown, place)
        mesh.add(whole.build(), self.to, math.radians(self.yaw), roll=math.radians(self.roll))


class Component(Part):
    """Another design as a part."""

    asset: str
    """Id of an asset's design, or name of a component."""
    paint: Colour | None = None
    """Its paint, if it differs from that of the whole."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add all parts of the other design."""
        if self.paint:
            shown = shown.painted(shown.colour(self.paint))
        _add(load_designs()[self.asset].parts, mesh, shown, place)


def _kind(part: object) -> str | None:
    """Return the key that names the kind of a part."""
    keys = part if isinstance(part, dict) else getattr(type(part), "model_fields", ())
    return next((key for key in keys if key in _KINDS), None)


_Placed = (
    Annotated[parts.Box, Tag("box")]
    | Annotated[parts.Hull, Tag("hull")]
    | Annotated[parts.Beam, Tag("beam")]
    | Annotated[parts.Tube, Tag("tube")]
    | Annotated[parts.Cylinder, Tag("cylinder")]
    | Annotated[parts.Lathe, Tag("lathe")]
    | Annotated[parts.Ball, Tag("ball")]
    | Annotated[parts.Column, Tag("column")]
    | Annotated[parts.Sheet, Tag("sheet")]
    | Annotated[parts.Picture, Tag("picture")]
    | Annotated[parts.LampPart, Tag("lamp")]
    | Annotated[fittings.Wheel, Tag("wheel")]
    | Annotated[fittings.Arches, Tag("arches")]
    | Annotated[fittings.Beacon, Tag("beacon")]
    | Annotated[fittings.RearPrint, Tag("rear_print")]
    | Annotated[fittings.FrontPrint, Tag("front_print")]
    | Annotated[BothSides, Tag("both_sides")]
    | Annotated[Row, Tag("repeat")]
    | Annotated[Copies, Tag("at")]
    | Annotated[Condition, Tag("when")]
)
_Fixed = (
    Annotated[Turned, Tag("turned")]
    | Annotated[Component, Tag("asset")]
    | Annotated[fittings.Shell, Tag("shell")]
    | Annotated[fittings.Cab, Tag("cab")]
    | Annotated[fittings.Chassis, Tag("chassis")]
    | Annotated[fittings.Underside, Tag("underside")]
    | Annotated[fittings.RearLamps, Tag("rear_lamps")]
    | Annotated[fittings.HeadLamps, Tag("head_lamps")]
    | Annotated[fittings.LightBar, Tag("light_bar")]
    | Annotated[fittings.Plates, Tag("plates")]
    | Annotated[fittings.SidePrint, Tag("side_print")]
    | Annotated[fittings.Legs, Tag("legs")]
    | Annotated[fittings.WebbedFeet, Tag("webbed_feet")]
)
PlacedParts = tuple[Annotated[_Placed, Discriminator(_kind)], ...]
"""Parts that can be moved and mirrored."""
Parts = tuple[Annotated[_Placed | _Fixed, Discriminator(_kind)], ...]
"""Parts of a whole."""
_KINDS = frozenset(
    tag.tag for kind in get_args(_Placed | _Fixed) for tag in get_args(kind) if isinstance(tag, Tag)
)


class Design(BaseModel):
    """An asset that is described as data."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    parts: Parts
    grounded: bool = False
    """True if the lowest foot of a moving body is to touch the ground in every frame."""
    centred: bool = False
    """True if the footprint's centre is the origin in every look, and not only at rest."""
    flattened: bool = False
    """True if everything below the ground is flattened onto it."""

    def assemble(self, shown: Appearance) -> MeshBuilder:
        """Return a builder that holds the design."""
        mesh = MeshBuilder()
        _add(self.parts, mesh, shown, Placing())
        if self.grounded:
            low, _ = mesh.bounds
            mesh.shift((0.0, 0.0, -float(low[2])))
        if self.centred:
            mesh.centred()
        return mesh.flatten(0.0) if self.flattened else mesh


def read_designs(package: str) -> dict[str, Design]:
    """Return the designs in the TOML files of a package."""
    paths = sorted(files(package).iterdir(), key=lambda path: path.name)
    texts = [path.read_text("utf-8") for path in paths if path.name.endswith(".toml")]
    tables = {name: table for text in texts for name, table in tomllib.loads(text).items()}
    return TypeAdapter(dict[str, Design]).validate_python(tables)


@cache
def load_designs() -> dict[str, Design]:
    """Return the designs of assets by id."""
    return read_designs(__name__)


def assemble(asset: str, shown: Appearance) -> MeshBuilder:
    """Return a builder that holds an asset's design."""
    return load_designs()[asset].assemble(shown)


def _add(parts: tuple[Part, ...], mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    for part in parts:
        part.add(mesh, shown, place)
