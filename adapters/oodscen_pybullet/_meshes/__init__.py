"""Generated low-poly meshes of everything the adapter can show."""

import inspect
from collections.abc import Callable
from functools import lru_cache

from oodscen.errors import UnknownComponent
from oodscen_pybullet._meshes.builder import Lamp, Mesh, MeshBuilder, Point, Puff
from oodscen_pybullet._meshes.living import animals, people, roles
from oodscen_pybullet._meshes.look import Lights, Shown
from oodscen_pybullet._meshes.objects import cargo, flat, plants, props, signs, work_zone
from oodscen_pybullet._meshes.objects import misc as oddities
from oodscen_pybullet._meshes.vehicles import cars, haulers, heavy, riders, wagons

__all__ = [
    "FLASHING",
    "GAITS",
    "PAINTS",
    "SMOKING",
    "Lamp",
    "Lights",
    "Mesh",
    "Puff",
    "asset_ids",
    "asset_mesh",
    "paints_of",
]

Maker = Callable[[Shown], MeshBuilder]

_MODULES = (
    cars,
    wagons,
    heavy,
    haulers,
    riders,
    people,
    roles,
    animals,
    props,
    cargo,
    flat,
    oddities,
    work_zone,
    signs,
    plants,
)


_MAKERS: dict[str, Maker] = {
    name: value
    for module in _MODULES
    for name, value in vars(module).items()
    if inspect.isfunction(value)
    and not name.startswith("_")
    and list(inspect.signature(value).parameters) == ["shown"]
}
"""Every public function of the mesh modules that takes only `shown`, by name."""

PAINTS: dict[str, tuple[str, ...]] = {
    "car": ("red", "blue", "silver", "white", "dark_grey", "green", "burgundy"),
    "van": ("white", "silver", "blue", "dark_grey"),
    "truck": ("blue", "red", "green", "dark_grey"),
    "bus": ("red", "teal", "yellow"),
    "suv": ("black", "white", "navy", "sand", "burgundy"),
    "pickup": ("red", "white", "dark_grey", "blue"),
    "car_door": ("red", "blue", "silver", "white"),
    "bumper": ("silver", "red", "white"),
    "barrel": ("blue", "green", "red"),
    "tanker": ("red", "blue", "white"),
    "overturned_car": ("red", "blue", "silver", "white"),
    "overturned_truck": ("blue", "red", "green"),
    "motorcycle": ("red", "blue", "green"),
    "cyclist": ("0", "1", "2"),
    "adult": ("0", "1", "2", "3", "4", "5"),
    "child": ("0", "1", "2"),
    "jogger": ("0", "1", "2"),
    "elderly_person": ("0", "1"),
    "protester": ("0", "1", "2"),
    "e_scooter": ("0", "1", "2"),
    "ego_car": ("silver",),
}
"""Colours or clothes of assets; an asset without an entry has one look."""

GAITS: dict[str, float] = {
    "adult": 1.1,
    "child": 0.8,
    "worker": 0.93,
    "police_officer": 0.83,
    "jogger": 1.2,
    "elderly_person": 0.64,
    "person_with_stroller": 0.93,
    "construction_flagger": 0.83,
    "person_in_costume": 0.86,
    "protester": 0.86,
    "wheelchair_user": 1.9,
    "cyclist": 4.5,
    "cargo_bike": 3.5,
    "deer": 0.76,
    "moose": 1.1,
    "horse": 0.93,
    "cow": 0.71,
    "sheep": 0.4,
    "wild_boar": 0.36,
    "bear": 0.72,
    "dog": 0.41,
    "cat": 0.19,
    "goose": 0.33,
}
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
    return tuple(_MAKERS)


def paints_of(asset: str) -> tuple[str, ...]:
    """Return the looks of an asset."""
    return PAINTS.get(asset, ("",))


@lru_cache(maxsize=512)
def asset_mesh(
    asset: str, state: str = "", paint: str = "", *, running: bool = False, frame: int = 0
) -> Mesh:
    """Return the mesh of an asset.

    Args:
        asset: An id of the catalogue.
        state: A state of the asset.
        paint: A look of the asset; empty selects the first.
        running: Whether head and tail lamps are on.
        frame: Animation frame, see `appearance.Look.frame`.

    Raises:
        UnknownComponent: If there is no such asset.
    """
    if asset not in _MAKERS:
        raise UnknownComponent("asset", asset, asset_ids())
    shown = Shown(state, paint or paints_of(asset)[0], running, frame)
    return _MAKERS[asset](shown).shift(_rest(asset)).build()


@lru_cache(maxsize=512)
def _rest(asset: str) -> Point:
    """Return the offset that centres an asset's footprint, at rest, on the origin."""
    low, high = _MAKERS[asset](Shown(paint=paints_of(asset)[0])).bounds
    return (-float(low[0] + high[0]) / 2, -float(low[1] + high[1]) / 2, -float(low[2]))
