"""The surface of the roads: asphalt, medians and rails, with the paint and wear on it."""

import numpy as np

from oodscen.driving._roads.corridor import DRIVABLE, LaneStrip
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.kerbs import Band, kerb_medians, raise_pavement, raise_tunnel_walk
from oodscen_pybullet._land.land import KERB_FOOT_M
from oodscen_pybullet._land.marks import mark_lanes, paint_crossings
from oodscen_pybullet._land.polygons import convex_hull
from oodscen_pybullet._land.relief import KERB_HEIGHT_M
from oodscen_pybullet._land.repairs import add_repairs_and_manholes
from oodscen_pybullet._land.ribbons import (
    LAYER_M,
    PAINT_M,
    Ribbons,
    add_slab,
    spanned_pieces,
    whole_pieces,
)
from oodscen_pybullet._land.theme import Theme
from oodscen_pybullet._land.ways import Way, strip_edges
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._types import Array

_LAYERS = 5
"""Layers below the ego's road over which other roads are spread, so that their asphalt does not flicker."""
_FLOOR_M = 0.05
"""Depth of the asphalt below junctions, m: lower than all layers."""
_STRIP_M = 0.02
"""Width above which a strip is there, m."""
_SEAM_M = 0.01
"""Distance from the road's edge within which a strip's edge counts as it, m."""
_INNER_M = 0.1
"""Distance by which a median may exceed the asphalt's edges, m."""
_WIDER_M, _WIDER_WITH_KERB_M = 0.03, 0.25
"""Distance by which asphalt extends beyond the road's edge, m; with a kerb it lies below that."""
_WORN_SHARE = 0.14
"""Share of the pieces of asphalt that are worn."""
_CHANGE_M = 0.05
"""Change of the road's width from which there is asphalt below its kerbs, m."""
_BELOW_M = 2.6
"""Width of that asphalt, m."""
_GAUGE_M, _SLEEPERS_M = 1.5, 0.65
"""Distance between the middles of two rails, and between two sleepers, m."""
_RAIL_M = 0.05
"""Half the width of a rail, m."""
_SLEEPER_M = (0.13, 1.25)
"""Half the extent of a sleeper along and across the track, m."""


def lay_roads(ground: Ground, theme: Theme, rng: np.random.Generator) -> Mesh:
    """Return the surface of all roads.

    Args:
        ground: The roads.
        theme: Determines the material of shoulders and medians.
        rng: Draws where asphalt is worn, and where repairs and manholes are.
    """
    surfaces = []
    for index, way in enumerate(ground.ways):
        layer = 0.0 if way.is_ego else -LAYER_M * (1 + index % _LAYERS)
        ribbons = _Roadbed(way, theme, layer).lay(rng)
        if way.is_track:
            _lay_track(way, ribbons)
        elif theme == "highway" or not way.is_connecting:
            mark_lanes(way, ribbons, layer, ground.corridor.crosswalks, theme)
        if way.is_ego:
            add_repairs_and_manholes(way, ribbons, rng)
        surfaces.append(ribbons)
    crossings = Ribbons(ground.ego.course)
    _lay_floors(ground, crossings)
    paint_crossings(ground, crossings)
    return Mesh.joined([ribbons.mesh() for ribbons in (*surfaces, crossings)])


class _Roadbed:
    """Lays the strips of one road."""

    def __init__(self, way: Way, theme: Theme, layer: float) -> None:
        self._way = way
        self._theme = theme
        self._ribbons = Ribbons(way.course)
        self._heights = (layer, layer)
        self._dark = spanned_pieces(way, "tunnel")
        self._spanned = spanned_pieces(way, "tunnel", "bridge")

    def lay(self, rng: np.random.Generator) -> Ribbons:
        """Lay all strips, and return them; the generator draws where asphalt is worn."""
        way, ribbons = self._way, self._ribbons
        medians: list[list[Band]] = [[]]
        if way.has_kerb:
            self._lay_below_kerbs()
        for strip in way.corridor.strips:
            right, left = strip_edges(way.corridor, way.course, strip)
            band = Band(right, left, whole_pieces((left - right) > _STRIP_M))
            if strip.kind in DRIVABLE or strip.kind in ("rail", "sidewalk"):
                medians.append([])
            if strip.kind in DRIVABLE:
                self._lay_drivable(strip, band, rng)
            elif strip.kind == "rail":
                ribbons.tiled_band(right, left, "gravel", heights=self._heights, where=band.where)
            elif strip.kind == "sidewalk":
                raise_tunnel_walk(ribbons, band._replace(where=band.where & self._dark))
                on_bridge = band.where & self._spanned & ~self._dark
                raise_pavement(ribbons, band._replace(where=on_bridge))
            else:
                medians[-1] += self._lay_verge(band)
        for neighbours in medians:
            kerb_medians(ribbons, neighbours)
        return ribbons

    def _lay_drivable(self, strip: LaneStrip, band: Band, rng: np.random.Generator) -> None:
        """Lay asphalt or gravel, some of it worn."""
        way, ribbons, heights = self._way, self._ribbons, self._heights
        right_most, left_most = way.carriageway
        wider = _WIDER_WITH_KERB_M if way.has_kerb else _WIDER_M
        right = np.where(band.right <= right_most + _SEAM_M, band.right - wider, band.right)
        left = np.where(band.left >= left_most - _SEAM_M, band.left + wider, band.left)
        in_tunnel, in_open = band.where & self._dark, band.where & ~self._dark
        ribbons.band(right, left, "asphalt_tunnel", heights=heights, where=in_tunnel)
        if strip.kind == "parking":
            ribbons.band(right, left, "asphalt_light", heights=heights, where=in_open)
            return
        surface = "gravel" if strip.kind == "shoulder" and self._theme == "rural" else "asphalt"
        if surface == "asphalt" and not way.is_connecting:
            worn = in_open & (rng.uniform(size=len(in_open)) < _WORN_SHARE)
            ribbons.tiled_band(right, left, "asphalt_worn", heights=heights, where=worn)
            in_open = in_open & ~worn
        ribbons.tiled_band(right, left, surface, heights=heights, where=in_open)

    def _lay_verge(self, band: Band) -> list[Band]:
        """Lay a median, or what lies beside the road on a bridge; return the median if it is raised."""
        right_most, left_most = self._way.carriageway
        right, left, is_there = band
        dark, heights = self._dark, self._heights
        is_inner = whole_pieces((right > right_most - _INNER_M) & (left < left_most + _INNER_M))
        is_raised = self._theme in ("residential", "urban")
        median = band._replace(where=is_there & is_inner & ~dark)
        surface = "gravel" if self._theme == "highway" else "grass"
        top = (KERB_HEIGHT_M, KERB_HEIGHT_M) if is_raised else heights
        self._ribbons.band(right, left, surface, heights=top, where=median.where)
        outer = is_there & self._spanned & ~is_inner & ~dark
        self._ribbons.band(right, left, "concrete_dark", heights=heights, where=outer)
        self._ribbons.band(right, left, "tunnel_light", heights=heights, where=is_there & dark)
        return [median] if is_raised else []

    def _lay_below_kerbs(self) -> None:
        """Add asphalt below kerbs where the width changes or the road ends, to close gaps."""
        right, left = self._way.carriageway
        changes = (np.abs(np.diff(right)) > _CHANGE_M) | (np.abs(np.diff(left)) > _CHANGE_M)
        changes[:1] = changes[-1:] = True
        changes |= np.roll(changes, 1) | np.roll(changes, -1)
        if self._way.is_connecting:
            changes[:] = True
        height = self._heights[0] + KERB_FOOT_M
        self._ribbons.band(
            right - _BELOW_M, left + _BELOW_M, "asphalt", heights=(height, height), where=changes
        )


def _lay_track(way: Way, ribbons: Ribbons) -> None:
    """Add the sleepers and the two rails of a track along its reference line."""
    course = way.course
    along, across = _SLEEPER_M
    for s in np.arange(float(course.s[0]), float(course.s[-1]), _SLEEPERS_M).tolist():
        box = (s - along, s + along, -across, across)
        add_slab(way.corridor, ribbons, box, -0.5 * LAYER_M, "wood")
    for t in (-0.5 * _GAUGE_M, 0.5 * _GAUGE_M):
        ribbons.band(t - _RAIL_M, t + _RAIL_M, "rail", heights=(2.0 * PAINT_M, 2.0 * PAINT_M))


def _lay_floors(ground: Ground, ribbons: Ribbons) -> None:
    """Lay asphalt below every junction so that no ground shows between its roads."""
    edges: dict[str, list[Array]] = {}
    for way, other in zip(ground.ways[1:], ground.corridor.others, strict=True):
        if way.is_connecting:
            points = [way.course.points(edge) for edge in way.carriageway]
            edges.setdefault(other.junction, []).extend(points)
    for junction_edges in edges.values():
        corners = np.concatenate(junction_edges)
        corners[:, 2] -= _FLOOR_M
        hull = convex_hull(corners)
        if len(hull) > 2:
            ribbons.patch(hull, "asphalt")
