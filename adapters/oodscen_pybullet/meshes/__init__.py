"""Generated low-poly meshes of everything that the adapter can show."""

from collections.abc import Callable
from functools import lru_cache

from oodscen.errors import UnknownComponent
from oodscen_pybullet.meshes import animals, cars, heavy, people, plants, props, work_zone
from oodscen_pybullet.meshes.bodywork import Lights
from oodscen_pybullet.meshes.builder import Lamp, Mesh, MeshBuilder, Puff

__all__ = [
    "FLASHING",
    "FLAT",
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

Maker = Callable[[Lights, str], MeshBuilder]

_MAKERS: dict[str, Maker] = {
    maker.__name__: maker
    for maker in (
        cars.car, cars.van, heavy.truck, heavy.bus, cars.police_car, cars.ambulance,
        heavy.fire_truck, people.motorcycle, heavy.tractor, cars.overturned_car,
        heavy.overturned_truck, heavy.excavator, people.cyclist, people.adult, people.child,
        people.worker, people.police_officer, animals.deer, animals.dog, animals.cow,
        props.cardboard_box, props.plant_pot, props.tyre, props.mattress, props.sofa, props.pallet,
        props.ladder, props.rock, props.debris, props.shopping_cart, props.suitcase,
        props.wheelie_bin, props.snow_pile, props.puddle, work_zone.cone, work_zone.barrier,
        work_zone.road_closed_sign, work_zone.detour_sign, plants.fallen_tree, plants.branch,
        cars.ego_car,
    )
}  # fmt: skip

PAINTS: dict[str, tuple[str, ...]] = {
    "car": ("red", "blue", "silver", "white", "dark_grey", "green", "burgundy"),
    "van": ("white", "silver", "blue", "dark_grey"),
    "truck": ("blue", "red", "green", "dark_grey"),
    "bus": ("red", "teal", "yellow"),
    "overturned_car": ("red", "blue", "silver", "white"),
    "overturned_truck": ("blue", "red", "green"),
    "motorcycle": ("red", "blue", "green"),
    "cyclist": ("0", "1", "2"),
    "adult": ("0", "1", "2", "3", "4", "5"),
    "child": ("0", "1", "2"),
    "ego_car": ("silver",),
}
"""Colours or clothes in which an asset comes; the others have one look."""

FLAT: frozenset[str] = frozenset({"puddle"})
"""Assets over which one can drive: they collide with nothing."""

GAITS: dict[str, float] = {}
"""Metres of one stride at a walk, of whatever has legs that move."""

FLASHING: frozenset[str] = frozenset({"hazard", "indicate_left", "indicate_right", "beacon"})
"""States, and assets whatever their state, whose lamps flash."""

SMOKING: frozenset[str] = frozenset()
"""Assets whose smoke moves."""


def asset_ids() -> tuple[str, ...]:
    """Return the ids of all meshes, the ego's included."""
    return (*_MAKERS, "arrow_board")


def paints_of(asset: str) -> tuple[str, ...]:
    """Return the looks in which an asset comes."""
    return PAINTS.get(asset, ("",))


@lru_cache(maxsize=512)
def asset_mesh(
    asset: str, state: str = "", paint: str = "", *, running: bool = False, frame: int = 0
) -> Mesh:
    """Return the mesh of an asset.

    Args:
        asset: An id of the catalogue.
        state: One of its states.
        paint: One of its looks; empty is the first.
        running: Whether head and tail lamps are on.
        frame: Which picture of what moves by itself, see `cast.Look.frame`.

    Raises:
        UnknownComponent: When there is no such asset.
    """
    if asset == "arrow_board":
        return work_zone.arrow_board(state).centred().build()
    if asset not in _MAKERS:
        raise UnknownComponent("asset", asset, asset_ids())
    lights = Lights.of(state, running=running)
    builder = _MAKERS[asset](lights, paint or paints_of(asset)[0])
    return builder.centred().build(hollow=asset in FLAT)
