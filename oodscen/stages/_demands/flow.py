"""Demands by traffic ahead in the lane: queues, braking and slow vehicles, cyclists."""

import numpy as np

from oodscen.data._claim import Kind
from oodscen.data._scene import Actor
from oodscen.stages._demands.setting import (
    CARS,
    FRONT_M,
    LARGE,
    Draft,
    Setting,
    actor,
    beside,
    demand,
    everyday_name,
    standing_vehicle,
    with_article,
)

_LARGE_M2 = 4.5
"""Frontal area from which the rare body is matched by a lorry, square metres."""
_FIRM, _CALM, _SOFT = 4.2, 3.6, 2.8
"""Decelerations that a demand may ask of the ego, m/s^2."""


def _like(setting: Setting, rng: np.random.Generator) -> str:
    """Draw a vehicle about as large as the rare scene's body."""
    return setting.choose(rng, *(LARGE if setting.area_m2 > _LARGE_M2 else CARS))


def _line(
    setting: Setting, rng: np.random.Generator, rear: float, first: str, count: int, lane: int = 0
) -> list[Actor]:
    """Return vehicles that stand one behind the other, the last one's tail at `rear`, m."""
    row, place = [], rear
    for number in range(1, count + 1):
        asset = first if number == 1 and not lane else setting.choose(rng, *CARS)
        if not asset:
            return []
        place += 0.5 * setting.length(asset)
        name = f"queue-{number}" if not lane else f"{beside(lane)}-{number}"
        row.append(standing_vehicle(name, asset, place, lane))
        place += 0.5 * setting.length(asset) + float(rng.uniform(1.6, 3.0))
    return row


def queue(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return standing traffic: before the light of road works on one lane, or in all lanes."""
    first = _like(setting, rng)
    if not first:
        return None
    gap = max(setting.gap_m - 0.5 * setting.length(first), FRONT_M + 2.5 + setting.room(_CALM))
    rear = setting.decision_m + gap
    row = _line(setting, rng, rear, first, int(rng.integers(2, 5)))
    if setting.lanes == 1:
        if (
            setting.has("tunnel", "roundabout", "junction")
            or "temporary_light" not in setting.assets
        ):
            return _queued(row, "in the lane")
        end = max(one.placement.ahead_m for one in row) + 5.0
        side = setting.edge(end)
        light = actor("light", "temporary_light", end, offset=-side - 0.6, state="red")
        row.append(light)
        if "road_works_sign" in setting.assets:
            near = max(rear - float(rng.uniform(8.0, 14.0)), 8.0)
            row.append(actor("sign", "road_works_sign", near, offset=-setting.edge(near) - 0.6))
        return _queued(row, "in the lane before a temporary light that is red")
    for lane in setting.same_way_lanes:
        if lane:
            row += _line(setting, rng, rear + float(rng.uniform(-3.0, 8.0)), "", 2, lane)
    return _queued(row, "in all lanes")


def _queued(row: list[Actor], where: str) -> Draft:
    quote = "a queue of vehicles stands ahead"
    said: tuple[tuple[Kind, str], ...] = (("motion", "stationary"), ("place", "ahead"))
    return demand(row, "vehicle", quote, *said, rest=f" {where}")


def leader(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a vehicle ahead that brakes smoothly, for the end of a queue or to turn in at the roadside."""
    asset = _like(setting, rng)
    if not asset:
        return None
    hard = float(rng.uniform(2.0, 2.8))
    since = min(setting.decision_s, float(rng.uniform(1.0, 1.8)))
    speed = setting.speed
    slow = max(0.0, speed - hard * since)
    reach = 0.5 * setting.length(asset)
    gap = max(
        setting.gap_m, reach + FRONT_M + 3.0 + setting.room(_FIRM) - slow * slow / (2.0 * hard)
    )
    begin = setting.decision_m + gap - speed * setting.decision_s + 0.5 * hard * since * since
    if begin < reach + FRONT_M + 4.0:
        return None
    lead = actor(
        "leader",
        asset,
        begin,
        does="halt",
        start=setting.decision_s - since,
        speed=speed,
        deceleration=hard,
        pause=12.0,
    )
    noun = everyday_name(asset)
    stop = setting.decision_m + gap + slow * slow / (2.0 * hard) + reach + 3.0
    row = _line(setting, rng, stop, setting.choose(rng, *CARS), 2)
    quote = f"{with_article(noun)} ahead slows down"
    said: tuple[tuple[Kind, str], ...] = (("motion", "braking"), ("place", "ahead"))
    return demand([lead, *row], noun, quote, *said, rest=" behind a queue of vehicles")


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
    gap = max(
        setting.gap_m, 0.5 * setting.length(asset) + FRONT_M + 2.0 + setting.room(_SOFT, speed)
    )
    begin = setting.decision_m + gap - speed * setting.decision_s
    noun = everyday_name(asset)
    quote = f"{with_article(noun)} drives slowly ahead in the lane"
    slow = actor("slow", asset, begin, does="follow_lane", speed=speed)
    return demand(
        [slow], noun, quote, ("motion", "moving"), ("place", "ahead"), ("place", "in_lane")
    )


def cyclist(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return one or two cyclists who ride ahead at the right of the lane."""
    if setting.has("highway", "tunnel") or setting.lane:
        return None
    city = ("cyclist", "cyclist", "cargo_bike", "e_scooter")
    asset = setting.choose(rng, *(("cyclist",) if setting.has("rural") else city))
    if not asset:
        return None
    speed = min(float(rng.uniform(4.0, 5.4)), 0.7 * setting.speed)
    gap = max(setting.gap_m, 1.0 + FRONT_M + 2.0 + setting.room(_SOFT, speed))
    begin = setting.decision_m + gap - speed * setting.decision_s
    aside = -float(rng.uniform(0.1, 0.8))
    riders = [actor("rider-1", asset, begin, offset=aside, does="follow_lane", speed=speed)]
    if len(setting.scene.actors) > 2 and "cyclist" in setting.assets:
        behind = begin + float(rng.uniform(4.0, 7.0))
        riders.append(
            actor("rider-2", "cyclist", behind, offset=aside - 0.1, does="follow_lane", speed=speed)
        )
    noun = {"e_scooter": "person on an electric scooter"}.get(asset, "cyclist")
    quote = f"a {noun} rides ahead in the lane"
    about = {"e_scooter": "electric scooter"}.get(asset, "cyclist")
    return demand(riders, about, quote, ("motion", "moving"), ("place", "ahead"))
