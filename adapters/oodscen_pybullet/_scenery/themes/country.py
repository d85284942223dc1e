"""The country: fields, farms, woods and power lines."""

from oodscen_pybullet._land.ways import Way
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.shapes import ORIGIN
from oodscen_pybullet._meshes.tags import Tag, tagged
from oodscen_pybullet._scenery import furniture
from oodscen_pybullet._scenery.buildings import HOUSE_M, any_house, barn
from oodscen_pybullet._scenery.placing import RoadsidePlace, Site
from oodscen_pybullet._scenery.themes.streets import SIDES, add_speed_signs, streets_of
from oodscen_pybullet._scenery.themes.trees import add_horizon, add_woods
from oodscen_pybullet._types import Point


def furnish_country(site: Site, is_night: bool) -> None:
    """Add delineators, fences, farms, a power line, hay bales and woods."""
    post, fence = furniture.piece("delineator"), furniture.piece("field_fence")
    bale = furniture.piece("hay_bale")
    for way in streets_of(site):
        for side in SIDES:
            for spot in site.spots(way, side, 25.0):
                if not site.is_spanned(spot, 0.0):
                    site.try_to_stand(post, spot, 0.0, 0.7, margin=0.5, radius=0.1)
        for spot in site.spots(way, 1, 4.0):
            if not site.is_spanned(spot):
                site.try_to_stand(fence, spot, 0.0, 10.0, margin=6.0, radius=0.3)
        _add_power_line(site, way)
        add_speed_signs(site, way, 1.6, 90.0)
        for spot in site.spots(way, 1, 330.0, first=40.0):
            _add_farm(site, spot, is_night)
        for spot in site.spots(way, -1, 90.0, jitter=30.0):
            for along in (0.0, 7.0, 15.0):
                site.try_to_stand(bale, spot, along, 26.0 + along / 3, margin=8.0, radius=0.8)
        add_woods(site, way, (7.5, 40.0))
    add_horizon(site, 70.0)


def _add_power_line(site: Site, way: Way) -> None:
    """Add poles along the right side, connected by wires."""
    previous: tuple[Point, Point] | None = None
    wires = MeshBuilder()
    for spot in site.spots(way, -1, 40.0):
        x, y = spot.beside(0.0, 13.0)
        if not site.is_free(x, y, 6.0) or site.is_spanned(spot, 24.0):
            previous = None
            continue
        site.claim(x, y, spot.heading, 0.3, 0.3, margin=0.0)
        _, _, z = site.stand(furniture.piece("power_pole"), spot, 0.0, 13.0)
        (ax, ay), (bx, by) = spot.beside(0.0, 12.1), spot.beside(0.0, 13.9)
        ends: tuple[Point, Point] = ((ax, ay, z + 8.15), (bx, by, z + 8.15))
        if previous is not None:
            for start, end in zip(previous, ends, strict=True):
                x, y, z = (0.5 * (p + q) for p, q in zip(start, end, strict=True))
                low = (x, y, z - 0.5)
                wires.beam(start, low, 0.03, "dark_grey").beam(low, end, 0.03, "dark_grey")
        previous = ends
    site.add(tagged(wires.build(), Tag.POLES), ORIGIN, (1.0, 0.0))


def _add_farm(site: Site, spot: RoadsidePlace, is_night: bool) -> None:
    """Add a farmhouse and its barn."""
    x, y = spot.beside(0.0, 24.0)
    if site.is_spanned(spot, 30.0):
        return
    if site.claim(x, y, spot.heading, HOUSE_M[0] / 2 + 1, HOUSE_M[1] / 2 + 1, margin=8.0):
        site.stand(any_house(site.rng, is_night=is_night), spot, 0.0, 24.0)
    x, y = spot.beside(19.0, 29.0)
    if site.claim(x, y, spot.heading, 9.5, 5.5, margin=8.0):
        site.stand(barn("burgundy"), spot, 19.0, 29.0)
