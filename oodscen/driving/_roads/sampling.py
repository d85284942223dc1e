"""Samples roads and routes of a network as corridors."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np

from oodscen.driving._roads.corridor import Corridor, OtherRoad, PaintedArea, RoadSignal
from oodscen.driving._roads.crosssection import Places, build_strips, freeze
from oodscen.driving._roads.leg_tracks import SAMPLE_STEP_M, tracks_of
from oodscen.driving._roads.network import Network, Road
from oodscen.driving._roads.routes import Leg
from oodscen.driving._roads.surroundings import (
    painted_areas,
    roads_by_distance,
    signal_in_world,
    structures_of,
)
from oodscen.numerics._arrays import rounded

_MAX_OTHERS_M = 60_000.0
"""Maximum total length of other roads, m; the nearest are kept."""
_MAX_FURNITURE = 5_000
"""Number of signals and painted areas at which no further road's are added."""
_DEFAULT_SPEED_LIMIT = 13.9
"""Speed limit of a road without one, m/s."""
_ROUNDING = 1e-9
"""Part of a step by which a length may exceed whole steps before one is added."""


def build_corridor(road: Road) -> Corridor:
    """Sample a single road, along its own reference line.

    Raises:
        ValueError: If the road has too many lanes.
    """
    return _sampled(Network({road.id: road}), [Leg(road, True)], 0, 0.0)


def build_route(network: Network, legs: Sequence[Leg], *, index: int, start_m: float) -> Corridor:
    """Sample the roads that the ego drives, and describe their surroundings.

    The ego starts on the leg of the given index, `start_m` along that road's own reference line.

    Raises:
        ValueError: If a bend is too tight to drive, or there are too many lanes.
    """
    corridor = _sampled(network, legs, index, start_m)
    taken = {leg.road.id for leg in legs}
    untaken = [road for road in network.roads.values() if road.id not in taken]
    signals: list[RoadSignal] = []
    areas: list[PaintedArea] = []
    for road in roads_by_distance(network.roads.values(), corridor):
        if len(signals) + len(areas) >= _MAX_FURNITURE:
            break
        signals += [signal_in_world(road, signal, corridor) for signal in road.signals]
        areas += painted_areas(road)
    return replace(
        corridor,
        others=tuple(_others(untaken, corridor)),
        signals=tuple(signals),
        crosswalks=tuple(areas),
    )


def _others(roads: Sequence[Road], corridor: Corridor) -> list[OtherRoad]:
    """Return the roads near a corridor, in the order given, as far as there is room for them."""
    near = roads_by_distance(roads, corridor)
    ends_m = accumulate(road.length for road in near)
    kept = {road.id for road, end_m in zip(near, ends_m, strict=True) if end_m <= _MAX_OTHERS_M}
    return [
        OtherRoad(
            corridor=build_corridor(road),
            road_id=road.id,
            is_connecting=bool(road.junction),
            junction=road.junction,
        )
        for road in roads
        if road.id in kept
    ]


def _sampled(network: Network, legs: Sequence[Leg], index: int, start_m: float) -> Corridor:
    """Sample a chain of legs as one evenly spaced line."""
    tracks = tracks_of(legs)
    begins = [0.0, *accumulate(track.length for track in tracks)]
    length = begins[-1]
    count = max(2, math.ceil(length / SAMPLE_STEP_M - _ROUNDING) + 1)
    along = length * np.arange(count) / (count - 1)
    leg_numbers = np.searchsorted(begins[1:-1], along, side="right")
    road_s = np.empty(count)
    columns = np.empty((6, count))
    for number, (track, begin) in enumerate(zip(tracks, begins[:-1], strict=True)):
        is_on_leg = leg_numbers == number
        road_s[is_on_leg] = track.own(along[is_on_leg] - begin)
        columns[:, is_on_leg] = track.points(road_s[is_on_leg])
    x, y, z, cosine, sine, curvature = (freeze(rounded(column)) for column in columns)
    in_junction = np.array([bool(leg.road.junction) for leg in legs])[leg_numbers]
    in_junction.setflags(write=False)
    places = Places(leg_numbers, road_s, [track.shift for track in tracks])
    start = begins[index] + tracks[index].from_start(start_m)
    strips = build_strips(
        network, legs, places, in_junction, step=length / (count - 1), start=start
    )
    return Corridor(
        s=freeze(rounded(along)),
        x=x,
        y=y,
        z=z,
        cos=cosine,
        sin=sine,
        curvature=curvature,
        strips=tuple(strips),
        start=start,
        speed_limit=legs[index].road.speed_limit(start_m) or _DEFAULT_SPEED_LIMIT,
        keeps_left=legs[index].road.left_hand,
        in_junction=in_junction,
        structures=structures_of(tracks, begins[:-1]),
    )
