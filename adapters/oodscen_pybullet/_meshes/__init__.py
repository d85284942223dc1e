"""Low-poly meshes of everything that the adapter can show: most from designs, some from code."""

from collections.abc import Callable
from functools import lru_cache

from oodscen.data._details import Details
from oodscen.errors import UnknownComponent
from oodscen_pybullet._meshes.atlas import LOOKS
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import assemble, load_designs
from oodscen_pybullet._meshes.detailed import build_detailed
from oodscen_pybullet._meshes.living import people, wheelchair
from oodscen_pybullet._meshes.living.people import load_people
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.made import design_mesh, is_registered, register_design
from oodscen_pybullet._meshes.mesh import Lamp, Mesh, Puff
from oodscen_pybullet._meshes.objects import cargo, fires, flat, lights, plants, props, signs
from oodscen_pybullet._meshes.vehicles import ego, riders, wrecks
from oodscen_pybullet._types import Point

__all__ = [
    "FLASHING",
    "GAITS",
    "PAINTS",
    "SMOKING",
    "Lamp",
    "Mesh",
    "Puff",
    "asset_ids",
    "asset_mesh",
    "paints_of",
    "register_design",
]

_MODULES = (
    ego,
    riders,
    wrecks,
    people,
    wheelchair,
    props,
    cargo,
    flat,
    fires,
    signs,
    lights,
    plants,
)
_STILL: dict[str, Callable[[MeshBuilder], None]] = {
    maker.__name__: maker for module in _MODULES for maker in getattr(module, "STILL", ())
}
"""Builders of assets that always look the same and take arithmetic to describe, by id."""
_VARIED: dict[str, Callable[[MeshBuilder, Appearance], None]] = {
    maker.__name__: maker for module in _MODULES for maker in getattr(module, "VARIED", ())
}
"""Builders of assets whose shape depends on state, clothes or frame in ways of their own, by id."""

PAINTS: dict[str, tuple[str, ...]] = {k: tuple(v) for k, v in LOOKS["paints"].items()}
"""Colours or clothes of assets; an asset without an entry has one look."""
GAITS: dict[str, float] = LOOKS["strides"]
"""Stride length in metres at a walk, of every asset with moving legs."""
FLASHING: frozenset[str] = frozenset(
    {
        "hazard", "indicate_left", "indicate_right", "beacon", "flashing", "arrow_board",
        "level_crossing_gate", "temporary_light", "barrier",
    }
)  # fmt: skip
"""States whose lamps flash, and assets whose lamps flash in every state."""

SMOKING: frozenset[str] = frozenset({"burning_car", "smoke", "fire"})
"""Assets with moving smoke."""


def asset_ids() -> tuple[str, ...]:
    """Return the ids of all meshes, including the ego's."""
    designed = (name for name in load_designs() if not name.startswith("_"))
    return (*_STILL, *_VARIED, *load_people(), *designed)


def paints_of(asset: str) -> tuple[str, ...]:
    """Return the looks of an asset."""
    return PAINTS.get(asset, ("",))


@lru_cache(maxsize=512)
def asset_mesh(
    asset: str,
    state: str = "",
    paint: str = "",
    *,
    running: bool = False,
    frame: int = 0,
    details: Details | None = None,
) -> Mesh:
    """Return the mesh of an asset.

    Args:
        asset: An id of the catalogue, or of a registered design.
        state: A state of the asset.
        paint: A look of the asset; empty selects the first.
        running: Whether head and tail lamps are on.
        frame: Animation frame, see `appearance.Look.frame`.
        details: Pose, open parts ...; what is held or loaded may be a registered design.

    Raises:
        UnknownComponent: If no asset has this id.
    """
    if is_registered(asset):
        return design_mesh(asset, state, asset_mesh)
    if asset not in asset_ids():
        raise UnknownComponent("asset", asset, asset_ids())
    paint = paint or paints_of(asset)[0]
    if details is not None:
        shown = Appearance(state, details.colour or paint, running, frame, details)
        return build_detailed(asset, shown, _assemble, asset_mesh).build()
    shown = Appearance(state, paint, running, frame)
    return _assemble(asset, shown).shift(_centring(asset)).build()


def _assemble(asset: str, shown: Appearance) -> MeshBuilder:
    """Return a builder that holds an asset without details, where its design has it."""
    if asset in load_designs():
        return assemble(asset, shown)
    mesh = MeshBuilder()
    if asset in load_people():
        load_people()[asset].add(mesh, shown)
    elif asset in _STILL:
        _STILL[asset](mesh)
    else:
        _VARIED[asset](mesh, shown)
    return mesh


@lru_cache(maxsize=512)
def _centring(asset: str) -> Point:
    """Return the offset that centres an asset's footprint, at rest, on the origin."""
    low, high = _assemble(asset, Appearance(paint=paints_of(asset)[0])).bounds
    return (-float(low[0] + high[0]) / 2, -float(low[1] + high[1]) / 2, -float(low[2]))
