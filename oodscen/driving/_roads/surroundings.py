"""The surroundings of a route: the roads near it, and their signals and painted areas in world coordinates."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from operator import attrgetter, itemgetter

import numpy as np
from numpy.typing import NDArray

from oodscen.driving._roads.corridor import Corridor, PaintedArea, RoadSignal, Structure
from oodscen.driving._roads.crosssection import freeze
from oodscen.driving._roads.geometry import piecewise
from oodscen.driving._roads.leg_tracks import LegTrack
from oodscen.driving._roads.network import Road, Signal
from oodscen.driving._roads.routes import road_point
from oodscen.numerics._exact import cos, sin

NEAR_M = 400.0
"""Maximum distance of other roads and signals from the ego's road, m."""

_APART_M = 20.0
"""Distance between the points of the ego's road from which others are measured, m."""
_BATCH = 1024
"""Points of a road that are measured at once."""
_SHORTEST_M = 0.1
"""Length up to which a tunnel or bridge, or the gap between two, is ignored, m."""
_LIGHTS = "1000"
"""First digits of the types of traffic lights in OpenDRIVE's own catalogue."""


def roads_by_distance(roads: Iterable[Road], corridor: Corridor) -> list[Road]:
    """Return the roads with a part near a corridor, those closest to the ego's start first."""
    every = max(1, round(_APART_M / corridor.step))
    line_x, line_y = corridor.x[::every], corridor.y[::every]
    start_x, start_y = corridor.point(corridor.start, 0.0)[:2]
    ranked: list[tuple[float, int, Road]] = []
    for road in roads:
        last = road_point(road, road.length)
        x = np.array([*(curve.x for curve in road.curves), last.x])
        y = np.array([*(curve.y for curve in road.curves), last.y])
        least = min(
            float(((line_x - px[:, None]) ** 2 + (line_y - py[:, None]) ** 2).min())
            for px, py in zip(_batches(x), _batches(y), strict=True)
        )
        if least <= NEAR_M * NEAR_M:
            away = float(((x - start_x) ** 2 + (y - start_y) ** 2).min())
            ranked.append((away, len(ranked), road))
    return [road for _, _, road in sorted(ranked, key=itemgetter(0, 1))]


def _batches(values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    return [values[first : first + _BATCH] for first in range(0, len(values), _BATCH)]


def structures_of(tracks: Sequence[LegTrack], begins: Sequence[float]) -> tuple[Structure, ...]:
    """Return the tunnels and bridges of a route; those of one kind that meet, as at a joint, are one.

    Args:
        tracks: The tracks of the route's legs.
        begins: s on the corridor where each track begins, m.
    """
    parts = []
    for track, begin in zip(tracks, begins, strict=True):
        for stretch in track.leg.road.stretches:
            start, end = sorted(
                begin + track.from_start(min(max(road_s, 0.0), track.span))
                for road_s in (stretch.start, stretch.end)
            )
            parts.append(Structure(stretch.kind, round(start, 6), round(end, 6)))
    structures: list[Structure] = []
    for part in sorted(parts, key=attrgetter("kind", "start")):
        last = structures[-1] if structures else None
        if last and last.kind == part.kind and part.start - last.end <= _SHORTEST_M:
            structures[-1] = replace(last, end=max(last.end, part.end))
        else:
            structures.append(part)
    long_enough = [one for one in structures if one.end - one.start > _SHORTEST_M]
    return tuple(sorted(long_enough, key=attrgetter("start")))


def signal_in_world(road: Road, signal: Signal, corridor: Corridor) -> RoadSignal:
    """Return a road's signal in world coordinates, and its place on the corridor."""
    place = road_point(road, signal.s)
    along, across = cos(place.heading), sin(place.heading)
    x = _rounded(place.x - signal.t * across)
    y = _rounded(place.y + signal.t * along)
    faces = place.heading + signal.turn + (0.0 if signal.orientation == "-" else math.pi)
    s, t = corridor.locate(x, y)
    is_light = signal.is_dynamic or signal.type.startswith(_LIGHTS)
    return RoadSignal(
        id=signal.id,
        kind="traffic_light" if is_light else "sign",
        type=signal.type,
        value=signal.value,
        x=x,
        y=y,
        z=_rounded(piecewise(road.elevation, signal.s)),
        yaw=_rounded(math.remainder(faces, math.tau)),
        s=_rounded(s),
        t=_rounded(t),
        height=signal.height,
        country=signal.country,
        name=signal.name,
    )


def painted_areas(road: Road) -> list[PaintedArea]:
    """Return a road's crosswalks and stop lines in world coordinates."""
    areas = []
    for patch in road.patches:
        points = []
        for s, t in patch.corners:
            place = road_point(road, s)
            along, across = cos(place.heading), sin(place.heading)
            beyond = s - min(max(s, 0.0), road.length)
            x, y = place.x + beyond * along, place.y + beyond * across
            points.append((_rounded(x - t * across), _rounded(y + t * along)))
        if points[0] != points[-1]:
            points.append(points[0])
        twice_area = sum(
            ax * by - bx * ay
            for (ax, ay), (bx, by) in zip(points, points[1:] + points[:1], strict=True)
        )
        is_clockwise = not twice_area > 0
        corners = np.array(points[::-1] if is_clockwise else points)
        areas.append(PaintedArea(patch.kind, freeze(corners)))
    return areas


def _rounded(value: float) -> float:
    """Return a value to 1e-6, without minus zero."""
    return round(value, 6) + 0.0
