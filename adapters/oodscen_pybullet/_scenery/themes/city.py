"""A city: blocks wall to wall, towers behind them, and the furniture of streets."""

import numpy as np

from oodscen_pybullet._land.ways import Way
from oodscen_pybullet._scenery import furniture
from oodscen_pybullet._scenery.buildings import BLOCK_DEPTH_M, STYLES, city_block, tower
from oodscen_pybullet._scenery.placing import RoadsidePlace, Site
from oodscen_pybullet._scenery.themes.streets import SIDES, add_lamps, add_speed_signs, streets_of
from oodscen_pybullet._scenery.themes.trees import add_horizon, add_tree

_BUS_STOPS = ((-1, 7.0, 19.0), (1, 9.0, 21.0), (-1, 150.0, 230.0), (1, 150.0, 230.0))
"""Side and range of distances ahead of the ego's start, m, of bus stops: clear of where scenes place people."""
_BAY_M = 6
"""Step of the widths of blocks, m; a block has at least two."""


def furnish_city(site: Site, is_night: bool) -> None:
    """Add blocks and towers, a bus stop, lamps, and things on the pavements."""
    streets = streets_of(site)
    for way in streets:
        for side in SIDES:
            _add_blocks(site, way, side, is_night)
    _add_bus_stop(site, streets[0], is_night)
    for way in streets:
        add_lamps(site, way, 28.0, -1.9, height=7.5, is_night=is_night)
        add_speed_signs(site, way, -2.2, 60.0)
        for side in SIDES:
            _furnish_pavement(site, way, side)
    for way in streets:
        for side in SIDES:
            _add_towers(site, way, side, is_night)
    if any(way.corridor.structures for way in streets):
        add_horizon(site, 60.0)


def _add_bus_stop(site: Site, way: Way, is_night: bool) -> None:
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


def _add_blocks(site: Site, way: Way, side: int, is_night: bool) -> None:
    """Line one side of a street with buildings, wall to wall except for a few gaps."""
    rng, line = site.rng, way.course
    s, end = float(line.s[0]), float(line.s[-1]) - (90.0 if way.is_ego else 0.0)
    while s < end:
        width = _BAY_M * int(rng.integers(2, 5))
        floors, style = int(rng.integers(3, 7)), int(rng.integers(0, STYLES))
        look, has_shop = int(rng.integers(0, 12)), bool(rng.uniform() < 0.6)
        gap = 6.5 if rng.uniform() < 0.12 else 0.06
        is_placed = False
        while width >= 2 * _BAY_M and not is_placed:
            spot = site.spot(way, s + width / 2, side)
            out = 1.0 + BLOCK_DEPTH_M / 2
            x, y = spot.beside(0.0, out)
            is_placed = not site.is_spanned(spot, width / 2 + 8.0) and site.claim(
                x, y, spot.heading, width / 2 - 0.05, BLOCK_DEPTH_M / 2, margin=2.3
            )
            if is_placed:
                mesh = city_block(width, floors, style, look, has_shop=has_shop, is_night=is_night)
                site.stand(mesh, spot, 0.0, out)
            else:
                width -= _BAY_M
        s += width + gap if is_placed else 3.0


def _furnish_pavement(site: Site, way: Way, side: int) -> None:
    """Add things along a pavement, but none at corners, on bridges and in tunnels."""
    for spot in site.spots(way, side, 17.0, jitter=1.5):
        x, y = spot.beside(0.0, -1.0)
        if not (site.terrain.is_corner(x, y, 16.0) or site.is_spanned(spot)):
            _add_street_furniture(site, spot)


def _add_street_furniture(site: Site, spot: RoadsidePlace) -> None:
    """Add a tree at the kerb, a bench and a bin, a hydrant, bollards, or nothing."""
    choice = float(site.rng.uniform())
    pavement = site.ground.near(np.array([spot.x]), np.array([spot.y])).asphalt[0]
    kerb = 0.75 - float(pavement)
    if choice < 0.6:
        add_tree(site, spot, 0.0, kerb + 0.2, 0.6, "street")
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


def _add_towers(site: Site, way: Way, side: int, is_night: bool) -> None:
    """Add the skyline behind one side of a street."""
    for spot in site.spots(way, side, 34.0, jitter=8.0):
        out = 34.0 + 40.0 * float(site.rng.uniform())
        style, look = int(site.rng.integers(0, STYLES)), int(site.rng.integers(0, 9))
        x, y = spot.beside(0.0, out)
        if site.is_spanned(spot):
            continue
        if site.claim(x, y, spot.heading, 13.0, 13.0, margin=6.0):
            site.stand(tower(style, look, is_night=is_night), spot, 0.0, out)
