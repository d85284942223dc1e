"""The scenery of a map: its roads, the land, and the objects beside them."""

from dataclasses import dataclass, replace
from functools import lru_cache

from oodscen._seeding import stream
from oodscen.data._catalogue import RoadMap
from oodscen.data._map_state import MapState
from oodscen.driving._roads.corridor import Corridor
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.surfaces import lay_roads
from oodscen_pybullet._land.terrain import Terrain
from oodscen_pybullet._land.theme import Theme, theme_of
from oodscen_pybullet._meshes.mesh import Lamp, Mesh
from oodscen_pybullet._scenery.placing import Site
from oodscen_pybullet._scenery.signals import stand_signals
from oodscen_pybullet._scenery.structures import build_structures
from oodscen_pybullet._scenery.themes.furnishing import furnish
from oodscen_pybullet._types import Point

_SODIUM = (1.0, 0.82, 0.55)
"""Colour of the lamps of streets and tunnels."""
_ALL_ROUND = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Scenery:
    """Everything that does not move."""

    meshes: tuple[Mesh, ...]
    """The roads, the land, the roadside objects, and tunnels and bridges."""
    lamps: tuple[Lamp, ...]
    """The lit lamps of streets, those of tunnels, and the lit ones of traffic lights, in world coordinates."""
    terrain: Terrain
    """The shape of the ground, for placing objects on it."""


def build_scenery(
    corridor: Corridor,
    road: RoadMap,
    seed: int,
    *,
    is_night: bool = False,
    omitted: frozenset[str] = frozenset(),
    state: MapState | None = None,
    is_dark_phase: bool = False,
) -> Scenery:
    """Build the roads and their surroundings.

    Args:
        corridor: The ego's road, with the others of the map.
        road: The map, whose traits select city, suburb, highway or country.
        seed: Seed of the run.
        is_night: Whether windows and lamps are lit.
        omitted: Ids of map signals to omit, for instance because the scene has its own signals
            there: `oodscen_pybullet._scenery.signals.replaced_signals`.
        state: Faults of the map's lamps, lights and signs.
        is_dark_phase: Whether flashing lights are between two flashes.
    """
    theme = theme_of(road, corridor)
    terrain, roads, land = _build_land(corridor, theme, seed, road.id)
    ground = terrain.ground
    site = Site(ground, terrain, stream(seed, "scenery", road.id, "roadside"), state)
    signals = stand_signals(site, omitted, is_dark_phase=is_dark_phase)
    furnish(site, theme, is_night=is_night)
    spans, tunnel_lamps = build_structures(ground)
    return Scenery(
        meshes=(
            replace(roads, is_ground=True),
            replace(land, is_ground=True),
            site.mesh(),
            *spans,
        ),
        lamps=(*map(_street_lamp, [*site.lamps, *tunnel_lamps]), *signals),
        terrain=terrain,
    )


def _street_lamp(head: Point) -> Lamp:
    return Lamp(head, _SODIUM, facing=_ALL_ROUND, power=2.0, is_street=True)


@lru_cache(maxsize=12)
def _build_land(
    corridor: Corridor, theme: Theme, seed: int, map_id: str
) -> tuple[Terrain, Mesh, Mesh]:
    """Build the parts that are the same by day and by night: terrain, roads, land.

    The terrain caches heights of points, and variants of a map query the same points.
    """
    ground = Ground(corridor)
    terrain = Terrain(ground, theme, stream(seed, "scenery", map_id, "land"))
    roads = lay_roads(ground, theme, stream(seed, "scenery", map_id, "wear"))
    return terrain, roads, terrain.mesh()
