"""The roadside objects of a suburb, a city, a highway and the country."""

import numpy as np

from oodscen_pybullet._land.ribbons import Ribbons, strip_edges
from oodscen_pybullet._land.theme import Theme
from oodscen_pybullet._land.ways import Way
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.shapes import CIRCLE, ORIGIN
from oodscen_pybullet._meshes.tags import Tag, tagged
from oodscen_pybullet._scenery import furniture, greenery
from oodscen_pybullet._scenery.buildings import (
    BLOCK_DEPTH,
    HOUSE,
    STYLES,
    barn,
    city_block,
    house,
    tower,
)
from oodscen_pybullet._scenery.placing import RoadsidePlace, Site
from oodscen_pybullet._scenery.signals import displaced, limit_sign
from oodscen_pybullet._types import Array, Point

_BUS_STOPS = ((-1, 7.0, 19.0), (1, 9.0, 21.0), (-1, 150.0, 230.0), (1, 150.0, 230.0))
"""Side and range of distances ahead of the ego's start, m, of bus stops: clear of where scenes place people."""
_SIDES = (1, -1)
_PAINTS = ("red", "blue", "silver", "white", "dark_grey", "green", "burgundy")
_FRONTS = ("hedge_front", "picket_front", "wall_front")


def furnish(site: Site, theme: Theme, *, is_night: bool) -> None:
    """Add everything beside the roads.

    Args:
        site: Receives the objects.
        theme: The kind of land.
        is_night: Whether windows and lamps are lit.
    """
    for x, y, radius in site.terrain.islands.middles:
        _plant_island(site, x, y, radius)
    match theme:
        case "residential":
            _residential(site, is_night)
        case "urban":
            _urban(site, is_night)
        case "highway":
            _highway(site)
        case "rural":
            _rural(site, is_night)


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


def _streets(site: Site) -> list[Way]:
    """Return the roads with roadside objects, the ego's first."""
    return [way for way in site.ground.ways if not (way.is_connecting or way.is_track)]


def _lamps(
    site: Site, way: Way, spacing: float, out: float, *, height: float, is_night: bool
) -> None:
    """Add street lamps along a road, on alternating sides."""
    reach = 1.6
    lit, dark = (furniture.street_lamp(reach, height, is_night=on) for on in (is_night, False))
    for side in _SIDES:
        for index, spot in enumerate(site.spots(way, side, spacing)):
            if index % 2 == (side > 0) or site.is_spanned(spot, 0.0):
                continue
            x, y = spot.beside(0.0, out)
            if not site.is_free(x, y, 0.25):
                continue
            ahead = site.ground.along(x, y)[0] - site.ground.corridor.start
            is_dark = site.state is not None and site.state.is_dark(ahead)
            _, _, z = site.stand(dark if is_dark else lit, spot, 0.0, out)
            if not is_dark:
                site.lamps.append((*spot.beside(0.0, out - reach), z + height))


def _speed_signs(site: Site, way: Way, out: float, first: float) -> None:
    """Add signs with the road's own limit, if signs with that number exist."""
    limit = round(way.corridor.speed_limit * 3.6)
    fault = site.state.signs if site.state else None
    if limit not in furniture.LIMITS or fault == "missing":
        return
    mesh = limit_sign(limit)
    for spot in site.spots(way, -1, 210.0, first=first):
        x, y = spot.beside(0.0, out)
        if site.is_free(x, y, 0.4) and not site.is_spanned(spot):
            shown, heading = displaced(mesh, (-spot.heading[0], -spot.heading[1]), fault)
            site.stand(shown, spot, 0.0, out, heading)


def _tree(
    site: Site, spot: RoadsidePlace, along: float, out: float, margin: float, kind: str = ""
) -> None:
    """Add a tree if there is room for it."""
    key = int(site.rng.integers(0, 10))
    is_far = out > 14.0 or site.is_far(spot)
    if is_far and kind == "bush":
        return
    match kind:
        case "conifer":
            mesh = greenery.conifer(key)
        case "bush":
            mesh = greenery.bush(key)
        case "thicket":
            mesh = greenery.thicket(key)
        case _:
            is_tall, is_pruned = kind == "tall", kind == "street"
            mesh = greenery.broad_tree(key, is_tall=is_tall, is_far=is_far, is_pruned=is_pruned)
    radius = {"bush": 0.5, "thicket": 7.0}.get(kind, 0.9)
    site.try_to_stand(mesh, spot, along, out, margin=margin, radius=radius)


# ------------------------------------------------------------------ suburb


def _residential(site: Site, is_night: bool) -> None:
    streets = _streets(site)
    for way in streets:
        for side in _SIDES:
            for spot in site.spots(way, side, 15.5, jitter=0.8, first=4.0):
                _home(site, spot, is_night)
    for way in streets:
        _lamps(site, way, 26.0, -0.5, height=5.6, is_night=is_night)
        _speed_signs(site, way, -0.4, 70.0)
        for side in _SIDES:
            for spot in site.spots(way, side, 21.0, jitter=5.0):
                mesh = _any_house(site, is_night)
                x, y = spot.beside(0.0, 36.0)
                if site.claim(x, y, spot.heading, HOUSE[0] / 2, HOUSE[1] / 2, margin=8.0):
                    turned = (-spot.heading[0], -spot.heading[1])
                    site.stand(mesh, spot, 0.0, 36.0, turned)
                _tree(site, spot, 9.0, 24.0 + 6.0 * float(site.rng.uniform()), 6.0)
    _horizon(site, 62.0)


def _any_house(site: Site, is_night: bool) -> Mesh:
    rng = site.rng
    kind, roof, look = (int(rng.integers(0, n)) for n in (3, 3, 12))
    return house(kind, roof, look, is_night=is_night)


def _home(site: Site, spot: RoadsidePlace, is_night: bool) -> None:
    """Add a house with its garden."""
    rng = site.rng
    setback = 5.0 + float(rng.uniform(0, 1.6)) + HOUSE[1] / 2
    mesh = _any_house(site, is_night)
    style, has_car, paint = int(rng.integers(0, 4)), rng.uniform() < 0.4, int(rng.integers(0, 7))
    x, y = spot.beside(0.0, setback)
    if site.is_spanned(spot):
        return
    if not site.claim(x, y, spot.heading, HOUSE[0] / 2 + 0.3, HOUSE[1] / 2 + 0.3, margin=6.0):
        return
    site.stand(mesh, spot, 0.0, setback)
    if site.is_far(spot):
        _tree(site, spot, -4.5, 2.6, 3.5)
        return
    x, y = spot.beside(-1.8, 0.35)
    if style < 3 and site.claim(x, y, spot.heading, 5.0, 0.3, margin=2.2):
        site.stand(furniture.piece(_FRONTS[style]), spot, -1.8, 0.35)
    x, y = spot.beside(6.3, 4.6)
    if site.claim(x, y, spot.heading, 1.0, 4.2, margin=2.0):
        site.stand(furniture.piece("drive"), spot, 6.3, 0.0)
        if has_car:
            heading = (-spot.heading[1], spot.heading[0])
            if rng.uniform() < 0.5:
                heading = (-heading[0], -heading[1])
            site.stand(furniture.piece("parked_car", paint=_PAINTS[paint]), spot, 6.3, 4.4, heading)
        site.try_to_stand(furniture.piece("mailbox"), spot, 4.6, 0.3, margin=1.8, radius=0.2)
    if rng.uniform() < 0.75:
        _tree(site, spot, -4.5 + 2.0 * float(rng.uniform()), 2.6, 3.5)
    for _ in range(2):
        _tree(site, spot, float(rng.uniform(-4.0, 3.5)), setback - 4.8, 3.5, "bush")
    if rng.uniform() < 0.5:
        _tree(site, spot, 3.0, setback + 8.5, 6.0, "tall" if rng.uniform() < 0.4 else "")
    if rng.uniform() < 0.3:
        x, y = spot.beside(-7.6, 6.0)
        if site.claim(x, y, spot.heading, 0.3, 4.0, margin=3.5):
            site.stand(furniture.piece("side_hedge"), spot, -7.6, 1.5)


# ------------------------------------------------------------------ city


def _urban(site: Site, is_night: bool) -> None:
    streets = _streets(site)
    for way in streets:
        for side in _SIDES:
            _frontage(site, way, side, is_night)
    _bus_stop(site, streets[0], is_night)
    for way in streets:
        _lamps(site, way, 28.0, -1.9, height=7.5, is_night=is_night)
        _speed_signs(site, way, -2.2, 60.0)
        for side in _SIDES:
            for spot in site.spots(way, side, 17.0, jitter=1.5):
                x, y = spot.beside(0.0, -1.0)
                if site.terrain.is_corner(x, y, 16.0) or site.is_spanned(spot):
                    continue
                _street_thing(site, spot)
    for way in streets:
        for side in _SIDES:
            for spot in site.spots(way, side, 34.0, jitter=8.0):
                out = 34.0 + 40.0 * float(site.rng.uniform())
                style, look = int(site.rng.integers(0, STYLES)), int(site.rng.integers(0, 9))
                x, y = spot.beside(0.0, out)
                is_spanned = site.is_spanned(spot)
                if not is_spanned and site.claim(x, y, spot.heading, 13.0, 13.0, margin=6.0):
                    site.stand(tower(style, look, is_night=is_night), spot, 0.0, out)
    if any(way.corridor.structures for way in streets):
        _horizon(site, 60.0)


def _bus_stop(site: Site, way: Way, is_night: bool) -> None:
    """Add a bus stop at one of the places where there is room; the map's seed decides which."""
    for index in site.rng.permutation(len(_BUS_STOPS)).tolist():
        side, near, far = _BUS_STOPS[index]
        ahead = near + (far - near) * float(site.rng.uniform())
        stop = site.spot(way, site.ground.corridor.start + ahead, side)
        x, y = stop.beside(0.0, -0.95)
        is_free = site.is_free(x, y, 0.9) and not site.is_spanned(stop)
        is_free = is_free and not site.terrain.is_corner(x, y, 14.0)
        if is_free and site.claim(x, y, stop.heading, 3.0, 0.9, margin=0.0):
            site.stand(furniture.piece("bus_stop", is_night=is_night), stop, 0.0, -0.95)
            return


def _frontage(site: Site, way: Way, side: int, is_night: bool) -> None:
    """Line one side of a street with buildings, wall to wall except for a few gaps."""
    rng, line = site.rng, way.course
    s, end = float(line.s[0]), float(line.s[-1]) - (90.0 if way.is_ego else 0.0)
    while s < end:
        width = 6 * int(rng.integers(2, 5))
        floors, style = int(rng.integers(3, 7)), int(rng.integers(0, STYLES))
        look, has_shop = int(rng.integers(0, 12)), bool(rng.uniform() < 0.6)
        gap = 6.5 if rng.uniform() < 0.12 else 0.06
        is_placed = False
        while width >= 12 and not is_placed:
            spot = site.spot(way, s + width / 2, side)
            out = 1.0 + BLOCK_DEPTH / 2
            x, y = spot.beside(0.0, out)
            is_placed = not site.is_spanned(spot, width / 2 + 8.0) and site.claim(
                x, y, spot.heading, width / 2 - 0.05, BLOCK_DEPTH / 2, margin=2.3
            )
            if is_placed:
                mesh = city_block(width, floors, style, look, has_shop=has_shop, is_night=is_night)
                site.stand(mesh, spot, 0.0, out)
            else:
                width -= 6
        s += width + gap if is_placed else 3.0


def _street_thing(site: Site, spot: RoadsidePlace) -> None:
    """Add a tree at the kerb, or a bench, a bin or a hydrant."""
    choice = float(site.rng.uniform())
    wide = site.ground.near(np.array([spot.x]), np.array([spot.y])).asphalt[0]
    kerb = 0.75 - float(wide)
    if choice < 0.6:
        _tree(site, spot, 0.0, kerb + 0.2, 0.6, "street")
    elif choice < 0.72:
        site.try_to_stand(furniture.piece("bench"), spot, 0.0, -0.35, margin=1.2, radius=0.5)
        site.try_to_stand(furniture.piece("litter_bin"), spot, 1.5, -0.35, margin=1.2, radius=0.2)
    elif choice < 0.8:
        site.try_to_stand(furniture.piece("hydrant"), spot, 2.0, kerb - 0.1, margin=0.4, radius=0.2)
    elif choice < 0.9:
        for step in range(3):
            site.try_to_stand(
                furniture.piece("bollard"), spot, 1.8 * step, kerb - 0.3, margin=0.3, radius=0.15
            )


# ------------------------------------------------------------------ highway


def _highway(site: Site) -> None:
    post = furniture.piece("delineator")
    for way in _streets(site):
        for strip in way.corridor.strips:
            if strip.kind == "median" and strip.direction >= 0:
                _, left = strip_edges(way.corridor, way.course, strip)
                _rails(site, way, left - 0.16, left + 0.16)
                break
        right, left = way.asphalt
        _rails(site, way, left + 1.0, right - 1.0)
        for side in _SIDES:
            for spot in site.spots(way, side, 50.0):
                site.try_to_stand(post, spot, 0.0, 2.0, margin=1.5, radius=0.1)
        if way.is_ego:
            _gantries(site, way)
        _woods(site, way, (7.0, 46.0))
    _horizon(site, 95.0)


def _gantries(site: Site, way: Way) -> None:
    """Add sign gantries where the road is as wide as at its beginning."""
    first = float(way.asphalt[0][0])
    mesh = furniture.gantry(abs(first) + 0.6)
    for spot in site.spots(way, -1, 420.0, first=20.0):
        x, y = spot.beside(0.0, 0.9)
        edge = float(np.interp(spot.s, way.course.s, way.asphalt[0]))
        fits = abs(edge - first) < 0.1 and site.is_free(x, y, 0.3)
        if fits and not site.is_spanned(spot, 20.0):
            site.stand(mesh, spot, 0.0, 0.9)


def _rails(site: Site, way: Way, left: Array, right: Array) -> None:
    """Add two rails: the left one faces right, the right one left."""
    _rail(site, way, left, 1)
    _rail(site, way, right, -1)


def _rail(site: Site, way: Way, t: Array, side: int) -> None:
    """Add a steel rail whose face looks towards the road: to the right for `side` +1.

    It is interrupted where another road joins or leaves.
    """
    ribbons, line = Ribbons(way.course), way.course
    is_free = site.ground.asphalt(line.x - t * line.sin, line.y + t * line.cos) > 0.4
    is_median = bool((t > way.asphalt[0]).all() and (t < way.asphalt[1]).all())
    stands = is_free | is_median
    where = stands[1:] & stands[:-1]
    for low, high, colour in ((0.44, 0.56, "rail"), (0.56, 0.60, "post"), (0.60, 0.74, "rail")):
        if side > 0:
            ribbons.band(t, t + 1e-4, colour, heights=(low, high), where=where)
        else:
            ribbons.band(t - 1e-4, t, colour, heights=(high, low), where=where)
    ribbons.band(t - 0.05, t + 0.05, "rail", heights=(0.74, 0.74), where=where)
    site.add(tagged(ribbons.mesh(), Tag.GUARD_RAIL), ORIGIN, (1.0, 0.0))
    for row in np.flatnonzero(stands[:-1]).tolist():
        c, s = float(line.cos[row]), float(line.sin[row])
        x, y = float(line.x[row] - t[row] * s), float(line.y[row] + t[row] * c)
        heading = (c, s) if side > 0 else (-c, -s)
        if not any(o.start < line.s[row] < o.end for o in way.corridor.structures):
            site.add(furniture.piece("rail_post"), (x, y, float(line.z[row])), heading)


# ------------------------------------------------------------------ country


def _woods(site: Site, way: Way, reach: tuple[float, float]) -> None:
    """Add scattered trees and bushes on both sides."""
    near, far = reach
    for side in _SIDES:
        for spot in site.spots(way, side, 15.0, jitter=6.0):
            share = float(site.rng.uniform())
            out = near + (far - near) * share * share
            key = int(site.rng.integers(0, 6))
            kind = "conifer" if key >= 4 else "tall" if key == 3 else ""
            if site.is_spanned(spot, 2.0):
                continue
            _tree(site, spot, 0.0, out, near - 0.5, kind)
            if site.rng.uniform() < 0.4:
                _tree(site, spot, 3.0, max(near, out - 3.0), near - 0.5, "bush")


def _horizon(site: Site, out: float) -> None:
    """Add the edges of distant woods along the ego's road."""
    way = site.ground.ego
    has_bridge = any(one.kind == "bridge" for one in way.corridor.structures)
    for side in _SIDES:
        for spot in site.spots(way, side, 24.0, jitter=5.0):
            far = out + 55.0 * float(site.rng.uniform())
            if not (has_bridge and site.is_spanned(spot, 8.0)):
                _tree(site, spot, 0.0, far, 24.0, "thicket")


def _rural(site: Site, is_night: bool) -> None:
    post, fence = furniture.piece("delineator"), furniture.piece("field_fence")
    bale = furniture.piece("hay_bale")
    for way in _streets(site):
        for side in _SIDES:
            for spot in site.spots(way, side, 25.0):
                if not site.is_spanned(spot, 0.0):
                    site.try_to_stand(post, spot, 0.0, 0.7, margin=0.5, radius=0.1)
        for spot in site.spots(way, 1, 4.0):
            if not site.is_spanned(spot):
                site.try_to_stand(fence, spot, 0.0, 10.0, margin=6.0, radius=0.3)
        _power_line(site, way)
        _speed_signs(site, way, 1.6, 90.0)
        for spot in site.spots(way, 1, 330.0, first=40.0):
            _farm(site, spot, is_night)
        for spot in site.spots(way, -1, 90.0, jitter=30.0):
            for along in (0.0, 7.0, 15.0):
                site.try_to_stand(bale, spot, along, 26.0 + along / 3, margin=8.0, radius=0.8)
        _woods(site, way, (7.5, 40.0))
    _horizon(site, 70.0)


def _power_line(site: Site, way: Way) -> None:
    """Add poles along the right side, connected by wires."""
    last: tuple[Point, Point] | None = None
    wires = MeshBuilder()
    for spot in site.spots(way, -1, 40.0):
        x, y = spot.beside(0.0, 13.0)
        if not site.is_free(x, y, 6.0) or site.is_spanned(spot, 24.0):
            last = None
            continue
        site.claim(x, y, spot.heading, 0.3, 0.3, margin=0.0)
        _, _, z = site.stand(furniture.piece("power_pole"), spot, 0.0, 13.0)
        (ax, ay), (bx, by) = spot.beside(0.0, 12.1), spot.beside(0.0, 13.9)
        ends: tuple[Point, Point] = ((ax, ay, z + 8.15), (bx, by, z + 8.15))
        if last is not None:
            for start, end in zip(last, ends, strict=True):
                middle = [0.5 * (p + q) for p, q in zip(start, end, strict=True)]
                low = (middle[0], middle[1], middle[2] - 0.5)
                wires.beam(start, low, 0.03, "dark_grey").beam(low, end, 0.03, "dark_grey")
        last = ends
    if last is not None:
        site.add(tagged(wires.build(), Tag.POLES), ORIGIN, (1.0, 0.0))


def _farm(site: Site, spot: RoadsidePlace, is_night: bool) -> None:
    """Add a farmhouse and its barn."""
    x, y = spot.beside(0.0, 24.0)
    if site.is_spanned(spot, 30.0):
        return
    if site.claim(x, y, spot.heading, HOUSE[0] / 2 + 1, HOUSE[1] / 2 + 1, margin=8.0):
        site.stand(_any_house(site, is_night), spot, 0.0, 24.0)
    x, y = spot.beside(19.0, 29.0)
    if site.claim(x, y, spot.heading, 9.5, 5.5, margin=8.0):
        site.stand(barn("burgundy"), spot, 19.0, 29.0)
