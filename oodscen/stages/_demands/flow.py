"""Demands by traffic ahead in the lane: queues, braking and slow vehicles, cyclists."""

from collections.abc import Sequence

import numpy as np

from oodscen.data._scene import Actor
from oodscen.stages._demands.setting import (
    CARS,
    FRONT_M,
    LARGE,
    LARGE_M2,
    Draft,
    Setting,
    actor,
    beside,
    demand,
    everyday_name,
    standing_vehicle,
    with_article,
)

_FIRM, _CALM, _SOFT = 4.2, 3.6, 2.8
"""Decelerations that a demand may ask of the ego, m/s^2."""
_KERB_M = 0.6
"""Distance of lights and signs from the edge of the asphalt, m."""


def _vehicle_of_like_size(setting: Setting, rng: np.random.Generator) -> str:
    """Draw a vehicle about as large as the rare scene's body; empty if the simulator has none."""
    return setting.choose(rng, *(LARGE if setting.area_m2 > LARGE_M2 else CARS))


def _standing_line(
    setting: Setting, rng: np.random.Generator, rear_m: float, first: str, count: int, lane: int = 0
) -> list[Actor]:
    """Return vehicles that stand one behind the other, the last one's tail at `rear_m`; none if there are no cars."""
    vehicles, along_m = [], rear_m
    for number in range(1, count + 1):
        asset = first if number == 1 and not lane else setting.choose(rng, *CARS)
        if not asset:
            return []
        along_m += 0.5 * setting.length(asset)
        name = f"{beside(lane)}-{number}" if lane else f"queue-{number}"
        vehicles.append(standing_vehicle(name, asset, along_m, lane))
        along_m += 0.5 * setting.length(asset) + float(rng.uniform(1.6, 3.0))
    return vehicles


def queue(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return standing traffic: before the light of road works on one lane, or in all lanes."""
    first = _vehicle_of_like_size(setting, rng)
    if not first:
        return None
    gap = max(setting.gap_m - 0.5 * setting.length(first), FRONT_M + 2.5 + setting.braking_m(_CALM))
    rear_m = setting.decision_m + gap
    vehicles = _standing_line(setting, rng, rear_m, first, int(rng.integers(2, 5)))
    if not vehicles:
        return None
    if setting.lanes > 1:
        for lane in setting.same_way_lanes:
            if lane:
                beside_m = rear_m + float(rng.uniform(-3.0, 8.0))
                vehicles += _standing_line(setting, rng, beside_m, "", 2, lane)
        return _queue_demand(vehicles, "in all lanes")
    if setting.has("tunnel", "roundabout", "junction") or "temporary_light" not in setting.assets:
        return _queue_demand(vehicles, "in the lane")
    light_m = max(vehicle.placement.ahead_m for vehicle in vehicles) + 5.0
    actors = [*vehicles, _roadside(setting, "light", "temporary_light", light_m, state="red")]
    if "road_works_sign" in setting.assets:
        sign_m = max(rear_m - float(rng.uniform(8.0, 14.0)), 8.0)
        actors.append(_roadside(setting, "sign", "road_works_sign", sign_m))
    return _queue_demand(actors, "in the lane before a temporary light that is red")


def _roadside(setting: Setting, name: str, asset: str, ahead_m: float, *, state: str = "") -> Actor:
    """Return what stands beside the asphalt on the right."""
    offset_m = -setting.edge(ahead_m) - _KERB_M
    return actor(name, asset, ahead_m, offset_m=offset_m, state=state)


def _queue_demand(actors: Sequence[Actor], where: str) -> Draft:
    return demand(
        actors,
        "vehicle",
        "a queue of vehicles stands ahead",
        ("motion", "stationary"),
        ("place", "ahead"),
        rest=f" {where}",
    )


def leader(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a vehicle ahead that brakes smoothly, for the end of a queue or to turn in at the roadside."""
    asset = _vehicle_of_like_size(setting, rng)
    if not asset:
        return None
    deceleration = float(rng.uniform(2.0, 2.8))
    braked_s = min(setting.decision_s, float(rng.uniform(1.0, 1.8)))
    speed_at_decision = max(0.0, setting.speed - deceleration * braked_s)
    left_m = speed_at_decision * speed_at_decision / (2.0 * deceleration)
    reach = 0.5 * setting.length(asset)
    gap = setting.gap_to(reach, 3.0 - left_m, _FIRM)
    lost_m = 0.5 * deceleration * braked_s * braked_s
    begin = setting.decision_m + gap - setting.speed * setting.decision_s + lost_m
    if begin < reach + FRONT_M + 4.0:
        return None
    lead = actor(
        "leader",
        asset,
        begin,
        behaviour="halt",
        start_s=setting.decision_s - braked_s,
        speed=setting.speed,
        deceleration=deceleration,
        pause=12.0,
    )
    noun = everyday_name(asset)
    stop_m = setting.decision_m + gap + left_m + reach + 3.0
    line = _standing_line(setting, rng, stop_m, setting.choose(rng, *CARS), 2)
    if not line:
        return None
    return demand(
        [lead, *line],
        noun,
        f"{with_article(noun)} ahead slows down",
        ("motion", "braking"),
        ("place", "ahead"),
        rest=" behind a queue of vehicles",
    )


def slow_vehicle(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a vehicle that drives slowly ahead: a tractor in the country, a lorry elsewhere."""
    if setting.lane or setting.has("roundabout"):
        return None
    if setting.has("rural") and not setting.has("tunnel", "bridge"):
        asset, speed = setting.choose(rng, "tractor"), min(8.0, 0.55 * setting.speed)
    elif setting.has("highway", "rural"):
        asset = setting.choose(rng, "truck", "tanker", "camper", "cement_mixer")
        speed = 0.65 * setting.speed
    else:
        asset = setting.choose(rng, "garbage_truck", "cement_mixer", "truck")
        speed = 0.45 * setting.speed
    if not asset:
        return None
    gap = setting.gap_to(0.5 * setting.length(asset), 2.0, _SOFT, speed)
    begin = setting.decision_m + gap - speed * setting.decision_s
    noun = everyday_name(asset)
    quote = f"{with_article(noun)} drives slowly ahead in the lane"
    slow = actor("slow", asset, begin, behaviour="follow_lane", speed=speed)
    return demand(
        [slow], noun, quote, ("motion", "moving"), ("place", "ahead"), ("place", "in_lane")
    )


def cyclist(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return one or two cyclists who ride ahead at the right of the lane."""
    if setting.has("highway", "tunnel") or setting.lane:
        return None
    others = () if setting.has("rural") else ("cyclist", "cargo_bike", "e_scooter")
    asset = setting.choose(rng, "cyclist", *others)
    if not asset:
        return None
    speed = min(float(rng.uniform(4.0, 5.4)), 0.7 * setting.speed)
    gap = setting.gap_to(1.0, 2.0, _SOFT, speed)
    begin = setting.decision_m + gap - speed * setting.decision_s
    aside = -float(rng.uniform(0.1, 0.8))
    places = [("rider-1", asset, begin, aside)]
    if len(setting.scene.actors) > 2 and "cyclist" in setting.assets:
        places.append(("rider-2", "cyclist", begin + float(rng.uniform(4.0, 7.0)), aside - 0.1))
    riders = [
        actor(name, kind, ahead_m, offset_m=offset_m, behaviour="follow_lane", speed=speed)
        for name, kind, ahead_m, offset_m in places
    ]
    rider = subject = "cyclist"
    if asset == "e_scooter":
        rider, subject = "person on an electric scooter", "electric scooter"
    quote = f"a {rider} rides ahead in the lane"
    return demand(riders, subject, quote, ("motion", "moving"), ("place", "ahead"))
