"""Designs: assets that are described as data, and their compiler.

The TOML files beside this module hold one table per asset. A table whose name starts with an
underscore is a component, which other designs use as a part.
"""

import math
import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated, get_args

from pydantic import BaseModel, ConfigDict, Discriminator, Tag, TypeAdapter

from oodscen.data._designs import shapes
from oodscen.data._designs.colours import Colour
from oodscen.data._designs.shapes import Part
from oodscen_pybullet._meshes.atlas import COLOURS
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import fittings, openings, parts, rings
from oodscen_pybullet._meshes.designs.parts import Holder, Placing, add, placed_parts
from oodscen_pybullet._meshes.look import Appearance

_PLAIN, _UNMOVED = Appearance(), Placing()


class DrawnBothSides(shapes.BothSidesOf):
    """Parts on the left side, and their mirror images on the right."""

    both_sides: "PlacedParts"


class DrawnRow(shapes.RowOf):
    """Parts repeated at equal steps."""

    parts: "PlacedParts"


class DrawnCopies(shapes.CopiesOf):
    """Parts repeated at given places."""

    parts: "PlacedParts"


class DrawnCondition(shapes.ConditionOf):
    """Parts that show only while a state or a lamp is on."""

    parts: "PlacedParts"
    otherwise: "PlacedParts" = ()


class DrawnTurned(shapes.TurnedOf):
    """Parts that are turned about x, then z, and moved."""

    turned: "Parts"


class Component(parts.DrawnPart):
    """Another design as a part."""

    asset: str
    """Id of an asset's design, or name of a component."""
    paint: Colour | None = None
    """Its paint, if it differs from that of the whole."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add all parts of the other design."""
        if self.paint:
            shown = shown.painted(shown.colour(self.paint))
        add_design(mesh, self.asset, shown, place)


def _kind(part: object) -> str | None:
    """Return the key that names the kind of a part."""
    keys = part if isinstance(part, dict) else getattr(type(part), "model_fields", ())
    return next((key for key in keys if key in _KINDS), None)


_Placed = (
    Annotated[shapes.Box, Tag("box")]
    | Annotated[shapes.Hull, Tag("hull")]
    | Annotated[shapes.Beam, Tag("beam")]
    | Annotated[shapes.Tube, Tag("tube")]
    | Annotated[shapes.Cylinder, Tag("cylinder")]
    | Annotated[shapes.Lathe, Tag("lathe")]
    | Annotated[shapes.Ball, Tag("ball")]
    | Annotated[shapes.Column, Tag("column")]
    | Annotated[shapes.Sheet, Tag("sheet")]
    | Annotated[parts.Picture, Tag("picture")]
    | Annotated[shapes.LampPart, Tag("lamp")]
    | Annotated[shapes.Wheel, Tag("wheel")]
    | Annotated[fittings.Arches, Tag("arches")]
    | Annotated[fittings.Beacon, Tag("beacon")]
    | Annotated[fittings.RearPrint, Tag("rear_print")]
    | Annotated[fittings.FrontPrint, Tag("front_print")]
    | Annotated[fittings.Octagon, Tag("octagon")]
    | Annotated[rings.SpokedWheel, Tag("spoked_wheel")]
    | Annotated[rings.Torus, Tag("torus")]
    | Annotated[DrawnBothSides, Tag("both_sides")]
    | Annotated[DrawnRow, Tag("repeat")]
    | Annotated[DrawnCopies, Tag("at")]
    | Annotated[DrawnCondition, Tag("when")]
)
_Fixed = (
    Annotated[DrawnTurned, Tag("turned")]
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
    | Annotated[openings.FrontDoors, Tag("front_doors")]
    | Annotated[openings.OpenBonnet, Tag("open_bonnet")]
    | Annotated[openings.OpenHatch, Tag("open_hatch")]
    | Annotated[openings.RearDoors, Tag("rear_doors")]
    | Annotated[openings.TailLift, Tag("tail_lift")]
    | Annotated[openings.SideText, Tag("side_text")]
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
            mesh.grounded()
        if self.centred:
            mesh.centred()
        return mesh.flatten(0.0) if self.flattened else mesh


CONTEXT = {"colours": frozenset({*COLOURS, "paint"})}
"""Validation context in which the colours of the atlas are known, and `paint` for that of the whole."""


def read_designs(package: str) -> dict[str, Design]:
    """Return the designs in the TOML files of a package."""
    paths = sorted(files(package).iterdir(), key=lambda path: path.name)
    texts = [path.read_text("utf-8") for path in paths if path.name.endswith(".toml")]
    tables = {name: table for text in texts for name, table in tomllib.loads(text).items()}
    return TypeAdapter(dict[str, Design]).validate_python(tables, context=CONTEXT)


@cache
def load_designs() -> dict[str, Design]:
    """Return the designs of assets by id."""
    return read_designs(__name__)


def assemble(asset: str, shown: Appearance) -> MeshBuilder:
    """Return a builder that holds an asset's design."""
    return load_designs()[asset].assemble(shown)


def add_design(
    mesh: MeshBuilder, name: str, shown: Appearance = _PLAIN, place: Placing = _UNMOVED
) -> None:
    """Add all parts of a design or component, moved or mirrored."""
    _add(load_designs()[name].parts, mesh, shown, place)


def _add(parts: tuple[Part, ...], mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    for part in parts:
        add(part, mesh, shown, place)


@add.register
def _(part: Holder, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    for inner, placing in placed_parts(part, place, shown.applies):
        add(inner, mesh, shown, placing)


@add.register
def _(part: shapes.TurnedOf, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
    group = MeshBuilder()
    _add(part.turned, group, shown, place)
    mesh.add_surface(group.build(), part.to, math.radians(part.yaw), roll=math.radians(part.roll))
