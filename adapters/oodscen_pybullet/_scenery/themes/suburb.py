"""A suburb: houses with gardens."""

from oodscen_pybullet._scenery import furniture
from oodscen_pybullet._scenery.buildings import HOUSE_M, any_house
from oodscen_pybullet._scenery.placing import RoadsidePlace, Site
from oodscen_pybullet._scenery.themes.streets import SIDES, add_lamps, add_speed_signs, streets_of
from oodscen_pybullet._scenery.themes.trees import add_horizon, add_tree

_PAINTS = ("red", "blue", "silver", "white", "dark_grey", "green", "burgundy")
_FRONTS = ("hedge_front", "picket_front", "wall_front")


def furnish_suburb(site: Site, is_night: bool) -> None:
    """Add houses with gardens, a second row behind them, street lamps, speed signs and trees."""
    streets = streets_of(site)
    for way in streets:
        for side in SIDES:
            for spot in site.spots(way, side, 15.5, jitter=0.8, first=4.0):
                _add_home(site, spot, is_night)
    for way in streets:
        add_lamps(site, way, 26.0, -0.5, height=5.6, is_night=is_night)
        add_speed_signs(site, way, -0.4, 70.0)
        for side in SIDES:
            for spot in site.spots(way, side, 21.0, jitter=5.0):
                mesh = any_house(site.rng, is_night=is_night)
                x, y = spot.beside(0.0, 36.0)
                if site.claim(x, y, spot.heading, HOUSE_M[0] / 2, HOUSE_M[1] / 2, margin=8.0):
                    turned = (-spot.heading[0], -spot.heading[1])
                    site.stand(mesh, spot, 0.0, 36.0, turned)
                add_tree(site, spot, 9.0, 24.0 + 6.0 * float(site.rng.uniform()), 6.0)
    add_horizon(site, 62.0)


def _add_home(site: Site, spot: RoadsidePlace, is_night: bool) -> None:
    """Add a house with its garden."""
    rng = site.rng
    setback = 5.0 + float(rng.uniform(0, 1.6)) + HOUSE_M[1] / 2
    mesh = any_house(rng, is_night=is_night)
    front, has_car = int(rng.integers(0, len(_FRONTS) + 1)), rng.uniform() < 0.4
    paint = int(rng.integers(0, len(_PAINTS)))
    x, y = spot.beside(0.0, setback)
    if site.is_spanned(spot):
        return
    if not site.claim(x, y, spot.heading, HOUSE_M[0] / 2 + 0.3, HOUSE_M[1] / 2 + 0.3, margin=6.0):
        return
    site.stand(mesh, spot, 0.0, setback)
    if site.is_far(spot):
        add_tree(site, spot, -4.5, 2.6, 3.5)
        return
    x, y = spot.beside(-1.8, 0.35)
    if front < len(_FRONTS) and site.claim(x, y, spot.heading, 5.0, 0.3, margin=2.2):
        site.stand(furniture.piece(_FRONTS[front]), spot, -1.8, 0.35)
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
        add_tree(site, spot, -4.5 + 2.0 * float(rng.uniform()), 2.6, 3.5)
    for _ in range(2):
        add_tree(site, spot, float(rng.uniform(-4.0, 3.5)), setback - 4.8, 3.5, "bush")
    if rng.uniform() < 0.5:
        add_tree(site, spot, 3.0, setback + 8.5, 6.0, "tall" if rng.uniform() < 0.4 else "broad")
    if rng.uniform() < 0.3:
        x, y = spot.beside(-7.6, 6.0)
        if site.claim(x, y, spot.heading, 0.3, 4.0, margin=3.5):
            site.stand(furniture.piece("side_hedge"), spot, -7.6, 1.5)
