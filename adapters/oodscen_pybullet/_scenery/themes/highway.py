"""A highway: guard rails, gantries and woods."""

import numpy as np

from oodscen_pybullet._land.ribbons import Ribbons
from oodscen_pybullet._land.ways import Way, strip_edges
from oodscen_pybullet._meshes.shapes import ORIGIN
from oodscen_pybullet._meshes.tags import Tag, tagged
from oodscen_pybullet._scenery import furniture
from oodscen_pybullet._scenery.placing import Site
from oodscen_pybullet._scenery.themes.streets import SIDES, streets_of
from oodscen_pybullet._scenery.themes.trees import add_horizon, add_woods
from oodscen_pybullet._types import Array


def furnish_highway(site: Site) -> None:
    """Add guard rails, delineators, gantries and woods."""
    post = furniture.piece("delineator")
    for way in streets_of(site):
        for strip in way.corridor.strips:
            if strip.kind == "median" and strip.direction >= 0:
                _, left = strip_edges(way.corridor, way.course, strip)
                _add_rails(site, way, left - 0.16, left + 0.16)
                break
        right, left = way.carriageway
        _add_rails(site, way, left + 1.0, right - 1.0)
        for side in SIDES:
            for spot in site.spots(way, side, 50.0):
                site.try_to_stand(post, spot, 0.0, 2.0, margin=1.5, radius=0.1)
        if way.is_ego:
            _add_gantries(site, way)
        add_woods(site, way, (7.0, 46.0))
    add_horizon(site, 95.0)


def _add_gantries(site: Site, way: Way) -> None:
    """Add sign gantries where the road is as wide as at its beginning."""
    first = float(way.carriageway.right[0])
    mesh = furniture.gantry(abs(first) + 0.6)
    for spot in site.spots(way, -1, 420.0, first=20.0):
        x, y = spot.beside(0.0, 0.9)
        edge = float(np.interp(spot.s, way.course.s, way.carriageway.right))
        fits = abs(edge - first) < 0.1 and site.is_free(x, y, 0.3)
        if fits and not site.is_spanned(spot, 20.0):
            site.stand(mesh, spot, 0.0, 0.9)


def _add_rails(site: Site, way: Way, left: Array, right: Array) -> None:
    """Add two rails: the left one faces right, the right one left."""
    _add_rail(site, way, left, 1)
    _add_rail(site, way, right, -1)


def _add_rail(site: Site, way: Way, t: Array, side: int) -> None:
    """Add a steel rail whose face looks towards the road: to the right for `side` +1.

    It is interrupted where another road joins or leaves.
    """
    ribbons, line = Ribbons(way.course), way.course
    is_free = site.ground.asphalt(line.x - t * line.sin, line.y + t * line.cos) > 0.4
    is_median = bool((t > way.carriageway.right).all() and (t < way.carriageway.left).all())
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
