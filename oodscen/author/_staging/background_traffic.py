"""Ordinary background traffic around the ego at the decision, which no text mentions."""

import math
from collections.abc import Sequence

from oodscen.author._knowledge.base import AmbientTraffic
from oodscen.author._staging.layout import Layout
from oodscen.author._staging.told import Told
from oodscen.data._scene import Actor, Behaviour, Placement, Trigger
from oodscen.driving._motion.behaviours.table import DRIVES_IN_LANE
from oodscen.prompts._digest import CatalogueDigest

_MOST_AHEAD_M = 280.0
"""Largest distance of background traffic ahead, m."""
_OVERHANGING_M = 1.2
"""Offset from the lane's centre beyond which an actor may reach into the next lane, m."""
_OFF_ROAD_M = 2.5
"""Offset from the lane's centre beyond which an actor stands off the road, m."""
_DESIRED_RATIO = 1.25
"""Ratio of a follower's desired speed to the ego's."""
_PASSING_RATIOS = (0.86, 0.94)
"""Speed of a vehicle beside the ego relative to the ego's: it passes through the picture while the ego overtakes it."""
_CENTRES_M = 9.0
"""Distance between the centres of a car and a lorry close behind it, m."""
_LEAST_CLOSING_MPS = 0.1
"""Least speed towards an actor for which the time of the decision is estimated, m/s."""


def available(kinds: Sequence[AmbientTraffic], digest: CatalogueDigest) -> list[AmbientTraffic]:
    """Return the kinds of background traffic that a catalogue has, with the assets that it has."""
    if all(kind.id != "follow_lane" for kind in digest.behaviours):
        return []
    known = digest.by_name
    offered = (
        (kind, tuple(known[name].id for name in kind.asset if name in known)) for kind in kinds
    )
    return [kind.model_copy(update={"asset": names}) for kind, names in offered if names]


def surrounding_traffic(
    kinds: Sequence[AmbientTraffic],
    layout: Layout,
    actors: Sequence[Actor],
    decision_s: float,
    *,
    is_dense: bool = False,
) -> list[Actor]:
    """Draw the ordinary traffic beside the ego and in the oncoming lane, about where it is at the decision.

    Lanes that actors use stay free, and so does the one to which the ego may have to escape. In dense traffic every
    kind that has room appears.
    """
    lane, road, speed = layout.ego_lane, layout.road, layout.speed
    is_innermost = lane + 1 == road.lanes
    has_room = {
        "left": lane + 1 < road.lanes,
        "right": lane > 0,
        "oncoming": is_innermost and road.oncoming_lanes > 0 and "divided" not in road.traits,
    }
    traffic: list[Actor] = []
    for kind in kinds:
        if kind.side == "behind":
            continue
        chance, speed_share, gap_share = map(float, layout.rng.random(3))
        asset = kind.asset[int(layout.rng.integers(len(kind.asset)))]
        side = -1 if kind.side == "right" else 1
        if (chance >= kind.share and not is_dense) or not has_room[kind.side]:
            continue
        if side == layout.escape or any(_needs_lane(actor, side) for actor in actors):
            continue
        if kind.speed == "ego":
            slowest, fastest = (ratio * speed for ratio in _PASSING_RATIOS)
        else:
            slowest, fastest = kind.speed
        own_speed = min(_between((slowest, fastest), speed_share), road.speed_limit)
        ahead = _between(kind.gap, gap_share)
        if kind.side == "oncoming":
            ahead += (speed + own_speed) * decision_s
        elif kind.speed == "ego" and math.isfinite(decision_s):
            ahead += (speed - own_speed) * decision_s
        if 0.0 <= ahead <= _MOST_AHEAD_M:
            parameters = {"speed": round(own_speed, 2)}
            traffic.append(_lane_follower(f"{kind.side}-traffic", asset, ahead, parameters, side))
    return traffic


def _lane_follower(
    name: str, asset: str, ahead: float, parameters: dict[str, float], lane: int = 0
) -> Actor:
    return Actor(
        id=name,
        asset=asset,
        placement=Placement(ahead_m=round(ahead, 2), lane=lane),
        behaviour=Behaviour(name="follow_lane", parameters=parameters),
    )


def tailgater(kinds: Sequence[AmbientTraffic], layout: Layout, told: Told) -> AmbientTraffic | None:
    """Return the kind of vehicle close behind the ego, if there is one; exactly one number is drawn in every case.

    If the text mentions traffic, no other is added.
    """
    draw, company = float(layout.rng.random()), layout.recipe.company
    behind = next((kind for kind in kinds if kind.side == "behind"), None)
    if behind is None or not company:
        return None
    is_needed = company == "follower" or told.is_followed
    is_added = told.traffic is None and (told.is_dense or draw < behind.share)
    return behind if is_needed or is_added else None


def follower(kind: AmbientTraffic, layout: Layout, actors: Sequence[Actor]) -> list[Actor]:
    """Draw the vehicle close behind the ego, unless another actor is there.

    It wants to drive faster than the ego, keeps less than the usual distance and brakes less hard
    than a car. It can stop behind an ego that brakes calmly, but not behind one that brakes with
    full force.
    """
    if any(_is_behind(actor) for actor in actors):
        return []
    asset = layout.choose(kind.asset)
    parameters = {name: layout.draw(limits) for name, limits in kind.parameters.items()}
    parameters["speed"] = round(_DESIRED_RATIO * layout.speed, 2)
    gap = layout.draw(kind.gap) * layout.speed + _CENTRES_M
    return [_lane_follower("behind-traffic", asset, -gap, parameters)]


def _is_behind(actor: Actor) -> bool:
    place = actor.placement
    return place.ahead_m < 0.0 and not place.lane and abs(place.offset_m) < _OFF_ROAD_M


def _between(limits: tuple[float, float], share: float) -> float:
    return limits[0] + (limits[1] - limits[0]) * share


def _needs_lane(actor: Actor, side: int) -> bool:
    """Return whether an actor needs the lane on one side of the ego's."""
    place, behaviour = actor.placement, actor.behaviour
    parameters = behaviour.parameters
    aside = side * place.offset_m
    if side * place.lane > 0:
        return behaviour.name != "stand" or aside < _OFF_ROAD_M
    if place.lane:
        return False
    return (
        aside > _OVERHANGING_M
        or side * parameters.get("lanes", 0.0) > 0.0
        or side * parameters.get("lateral", 0.0) > 0.0
        or behaviour.name == "u_turn"
    )


def expected_decision_s(decision: Trigger, actors: Sequence[Actor], speed: float) -> float:
    """Estimate the time of the decision, s; infinite if the actor that it waits for is missing."""
    if decision.kind == "time":
        return decision.value
    actor = next((other for other in actors if other.id == decision.actor), None)
    if actor is None:
        return math.inf
    closing = max(speed - along(actor), _LEAST_CLOSING_MPS)
    distance = decision.value * closing if decision.kind == "ttc" else decision.value
    return max(0.0, (abs(actor.placement.ahead_m) - distance) / closing)


def along(actor: Actor) -> float:
    """Return an actor's speed along the ego's road before it does anything unusual, m/s."""
    speed = actor.behaviour.parameters.get("speed", 0.0)
    if actor.behaviour.name == "walk_along":
        return speed * math.cos(math.radians(actor.placement.heading_deg))
    if actor.behaviour.name not in DRIVES_IN_LANE:
        return 0.0
    return -speed if actor.behaviour.name == "wrong_way" else speed
