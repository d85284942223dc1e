"""The scenery of a map: its roads, the land, and what stands beside them."""

from dataclasses import dataclass, replace
from functools import lru_cache

from oodscen._seeding import stream
from oodscen.driving import Corridor
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.surfaces import lay_roads
from oodscen_pybullet._land.terrain import Terrain, Theme, theme_of
from oodscen_pybullet._meshes.builder import Lamp, Mesh, Point
from oodscen_pybullet._scenery.placing import Site
from oodscen_pybullet._scenery.signals import stand_signals
from oodscen_pybullet._scenery.structures import build_structures
from oodscen_pybullet._scenery.themes import furnish


@dataclass(frozen=True, eq=False)
class Scenery:
    """Everything that stands still."""

    meshes: tuple[Mesh, ...]
    """The roads, the land, what stands beside the roads, and tunnels and bridges."""
    lamps: tuple[Point, ...]
    """Heads of the street lamps, m."""
    signals: tuple[Lamp, ...]
    """What shines at traffic lights, in world coordinates."""
    terrain: Terrain
    """The shape of the ground, for whatever is put on it."""


def build_scenery(
    corridor: Corridor,
    traits: frozenset[str],
    seed: int,
    name: str,
    *,
    is_night: bool = False,
    without: frozenset[str] = frozenset(),
) -> Scenery:
    """Build the roads and what is beside them.

    Args:
        corridor: The ego's road, with the others of the map.
        traits: Of the map; they choose between city, suburb, highway and country.
        seed: The run's.
        name: Of the map.
        is_night: Whether windows and lamps are lit.
        without: Ids of the map's signals that are left out, for instance because the scene has
            its own there: `oodscen_pybullet._scenery.signals.replaced`.
    """
    theme = theme_of(traits, corridor)
    terrain, road, land = _lay(corridor, theme, seed, name)
    ground = terrain.ground
    site = Site(ground, terrain, stream(seed, "scenery", name, "roadside"))
    lights = stand_signals(site, without)
    furnish(site, theme, is_night=is_night)
    spans, tunnel_lamps = build_structures(ground)
    return Scenery(
        meshes=(
            replace(road, is_ground=True),
            replace(land, is_ground=True),
            site.mesh(),
            *spans,
        ),
        lamps=(*site.lamps, *tunnel_lamps),
        signals=tuple(lights),
        terrain=terrain,
    )


@lru_cache(maxsize=12)
def _lay(corridor: Corridor, theme: Theme, seed: int, name: str) -> tuple[Terrain, Mesh, Mesh]:
    """Build what is the same by day and by night: the ground's shape, the roads, the land.

    Terrain and ground remember what was asked about single places, and variants of a map ask about
    the same ones.
    """
    ground = Ground(corridor)
    terrain = Terrain(ground, theme, stream(seed, "scenery", name, "land"))
    road = lay_roads(ground, theme, stream(seed, "scenery", name, "wear"))
    return terrain, road, terrain.mesh()
