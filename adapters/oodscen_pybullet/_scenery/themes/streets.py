"""The streets with roadside objects, their lamps and their speed limits."""

from oodscen_pybullet._land.ways import Way
from oodscen_pybullet._scenery import furniture
from oodscen_pybullet._scenery.placing import Site
from oodscen_pybullet._scenery.signals import displace, limit_sign

SIDES = (1, -1)
"""Left and right."""
_ARM_M = 1.6
"""Length of the arm of a street lamp, m."""


def streets_of(site: Site) -> list[Way]:
    """Return the roads with roadside objects, the ego's first."""
    return [way for way in site.ground.ways if not (way.is_connecting or way.is_track)]


def add_lamps(
    site: Site, way: Way, spacing: float, out: float, *, height: float, is_night: bool
) -> None:
    """Add street lamps along a road, on alternating sides; they are lit at night unless their fault is to be dark."""
    for side in SIDES:
        for index, spot in enumerate(site.spots(way, side, spacing)):
            if index % 2 == (side > 0) or site.is_spanned(spot, 0.0):
                continue
            x, y = spot.beside(0.0, out)
            if not site.is_free(x, y, 0.25):
                continue
            ahead = site.ground.locate(x, y)[0] - site.ground.corridor.start
            is_lit = is_night and not (site.state and site.state.is_dark(ahead))
            lamp = furniture.street_lamp(_ARM_M, height, is_night=is_lit)
            _, _, z = site.stand(lamp, spot, 0.0, out)
            if is_lit:
                site.lamps.append((*spot.beside(0.0, out - _ARM_M), z + height))


def add_speed_signs(site: Site, way: Way, out: float, first: float) -> None:
    """Add signs with the road's own limit, if signs with that number exist."""
    limit = round(way.corridor.speed_limit * 3.6)
    fault = site.state.signs if site.state else None
    if limit not in furniture.LIMITS or fault == "missing":
        return
    mesh = limit_sign(limit)
    for spot in site.spots(way, -1, 210.0, first=first):
        x, y = spot.beside(0.0, out)
        if site.is_free(x, y, 0.4) and not site.is_spanned(spot):
            sign, heading = displace(mesh, (-spot.heading[0], -spot.heading[1]), fault)
            site.stand(sign, spot, 0.0, out, heading)
