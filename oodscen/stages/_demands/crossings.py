"""Demands at crossings: red lights and zebra crossings."""

import numpy as np

from oodscen.data._reactions import REACTIONS_S
from oodscen.data._scene import BEFORE_LIGHT_M, Actor
from oodscen.prompts._landmarks import landmarks
from oodscen.stages._demands.setting import (
    CARS,
    FRONT_M,
    PEOPLE,
    Draft,
    Setting,
    actor,
    beside,
    demand,
    standing_vehicle,
)

_FIRM = 4.0
"""Deceleration that a crossing may ask of the ego, m/s^2."""
_HARD = 6.0
"""Deceleration that the crossing of a roundabout may ask of the ego: its place is the map's, m/s^2."""
_SPARE_M = 2.0
"""Least distance that remains before the ego's bumper, m."""
_SHORT_OF_LINE_M = (0.4, 1.0)
"""Distance of a waiting vehicle's front from the line, m."""
_HAS_COMPANY = 0.6
"""Probability that a vehicle waits in a lane beside the ego's."""

_STOPS_BEFORE_CROSSING_M = 3.5
"""Distance of the ego's bumper from the middle of a crossing without a light when it has stopped, m."""
_STOPS_BEFORE_LIT_CROSSING_M = 4.5
"""The same for a crossing with a light, m."""
_LINE_BEFORE_CROSSING_M = 3.6
"""Distance of the stop line from the middle of a crossing with a light, m."""
_LIGHT_BEFORE_CROSSING_M = 2.6
"""Distance of the light from the middle of its crossing, m."""
_ACROSS_LANE_M = 3.0
"""Offset from the ego's way up to which the middle of a map's crossing counts as on it, m."""

_CLEAR_S = 0.8
"""Time for which a light is red before anyone steps onto the crossing, s."""
_SEEN_RED_S = 0.1
"""Time for which the light is red at the decision, at least, s; its text and claim tell so."""
_HEAD_START_S = 0.3
"""Time that people need to begin to walk, s."""
_KERB_M = 0.6
"""Distance of lights, and of people before and after they cross, from the edge of the asphalt, m."""
_IN_THE_WAY_M = 0.9
"""Greatest offset of the first walker from the middle of the ego's lane when the ego would arrive, m."""
_LONGEST_WALK_M = 60.0
"""Longest way that the behaviour `cross_road` allows, m."""
_APART_M = (0.0, 1.0, -1.0)
"""Places of people along the road on a crossing, m from its middle."""

_RED = ("traffic light", "the traffic light is red")


def red_light(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a red light: of the junction, or of a crossing for people on foot."""
    if "traffic_light" not in setting.assets or not setting.has("urban", "residential"):
        return None
    if setting.has("junction", "roundabout"):
        return _light_at_junction(setting, rng)
    return _light_at_crossing(setting, rng)


def _light_at_junction(setting: Setting, rng: np.random.Generator) -> Draft | None:
    marks = [
        landmark
        for landmark in landmarks(setting.corridor, setting.road.traits)
        if landmark.kind == "traffic_light"
    ]
    if not marks:
        return None
    line = min(mark.ahead_m for mark in marks) - BEFORE_LIGHT_M
    waiting = _waiting(setting, rng, line)
    if not waiting:
        return None
    lights = [
        actor(
            f"light-{number}",
            "traffic_light",
            mark.ahead_m,
            lane=-setting.lane,
            offset_m=mark.left_m,
            state="red",
        )
        for number, mark in enumerate(marks, start=1)
    ]
    return demand(
        [*waiting, *lights], *_RED, ("state", "red"), rest=" and a car waits at the line ahead"
    )


def _waiting(setting: Setting, rng: np.random.Generator, line: float) -> list[Actor]:
    """Return vehicles that wait at a line, in every lane that leads the ego's way; none if they come too near."""
    cars = []
    for lane in setting.same_way_lanes:
        asset = setting.choose(rng, *CARS)
        if not asset:
            return []
        half = 0.5 * setting.length(asset)
        ahead_m = line - half - float(rng.uniform(*_SHORT_OF_LINE_M))
        if lane == 0:
            needed = half + FRONT_M + _SPARE_M + setting.braking_m(_FIRM)
            if ahead_m - setting.decision_m < needed:
                return []
            cars.append(standing_vehicle("waiting", asset, ahead_m))
        elif rng.random() < _HAS_COMPANY:
            cars.append(standing_vehicle(beside(lane), asset, ahead_m, lane))
    return cars


def _light_at_crossing(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a crossing for people on foot whose light is red for the ego."""
    if "zebra_crossing" not in setting.assets:
        return None
    # The slowest driver has to stop before the line, or no action would be safe.
    needed = (
        FRONT_M
        + _STOPS_BEFORE_LIT_CROSSING_M
        + setting.braking_m(_FIRM)
        + REACTIONS_S[-1] * setting.speed
    )
    ahead = setting.decision_m + max(setting.gap_m, needed)
    walkers = _walkers(setting, rng, ahead)
    if not walkers:
        return None
    first_s = walkers[0].behaviour.trigger.value
    red_since_s = max(0.0, min(first_s - _CLEAR_S, setting.decision_s - _SEEN_RED_S))
    if red_since_s:
        walkers = [walker for walker in walkers if walker.behaviour.trigger.value > red_since_s]
    actors = [*_stripes(setting, ahead), *_lights(setting, ahead, red_since_s), *walkers]
    line = ahead - _LINE_BEFORE_CROSSING_M
    actors += _company(setting, rng, line, is_red=not red_since_s)
    rest = " while someone crosses the road on the zebra crossing"
    return demand(actors, *_RED, ("state", "red"), rest=rest)


def _lights(setting: Setting, ahead: float, red_since_s: float) -> list[Actor]:
    """Return the lights of a crossing: on the right, and on the left of a road that leads one way only."""
    offsets = [-setting.edge(ahead) - _KERB_M]
    if setting.lanes > 1 and not setting.road.oncoming_lanes:
        offsets.append(setting.edge(ahead, 1) + _KERB_M)
    return [
        actor(
            f"light-{number}",
            "traffic_light",
            ahead - _LIGHT_BEFORE_CROSSING_M,
            offset_m=offset,
            state="red",
            start_s=red_since_s,
        )
        for number, offset in enumerate(offsets, start=1)
    ]


def _company(
    setting: Setting, rng: np.random.Generator, line: float, *, is_red: bool
) -> list[Actor]:
    """Return cars that wait in the lanes beside the ego's; none at a light that is still to turn red."""
    cars = []
    for lane in setting.same_way_lanes:
        if lane and rng.random() < _HAS_COMPANY and is_red:
            asset = setting.choose(rng, *CARS)
            if asset:
                ahead_m = line - 0.5 * setting.length(asset)
                cars.append(standing_vehicle(beside(lane), asset, ahead_m, lane))
    return cars


def zebra(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return people who cross the road on a zebra crossing."""
    if not setting.has("urban", "residential"):
        return None
    if setting.has("roundabout"):
        ahead = _crossing_of_map(setting)
        needed = FRONT_M + _SPARE_M + setting.braking_m(_HARD)
        if ahead - setting.decision_m < needed:
            return None
        stripes = []
    elif setting.has("junction") or "zebra_crossing" not in setting.assets:
        return None
    else:
        needed = FRONT_M + _STOPS_BEFORE_CROSSING_M + setting.braking_m(_FIRM)
        ahead = setting.decision_m + max(setting.gap_m, needed)
        stripes = _stripes(setting, ahead)
    people = _walkers(setting, rng, ahead)
    if not people:
        return None
    quote = "someone crosses the road on the zebra crossing ahead"
    return demand([*people, *stripes], "person", quote, ("motion", "crossing"), ("place", "ahead"))


def _crossing_of_map(setting: Setting) -> float:
    """Return the distance of the map's first crossing from the ego's start, along its way, m; 0 if there is none."""
    corridor = setting.corridor
    middles = [
        corridor.locate(*area.points.mean(axis=0).tolist())
        for area in corridor.crosswalks
        if area.kind == "crosswalk"
    ]
    return min(
        (s - corridor.start for s, t in middles if abs(t) < _ACROSS_LANE_M and s > corridor.start),
        default=0.0,
    )


def _stripes(setting: Setting, ahead: float) -> list[Actor]:
    return [
        actor(f"zebra-{number}", "zebra_crossing", ahead, offset_m=offset)
        for number, offset in enumerate(setting.lane_offsets(ahead), start=1)
    ]


def _walkers(setting: Setting, rng: np.random.Generator, ahead: float) -> list[Actor]:
    """Return one to three people on a crossing at the decision, the first in the way when the ego would arrive.

    There are none if the catalogue has no people, or the ego stands.
    """
    if not setting.speed:
        return []
    right, left = -setting.edge(ahead) - _KERB_M, setting.edge(ahead, 1) + _KERB_M
    walkers = []
    for number in range(1, int(rng.integers(1, 1 + len(_APART_M))) + 1):
        asset = setting.choose(rng, *PEOPLE)
        if not asset:
            return []
        speed = float(rng.uniform(1.1, 1.5))
        side = 1 if rng.random() < 0.6 else -1
        met_m, met_s = float(rng.uniform(right + 1.0, left - 1.0)), setting.decision_s
        if number == 1:
            met_m = float(rng.uniform(-_IN_THE_WAY_M, _IN_THE_WAY_M))
            met_s += (ahead - setting.decision_m) / setting.speed
        start_m, end_m = (right, left) if side > 0 else (left, right)
        walk_s = abs(met_m - start_m) / speed + _HEAD_START_S
        if walk_s > met_s:
            start_m, walk_s = met_m - side * speed * max(0.0, met_s - _HEAD_START_S), met_s
        walkers.append(
            actor(
                f"walker-{number}",
                asset,
                ahead + _APART_M[number - 1] + float(rng.uniform(-0.2, 0.2)),
                offset_m=start_m,
                heading_deg=90.0 * side,
                behaviour="cross_road",
                start_s=met_s - walk_s,
                speed=speed,
                distance=min(_LONGEST_WALK_M, abs(end_m - start_m) + 0.5),
            )
        )
    return walkers
