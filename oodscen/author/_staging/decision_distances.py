"""Distances in which the ego can stop, brake calmly or swerve, and its approach to a hazard on a kind of road."""

from dataclasses import dataclass

from oodscen.author._knowledge.base import HazardKind, Recipe, RecipeActor, RoadKind
from oodscen.author._staging.anchors import ahead_of_start

APPROACH_S = (1.6, 3.0)
"""Range of times from the start to the decision, s."""
_CALM_MPS2 = 3.5
"""Comfortable braking of most cars, m/s^2."""
_LANE_CHANGE_S = 2.4
"""Duration of a lane change, s."""
_HARDEST_MPS2 = 8.0
"""Emergency braking on a dry road, m/s^2."""
_GRIP_MPS2 = 9.3
"""Deceleration that the grip of a dry road allows, m/s^2."""
_SLOWEST_S = 0.8
"""Reaction time of the slowest driver for whom an action must still be safe, s."""
_QUICKEST_S = 0.2
"""Reaction time of the quickest driver for whom an unsafe action must still be unsafe, s."""
_FAST_RATIO = 1.05
"""Ratio of the ego's speed to the nominal one in the worst case."""
_SLOW_RATIO = 0.95
"""Ratio of the ego's speed to the nominal one in the best case."""
_SLIPPERY_RATIO = 0.9
"""Ratio of the road's grip to the nominal one in the worst case."""
_EGO_LENGTH_M, _EGO_WIDTH_M = 4.5, 1.85
_LANE_WIDTH_M = 3.6
_STOPPED_BEFORE_M = 0.6
"""Room left in front of a small obstacle by a stop, m."""


@dataclass(frozen=True)
class Approach:
    """The ego's approach to the hazard."""

    speed: tuple[float, float]
    """Range of speeds, m/s."""
    ahead: tuple[float, float]
    """Distance from the ego's start to the actor of the decision, m."""


def room(speed: float, friction: float = 1.0) -> float:
    """Return the distance in which a car can stop comfortably or change lane, m."""
    return max(speed * speed / (2.0 * _CALM_MPS2 * friction), _LANE_CHANGE_S * speed)


def late_room(speed: float, friction: float = 1.0) -> float:
    """Return `room` for the slowest driver, m."""
    return _FAST_RATIO * (_SLOWEST_S * speed + room(speed, friction))


def spare(recipe: Recipe) -> float:
    """Return the margin of a recipe's decision distance over `room`, m."""
    low, high = recipe.speed
    return max(0.5 * sum(recipe.decision.value) - room(0.5 * (low + high)), 3.0)


def braking(speed: float, friction: float = 1.0) -> float:
    """Return the centre distance at which the slowest driver's emergency braking just avoids a small obstacle, m."""
    return _stopping(speed, min(_HARDEST_MPS2, _GRIP_MPS2 * _SLIPPERY_RATIO * friction))


def calm_braking(speed: float, friction: float = 1.0) -> float:
    """Return the centre distance at which the slowest driver's calm braking just avoids a small obstacle, m."""
    return _stopping(speed, min(_CALM_MPS2, _GRIP_MPS2 * _SLIPPERY_RATIO * friction))


def too_late_to_stop(speed: float, friction: float = 1.0) -> float:
    """Return the centre distance at which even the quickest driver's calm braking does not avoid a small obstacle, m."""
    slow = _SLOW_RATIO * speed
    deceleration = min(_CALM_MPS2, _GRIP_MPS2 * friction)
    return _QUICKEST_S * slow + slow * slow / (2.0 * deceleration) + 0.5 * _EGO_LENGTH_M


def _stopping(speed: float, deceleration: float) -> float:
    fast = _FAST_RATIO * speed
    braking_m = _SLOWEST_S * fast + fast * fast / (2.0 * deceleration)
    return braking_m + 0.5 * _EGO_LENGTH_M + _STOPPED_BEFORE_M


def swerving(speed: float, width: float, aside: float = 0.0) -> float:
    """Return the centre distance at which the slowest driver's lane change just avoids an obstacle, m.

    The obstacle may lie aside of its lane's centre, away from the ego's new lane.
    """
    share = (0.5 * (_EGO_WIDTH_M + width) + 0.25 - aside) / _LANE_WIDTH_M
    low, high = 0.0, 1.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        is_less = middle**3 * (10.0 - 15.0 * middle + 6.0 * middle * middle) < share
        low, high = (middle, high) if is_less else (low, middle)
    return (3.0 * high + _SLOWEST_S) * _FAST_RATIO * speed + 0.5 * _EGO_LENGTH_M + 1.6


def suits_any_speed(recipe: Recipe) -> bool:
    """Return whether a recipe can be played at the usual speed of any road because nothing in it moves."""
    return recipe.is_static and recipe.decision.kind == "distance"


def decisive(recipe: Recipe) -> RecipeActor | None:
    """Return the actor to which the decision is measured, or else the first unusual one."""
    for actor in recipe.actors:
        if recipe.decision.actor in actor.names:
            return actor
    return next(iter(recipe.hazards or recipe.actors), None)


def approach(hazard: HazardKind, place: RoadKind) -> Approach:
    """Return speeds and distances that suit a hazard on a kind of road."""
    recipe = hazard.stage
    if recipe is not None:
        actor = decisive(recipe)
        ahead = None if actor is None else ahead_of_start(recipe, actor)
        if ahead is not None and not suits_any_speed(recipe):
            return Approach(recipe.speed, ahead)
        if actor is not None:
            speed = 0.5 * sum(place.speed)
            decision = room(speed) + spare(recipe)
            soon, late = (decision + seconds * speed for seconds in APPROACH_S)
            return Approach(place.speed, (soon, late))
    speed = 0.5 * sum(place.speed)
    return Approach(place.speed, (3.5 * speed, 6.0 * speed))
