"""Ordinary background traffic around the ego at the decision, which no text mentions."""

import math
from collections.abc import Sequence

import numpy as np

from oodscen.author._knowledge.base import AmbientTraffic, BackgroundTraffic, Recipe
from oodscen.author._staging.actors import SceneDraftState
from oodscen.data._scene import Actor, Behaviour, Placement, Trigger
from oodscen.driving._motion.behaviours import DRIVES_IN_LANE
from oodscen.prompts._digest import CatalogueDigest, MapLine

_MOST_AHEAD = 280.0
"""Largest distance of background traffic ahead, m."""
_OVERHANGS = 1.2
"""Offset from the lane's centre beyond which an actor may reach into the next lane, m."""
_BESIDE = 2.5
"""Offset from the lane's centre beyond which an actor stands off the road, m."""
_EAGER = 1.25
"""Ratio of a follower's desired speed to the ego's."""
_PACE = (0.86, 0.94)
"""Speed of a vehicle beside the ego relative to the ego's: it passes through the picture while the ego overtakes it."""
_BUMPERS = 9.0
"""Distance between the centres of a car and a lorry close behind it, m."""


def on_offer(kinds: Sequence[AmbientTraffic], digest: CatalogueDigest) -> list[AmbientTraffic]:
    """Return the kinds of background traffic that a catalogue has, with the assets that it has."""
    if all(kind.id != "follow_lane" for kind in digest.behaviours):
        return []
    known = {asset.id for asset in digest.assets}
    offered = ((kind, tuple(name for name in kind.asset if name in known)) for kind in kinds)
    return [kind.model_copy(update={"asset": names}) for kind, names in offered if names]


def company(
    kinds: Sequence[AmbientTraffic],
    road: MapLine,
    ego: tuple[int, float],
    actors: Sequence[Actor],
    decision: tuple[Trigger, str | None],
    rng: np.random.Generator,
    *,
    free: int = 0,
    is_dense: bool = False,
) -> list[Actor]:
    """Draw the ordinary traffic beside the ego and in the oncoming lane.

    The ego is given by lane, counted from the right, and speed, m/s; the decision by trigger and actor. Lanes that
    actors use stay free, and so does one side: 1 left, -1 right, 0 neither. In dense traffic every kind that has
    room appears.
    """
    lane, speed = ego
    found: list[Actor] = []
    for kind in kinds:
        if kind.side == "behind":
            continue
        draws = rng.random(3)
        pick = kind.asset[int(rng.integers(len(kind.asset)))]
        side = -1 if kind.side == "right" else 1
        has_room = {
            "left": lane + 1 < road.lanes,
            "right": lane > 0,
            "oncoming": (
                lane + 1 == road.lanes and road.oncoming_lanes > 0 and "divided" not in road.traits
            ),
        }[kind.side]
        if (draws[0] >= kind.share and not is_dense) or not has_room or side == free:
            continue
        if any(_takes(actor, side) for actor in actors):
            continue
        limits = kind.speed
        if limits == "ego":
            limits = (_PACE[0] * speed, _PACE[1] * speed)
        own = min(_between(limits, draws[1]), road.speed_limit)
        ahead, until = _between(kind.gap, draws[2]), expected_decision_s(decision, actors, speed)
        if kind.side == "oncoming":
            ahead += (speed + own) * until
        elif kind.speed == "ego" and math.isfinite(until):
            ahead += (speed - own) * until
        if not 0.0 <= ahead <= _MOST_AHEAD:
            continue
        found.append(
            Actor(
                id=f"{kind.side}-traffic",
                asset=pick,
                placement=Placement(ahead_m=round(ahead, 2), lane=side),
                behaviour=Behaviour(name="follow_lane", parameters={"speed": round(own, 2)}),
            )
        )
    return found


def is_followed(
    kinds: Sequence[AmbientTraffic],
    recipe: Recipe,
    named: BackgroundTraffic | None,
    rng: np.random.Generator,
    *,
    is_dense: bool = False,
) -> AmbientTraffic | None:
    """Return the kind of vehicle close behind the ego, if there is one; exactly one number is drawn in every case.

    If the text mentions traffic, no other is added.
    """
    draw = float(rng.random())
    behind = next((kind for kind in kinds if kind.side == "behind"), None)
    if behind is None or not recipe.company:
        return None
    if recipe.company == "follower" or (named is not None and named.key == "follower"):
        return behind
    return behind if named is None and (is_dense or draw < behind.share) else None


def follower(kind: AmbientTraffic, scene: SceneDraftState, actors: Sequence[Actor]) -> list[Actor]:
    """Draw the vehicle close behind the ego, unless another actor is there.

    It wants to drive faster than the ego, keeps less than the usual distance and brakes less hard
    than a car. It can stop behind an ego that brakes calmly, but not behind one that brakes with
    full force.
    """
    if any(_is_behind(actor) for actor in actors):
        return []
    asset = scene.choose(kind.asset)
    parameters = {name: scene.draw(limits) for name, limits in kind.parameters.items()}
    parameters["speed"] = round(_EAGER * scene.speed, 2)
    gap = scene.draw(kind.gap) * scene.speed + _BUMPERS
    return [
        Actor(
            id="behind-traffic",
            asset=asset,
            placement=Placement(ahead_m=round(-gap, 2)),
            behaviour=Behaviour(name="follow_lane", parameters=parameters),
        )
    ]


def _is_behind(actor: Actor) -> bool:
    place = actor.placement
    return place.ahead_m < 0.0 and not place.lane and abs(place.offset_m) < _BESIDE


def _between(limits: tuple[float, float], share: float) -> float:
    return limits[0] + (limits[1] - limits[0]) * float(share)


def _takes(actor: Actor, side: int) -> bool:
    """Return whether an actor needs the lane on one side of the ego's."""
    place, behaviour = actor.placement, actor.behaviour
    parameters = behaviour.parameters
    aside = side * place.offset_m
    if side * place.lane > 0:
        return behaviour.name != "stand" or aside < _BESIDE
    if place.lane:
        return False
    return (
        aside > _OVERHANGS
        or side * parameters.get("lanes", 0.0) > 0.0
        or side * parameters.get("lateral", 0.0) > 0.0
        or behaviour.name == "u_turn"
    )


def expected_decision_s(
    decision: tuple[Trigger, str | None], actors: Sequence[Actor], speed: float
) -> float:
    """Estimate the time of the decision, s; infinite if the actor that it waits for is missing."""
    trigger, name = decision
    if trigger.kind == "time":
        return trigger.value
    actor = next((a for a in actors if a.id == name), None)
    if actor is None:
        return math.inf
    closing = max(speed - along(actor), 0.1)
    left = trigger.value * closing if trigger.kind == "ttc" else trigger.value
    return max(0.0, (abs(actor.placement.ahead_m) - left) / closing)


def along(actor: Actor) -> float:
    """Return an actor's speed along the ego's road before it does anything unusual, m/s."""
    own = actor.behaviour.parameters.get("speed", 0.0)
    if actor.behaviour.name == "walk_along":
        return own * math.cos(math.radians(actor.placement.heading_deg))
    if actor.behaviour.name not in DRIVES_IN_LANE:
        return 0.0
    return -own if actor.behaviour.name == "wrong_way" else own
