"""Demands by vehicles that come into the lane: merging cars, cars that leave the kerb, ambulances."""

import numpy as np

from oodscen.stages._demands.setting import (
    CARS,
    FRONT_M,
    LARGE_M2,
    Draft,
    Setting,
    actor,
    demand,
    everyday_name,
    with_article,
)

_SOFT = 3.0
"""Deceleration that a joining vehicle may ask of the ego, m/s^2."""
_PULLS_AWAY = 1.6
"""Acceleration of a car that leaves the kerb, m/s^2."""
_MOVE_S = 3.0
"""Time that the move into the lane takes, s."""
_MIRROR_S = 2.0
"""Least time by which a joining vehicle has begun to move at the decision, s."""
_PARKED_M = 2.2
"""Least width of a strip to park on, m."""
_LEAVING_M = 5.0
"""Gap that a car needs to the parked one ahead of it, to leave the kerb past it, m."""


def merging_car(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a car that moves over with its indicator on, or leaves the kerb where there is one lane."""
    if setting.lanes == 1:
        return _leaves_the_kerb(setting, rng)
    side = 1 if setting.lane < setting.lanes - 1 else -1
    asset = setting.choose(rng, *(("truck", "van") if setting.area_m2 > LARGE_M2 else CARS))
    if not asset or setting.decision_s < _MIRROR_S or setting.has("junction"):
        return None
    speed = 0.7 * setting.speed
    reach = 0.5 * setting.length(asset)
    gap = setting.gap_to(reach, 3.0, _SOFT, speed)
    begin = setting.decision_m + gap - speed * setting.decision_s
    if begin < reach + FRONT_M + 4.0:
        return None
    state = "indicate_right" if side > 0 else "indicate_left"
    car = actor(
        "merging",
        asset,
        begin,
        lane=side,
        behaviour="cut_in",
        start_s=setting.decision_s - float(rng.uniform(1.6, 2.0)),
        state=state,
        speed=speed,
        lanes=-side,
        duration=_MOVE_S,
    )
    noun = everyday_name(asset)
    quote = f"{with_article(noun)} ahead merges into the lane with its indicator on"
    return demand([car], noun, quote, ("motion", "into_lane"), ("place", "ahead"))


def _leaves_the_kerb(setting: Setting, rng: np.random.Generator) -> Draft | None:
    moved_s = min(setting.decision_s, float(rng.uniform(2.4, 3.2)))
    asset = setting.choose(rng, *CARS)
    if not asset or moved_s < _MIRROR_S or setting.has("junction", "roundabout"):
        return None
    moved_m = 0.5 * _PULLS_AWAY * moved_s * moved_s
    gap = setting.gap_to(0.5 * setting.length(asset), 4.0, _SOFT, 3.5)
    begin = setting.decision_m + gap - moved_m
    strip_m = setting.edge(begin) - setting.half_width(begin)
    if begin < 8.0 or strip_m < _PARKED_M - 0.2:
        return None
    offset_m = -(setting.half_width(begin) + 0.5 * strip_m)
    cars = [
        actor(
            "leaving",
            asset,
            begin,
            offset_m=offset_m,
            behaviour="pull_out",
            start_s=setting.decision_s - moved_s,
            state="indicate_left",
            speed=min(7.0, 0.9 * setting.speed),
            duration=_MOVE_S,
        )
    ]
    along_m = begin - 0.5 * setting.length(asset)
    for number in range(1, int(rng.integers(2, 4))):
        parked = setting.choose(rng, *CARS)
        along_m -= 0.5 * setting.length(parked) + 1.4
        if along_m > 5.0:
            cars.append(actor(f"parked-{number}", parked, along_m, offset_m=offset_m))
        along_m -= 0.5 * setting.length(parked)
    front = setting.choose(rng, *CARS)
    front_m = begin + 0.5 * (setting.length(asset) + setting.length(front)) + _LEAVING_M
    cars.append(actor("parked-front", front, front_m, offset_m=offset_m))
    noun = everyday_name(asset)
    quote = f"{with_article(noun)} leaves its parking space ahead with its indicator on"
    return demand(cars, noun, quote, ("motion", "moving"), ("place", "ahead"))


def ambulance(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return an ambulance with its blue lights on that passes and moves back ahead of the ego."""
    if "ambulance" not in setting.assets or setting.has("junction", "roundabout", "tunnel"):
        return None
    if setting.decision_s < 2.6 or setting.lane >= setting.lanes - 1:
        return None
    speed = setting.speed + 2.5
    gap = max(min(setting.gap_m, 22.0), 11.0)
    begin = setting.decision_m + gap - speed * setting.decision_s
    passing = actor(
        "ambulance",
        "ambulance",
        begin,
        lane=1,
        behaviour="cut_in",
        start_s=setting.decision_s - float(rng.uniform(1.8, 2.2)),
        state="beacon",
        speed=speed,
        lanes=-1,
        duration=_MOVE_S,
    )
    quote = "an ambulance with its blue lights on passes and moves over ahead of the ego vehicle"
    car = setting.choose(rng, *CARS)
    if not car:
        return None
    slower = 0.6 * setting.speed
    lead = actor(
        "lead",
        car,
        setting.decision_m + gap + 16.0 - slower * setting.decision_s,
        behaviour="follow_lane",
        speed=slower,
    )
    return demand([passing, lead], "ambulance", quote, ("state", "beacon"), ("motion", "moving"))
