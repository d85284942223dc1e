"""Trees along roads, woods and the horizon."""

from typing import Literal

from oodscen_pybullet._land.ways import Way
from oodscen_pybullet._scenery import greenery
from oodscen_pybullet._scenery.placing import RoadsidePlace, Site
from oodscen_pybullet._scenery.themes.streets import SIDES

Tree = Literal["broad", "tall", "street", "conifer", "bush", "thicket"]
"""Kinds of trees.

- `broad`: a broad-leaved tree
- `tall`: a taller one
- `street`: one pruned as in streets
- `conifer`: a fir
- `bush`: a bush
- `thicket`: the edge of a distant wood
"""
_RADII_M: dict[Tree, float] = {"bush": 0.5, "thicket": 7.0}
"""Radius that a kind needs, m; others need `_RADIUS_M`."""
_RADIUS_M = 0.9
_WOOD: tuple[Tree, ...] = ("broad", "broad", "broad", "tall", "conifer", "conifer")
"""The trees of a wood, all equally likely."""
_FAR_OUT_M = 14.0
"""Distance from the road above which broad-leaved trees have few triangles, and no bushes stand, m."""


def add_tree(
    site: Site, spot: RoadsidePlace, along: float, out: float, margin: float, kind: Tree = "broad"
) -> None:
    """Add a tree if there is room for it.

    Args:
        site: Receives the tree.
        spot: The reference place.
        along: Distance along the spot's heading, m.
        out: Distance away from the road, m.
        margin: Distance from asphalt, m.
        kind: The kind of tree.
    """
    key = int(site.rng.integers(0, 10))
    is_far = out > _FAR_OUT_M or site.is_far(spot)
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
    radius = _RADII_M.get(kind, _RADIUS_M)
    site.try_to_stand(mesh, spot, along, out, margin=margin, radius=radius)


def add_woods(site: Site, way: Way, reach: tuple[float, float]) -> None:
    """Add scattered trees and bushes on both sides.

    Args:
        site: Receives them.
        way: The road.
        reach: Least and greatest distance away from the road, m.
    """
    near, far = reach
    for side in SIDES:
        for spot in site.spots(way, side, 15.0, jitter=6.0):
            share = float(site.rng.uniform())
            out = near + (far - near) * share * share
            kind = _WOOD[int(site.rng.integers(0, len(_WOOD)))]
            if site.is_spanned(spot, 2.0):
                continue
            add_tree(site, spot, 0.0, out, near - 0.5, kind)
            if site.rng.uniform() < 0.4:
                add_tree(site, spot, 3.0, max(near, out - 3.0), near - 0.5, "bush")


def add_horizon(site: Site, out: float) -> None:
    """Add the edges of distant woods along the ego's road, but none beside bridges.

    Args:
        site: Receives them.
        out: Least distance away from the road, m.
    """
    for side in SIDES:
        for spot in site.spots(site.ground.ego, side, 24.0, jitter=5.0):
            far = out + 55.0 * float(site.rng.uniform())
            if not site.is_spanned(spot, 8.0, ("bridge",)):
                add_tree(site, spot, 0.0, far, 24.0, "thicket")
