"""All objects beside the roads of a map, by its kind of land."""

from oodscen_pybullet._land.theme import Theme
from oodscen_pybullet._meshes.shapes import CIRCLE
from oodscen_pybullet._scenery import greenery
from oodscen_pybullet._scenery.placing import RoadsidePlace, Site
from oodscen_pybullet._scenery.themes.city import furnish_city
from oodscen_pybullet._scenery.themes.country import furnish_country
from oodscen_pybullet._scenery.themes.highway import furnish_highway
from oodscen_pybullet._scenery.themes.suburb import furnish_suburb


def furnish(site: Site, theme: Theme, *, is_night: bool) -> None:
    """Add everything beside the roads.

    Args:
        site: Receives the objects.
        theme: The kind of land.
        is_night: Whether windows and lamps are lit.
    """
    for x, y, radius in site.terrain.islands.circles:
        _plant_island(site, x, y, radius)
    match theme:
        case "residential":
            furnish_suburb(site, is_night)
        case "urban":
            furnish_city(site, is_night)
        case "highway":
            furnish_highway(site)
        case "rural":
            furnish_country(site, is_night)


def _plant_island(site: Site, x: float, y: float, radius: float) -> None:
    """Plant trees and bushes on the centre of a roundabout."""
    spot = RoadsidePlace(x, y, (1.0, 0.0), 0.0, 1)
    site.claim(x, y, spot.heading, radius, radius, margin=0.0)
    site.stand(greenery.broad_tree(int(site.rng.integers(0, 10)), is_tall=True), spot, 0.0, 0.0)
    for share, count in ((0.35, 5), (0.62, 9)):
        for index in range(count):
            c, s = CIRCLE[(index * len(CIRCLE)) // count]
            bush = greenery.bush(int(site.rng.integers(0, 10)))
            site.stand(bush, spot, share * radius * c, share * radius * s, site.turn())
