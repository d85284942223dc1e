"""Demands at crossings: red lights and zebra crossings."""

from collections.abc import Sequence

import numpy as np

from oodscen.data._episode import REACTIONS_S
from oodscen.data._scene import BEFORE_LIGHT_M, Actor
from oodscen.prompts._landmarks import landmarks
from oodscen.stages._demands.setting import CARS, FRONT_M, PEOPLE, Draft, Setting, actor, demand

_FIRM = 4.0
"""Deceleration that a crossing may ask of the ego, m/s^2."""
_CLEAR_S = 0.8
"""Time for which a light is red before anyone steps onto the crossing, s."""
_APART_M = (0.0, 1.0, -1.0)
"""Places of people along the road on a crossing, m from its middle."""

_RED = ("traffic light", "the traffic light is red")


def red_light(at: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a red light: of the junction, or of a crossing for people on foot."""
    if "traffic_light" not in at.assets or not at.has("urban", "residential"):
        return None
    if at.has("junction", "roundabout"):
        return _at_the_junction(at, rng)
    return _pelican(at, rng)


def _at_the_junction(at: Setting, rng: np.random.Generator) -> Draft | None:
    marks = [one for one in landmarks(at.corridor, at.road.traits) if one.kind == "traffic_light"]
    if not marks:
        return None
    line = min(one.ahead_m for one in marks) - BEFORE_LIGHT_M
    waits = _waiting(at, rng, line)
    if not waits:
        return None
    lights = [
        actor(
            f"light-{number}",
            "traffic_light",
            mark.ahead_m,
            lane=-at.lane,
            offset=mark.left_m,
            state="red",
        )
        for number, mark in enumerate(marks, start=1)
    ]
    return demand(
        [*waits, *lights], *_RED, ("state", "red"), rest=" and a car waits at the line ahead"
    )


def _waiting(at: Setting, rng: np.random.Generator, line: float) -> list[Actor]:
    """Return vehicles that wait at a line, in every lane that leads the ego's way; none if they come too near."""
    cars = []
    for lane in range(-at.lane, at.lanes - at.lane):
        asset = at.choose(rng, *CARS)
        if not asset:
            return []
        half = 0.5 * at.length(asset)
        place = line - half - float(rng.uniform(0.4, 1.0))
        is_ahead = lane == 0
        if is_ahead and place - at.decision_m < half + FRONT_M + 2.0 + at.room(_FIRM):
            return []
        if is_ahead or rng.random() < 0.6:
            name = "waiting" if is_ahead else f"beside{lane + 3}"
            cars.append(actor(name, asset, place, lane=lane, does="follow_lane", speed=0.0))
    return cars


def _stripes(at: Setting, ahead: float) -> list[Actor]:
    return [
        actor(f"zebra-{number}", "zebra_crossing", ahead, offset=offset)
        for number, offset in enumerate(at.lane_offsets(ahead), start=1)
    ]


def _walkers(at: Setting, rng: np.random.Generator, ahead: float, count: int) -> list[Actor]:
    """Return people on a crossing at the decision; the first is in the way when the ego would arrive."""
    low, high = -at.edge(ahead) - 0.6, at.edge(ahead, 1) + 0.6
    row = []
    for number in range(1, count + 1):
        who = at.choose(rng, *PEOPLE)
        if not who:
            return []
        speed = float(rng.uniform(1.1, 1.5))
        side = 1 if rng.random() < 0.6 else -1
        there, when = float(rng.uniform(low + 1.0, high - 1.0)), at.decision_s
        if number == 1:
            there, when = float(rng.uniform(-0.9, 0.9)), when + (ahead - at.decision_m) / at.speed
        start, end = (low, high) if side > 0 else (high, low)
        lag = abs(there - start) / speed + 0.3
        if lag > when:
            start, lag = there - side * speed * max(0.0, when - 0.3), when
        row.append(
            actor(
                f"walker-{number}",
                who,
                ahead + _APART_M[number - 1] + float(rng.uniform(-0.2, 0.2)),
                offset=start,
                heading=90.0 * side,
                does="cross_road",
                start=when - lag,
                speed=speed,
                distance=min(60.0, abs(end - start) + 0.5),
            )
        )
    return row


def _pelican(at: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a crossing for people on foot whose light is red for the ego."""
    if "zebra_crossing" not in at.assets:
        return None
    # The slowest driver has to stop before the line, or no action would be safe.
    needed = FRONT_M + 4.5 + at.room(_FIRM) + REACTIONS_S[-1] * at.speed
    ahead = at.decision_m + max(at.gap_m, needed)
    row = _stripes(at, ahead)
    walkers = _walkers(at, rng, ahead, int(rng.integers(1, 4)))
    since = _turns_red(walkers)
    if since:
        walkers = [one for one in walkers if one.behaviour.trigger.value > since]
    side, other = at.edge(ahead), at.edge(ahead, 1)
    places = [-side - 0.6]
    if at.lanes > 1 and not at.road.oncoming_lanes:
        places.append(other + 0.6)
    row += [
        actor(
            f"light-{number}", "traffic_light", ahead - 2.6, offset=place, state="red", start=since
        )
        for number, place in enumerate(places, start=1)
    ]
    row += walkers
    for lane in range(-at.lane, at.lanes - at.lane):
        # Nobody waits yet at a light that turns red.
        if lane and rng.random() < 0.6 and not since:
            asset = at.choose(rng, *CARS)
            place = ahead - 3.6 - 0.5 * at.length(asset)
            name = f"beside{lane + 3}"
            row.append(actor(name, asset, place, lane=lane, does="follow_lane", speed=0.0))
    rest = " while someone crosses the road on the zebra crossing"
    return demand(row, *_RED, ("state", "red"), rest=rest)


def _turns_red(walkers: Sequence[Actor]) -> float:
    """Return the time at which the light turns red for the first walker; 0 if it is red from the start."""
    steps_on = walkers[0].behaviour.trigger.value if walkers else 0.0
    return max(0.0, steps_on - _CLEAR_S)


def zebra(at: Setting, rng: np.random.Generator) -> Draft | None:
    """Return people who cross the road on a zebra crossing."""
    if not at.has("urban", "residential") or (at.has("junction") and not at.has("roundabout")):
        return None
    row: list[Actor] = []
    if at.has("roundabout"):
        places = [
            at.corridor.locate(*area.points.mean(axis=0).tolist())
            for area in at.corridor.crosswalks
            if area.kind == "crosswalk"
        ]
        ahead = min(
            (s - at.corridor.start for s, t in places if abs(t) < 3.0 and s > at.corridor.start),
            default=0.0,
        )
        if ahead - at.decision_m < FRONT_M + 2.0 + at.room(6.0):
            return None
    elif "zebra_crossing" not in at.assets:
        return None
    else:
        ahead = at.decision_m + max(at.gap_m, FRONT_M + 3.5 + at.room(_FIRM))
        row = _stripes(at, ahead)
    people = _walkers(at, rng, ahead, int(rng.integers(1, 4)))
    if not people:
        return None
    quote = "someone crosses the road on the zebra crossing ahead"
    return demand([*people, *row], "person", quote, ("motion", "crossing"), ("place", "ahead"))
