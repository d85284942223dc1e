"""The decision of a scene: the ego's speed towards it, and the room that it leaves."""

from collections.abc import Callable
from dataclasses import replace

from oodscen.author._knowledge.base import RecipeActor
from oodscen.author._staging import decision_distances as distances
from oodscen.author._staging.anchors import ahead_of_start
from oodscen.author._staging.layout import Layout
from oodscen.data._scene import Trigger
from oodscen.driving._motion.behaviours.table import STAYS

DecisionDistance = Callable[[float], float]
"""Distance of the decision, m, as a function of the ego's speed, m/s."""

_LEAST_SPEED_MPS = 3.0
"""Least speed of the ego, m/s."""
_LEAST_FOLLOWED_MPS = 8.0
"""Speed down to which an ego that is followed slows down so that its hazard is recognised in time, m/s."""
_SLOWER, _FASTER = 0.95, 1.04
"""Ratios of successive speeds, and of distances, in the search for one that suits."""
_LEAST_APPROACH_S = 0.7
"""Least time from the start to the decision, if the text states a distance, s."""
_LATE_SHARE = 0.75
"""Share of late decisions, if at some distance only a lane change helps."""
_URGENT_SHARE = 0.7
"""Share of the other decisions at which emergency braking suffices but comfortable braking hardly does."""
_HURRIED_SHARE = 0.7
"""The same share for scenes in which someone crosses, or a group blocks the road."""
_EVADING_S = 2.2
"""Time before a head-on collision at which evasion is still possible, s."""
_CLEAR_PX = 400.0
"""Area in the dash camera's image below which an actor is not recognised at a glance, square pixels."""
_LEAST_WINDOW_M = 0.8
"""Least range of distances at which only hard braking suffices, m."""
_MOST_LATE_M = 4.0
"""Most of that range that is used, m."""
_SEEN_PX = 120.0
"""Area in the dash camera's image below which an actor is hardly seen, square pixels."""
_ASIDE_M = 0.4
"""Offset of an obstacle that requires a lane change, towards the far side of its lane, m."""
_SHORT_M = 2.0
"""Least distance from the start to the decision, if the text states a distance, m."""
_BEYOND_M = 1.0
"""Room left in front of an actor by the hardest stop, m."""
_ONCOMING_MPS = -1.0
"""Speed along the road below which an actor comes towards the ego, m/s."""
_LATEST_SHARE = 0.8
"""Greatest share of the distances too short for a stop that a hurried decision uses."""
_SPARE_LATE, _SPARE_LAST = 0.55, 0.75
"""Shares of the spare room that a late decision leaves, and at which its actor must be seen."""
_SPARE_CALM, _SPARE_MORE = 0.9, 0.4
"""Least share of the spare room that a calm decision leaves, and the range above it."""
_STOPPED_BY_M, _CHOICE_M = 1.5, 0.5
"""Distance by which a stop must fail, and least range of distances, if only a lane change helps, m."""
_SCATTER_M = 0.05
"""Greatest deviation from the offset of an obstacle that is moved aside, m."""
_INSIDE_M = 1.2
"""Offset from the lane's centre within which an obstacle is in the way, m."""


def with_decision(layout: Layout, distance_m: float | None) -> Layout:
    """Return the layout with its decision, a speed of the ego that suits it, and the actors' displacement.

    A distance in the text applies at the start of the scene; the decision comes later.
    """
    trigger = layout.recipe.decision
    value, shift = layout.draw(trigger.value), 0.0
    actor = distances.decisive(layout.recipe)
    if actor is not None:
        is_on_map = ahead_of_start(layout.recipe, actor) is None
        middle = 0.5 * sum(actor.ahead)
        if distances.suits_any_speed(layout.recipe):
            layout, distance_at = _with_room(layout, actor)
            value = distance_at(layout.speed)
            if not is_on_map:
                layout, value, start = _with_approach(layout, distance_at, distance_m)
                shift = start - middle
        elif distance_m is not None and not is_on_map:
            low, high = actor.ahead
            shift = min(max(distance_m, low), high) - middle
        if trigger.kind == "ttc":
            layout, value = _with_ttc(layout, actor, value)
    decision = Trigger(kind=trigger.kind, value=round(value, 2), actor=trigger.actor)
    return replace(layout, decision=decision, shift_m=round(shift, 2))


def _with_slower_ego(layout: Layout) -> Layout:
    return replace(layout, speed=round(_SLOWER * layout.speed, 2))


def _with_approach(
    layout: Layout, distance_at: DecisionDistance, distance_m: float | None
) -> tuple[Layout, float, float]:
    """Return the layout, slow enough for a stated distance, and the actor's distances at the decision and the start, m."""
    decision_m = distance_at(layout.speed)
    if distance_m is None:
        seconds = float(layout.rng.uniform(*distances.APPROACH_S))
        return layout, decision_m, decision_m + layout.speed * seconds
    while (
        layout.speed > _LEAST_SPEED_MPS
        and decision_m + _LEAST_APPROACH_S * layout.speed > distance_m
    ):
        layout = _with_slower_ego(layout)
        decision_m = distance_at(layout.speed)
    return layout, min(decision_m, max(distance_m - _SHORT_M, 1.0)), distance_m


def _with_ttc(layout: Layout, actor: RecipeActor, seconds: float) -> tuple[Layout, float]:
    """Return the TTC of the decision, reduced until the actor is large enough to recognise, s.

    In some scenes it is so short that only hard braking suffices. Nothing follows the ego where it cannot brake calmly.
    """
    draw, share = map(float, layout.rng.random(2))
    along, friction = layout.along(actor), layout.weather.friction
    closing = layout.speed - along
    if closing < _LEAST_SPEED_MPS:
        return layout, seconds
    reach = layout.reach(actor)
    hard_m = distances.braking(closing, friction) + reach + _BEYOND_M
    calm_m = max(distances.calm_braking(closing, friction) + reach, hard_m)
    least_m = _EVADING_S * closing if along < _ONCOMING_MPS else hard_m
    distance_m = seconds * closing
    while distance_m > least_m and layout.pixels(actor, distance_m) < _CLEAR_PX:
        distance_m *= _SLOWER
    if distance_m < calm_m:
        layout = replace(layout, is_followed=False)
    if actor.behaviour in STAYS and not layout.is_followed and draw < _HURRIED_SHARE:
        late_m = distances.too_late_to_stop(closing, friction) + reach
        if late_m > hard_m:
            distance_m = min(distance_m, hard_m + _LATEST_SHARE * share * (late_m - hard_m))
    return layout, min(seconds, distance_m / closing)


def _with_room(layout: Layout, actor: RecipeActor) -> tuple[Layout, DecisionDistance]:
    """Choose the speed of the ego and the distance that the decision leaves.

    It allows a comfortable stop or a lane change; or only hard braking; or, at speeds at which
    braking takes longer than that, only a lane change.
    """
    late, urgent, share = map(float, layout.rng.random(3))
    if late < _LATE_SHARE and (evasion := _evasion(layout, actor, share)) is not None:
        return evasion
    is_urgent = urgent < _URGENT_SHARE and not layout.is_followed
    friction, spare = layout.weather.friction, distances.spare(layout.recipe)

    def is_unseen(layout: Layout) -> bool:
        away = distances.late_room(layout.speed, friction) + spare
        return layout.pixels(actor, away) < _CLEAR_PX

    def is_seen_at_last(speed: float) -> bool:
        away = distances.braking(speed, friction) + _SPARE_LAST * spare
        return layout.pixels(actor, away) >= _SEEN_PX

    # A slower ego leaves room for a calm stop of both.
    while layout.is_followed and is_unseen(layout) and layout.speed > _LEAST_FOLLOWED_MPS:
        layout = _with_slower_ego(layout)
    if is_unseen(layout):
        layout = replace(layout, is_followed=False)
    while not is_seen_at_last(layout.speed) and layout.speed > _LEAST_SPEED_MPS:
        layout = _with_slower_ego(layout)
    if is_urgent or is_unseen(layout):
        fast = _urgent_speed(layout)
        if fast is not None and is_seen_at_last(fast):
            layout = replace(layout, speed=fast)
        else:
            fast = None
        if fast is not None or is_unseen(layout):
            window = min(max(_hard_braking_window(layout, layout.speed), 0.0), _MOST_LATE_M)
            return (
                layout,
                lambda speed: (
                    distances.braking(speed, friction) + _SPARE_LATE * spare + share * window
                ),
            )
    return (
        layout,
        lambda speed: (
            distances.late_room(speed, friction) + (_SPARE_CALM + _SPARE_MORE * share) * spare
        ),
    )


def _evasion(
    layout: Layout, actor: RecipeActor, share: float
) -> tuple[Layout, DecisionDistance] | None:
    """Return the distance at which only a lane change helps, around an obstacle moved aside; `None` if there is none."""
    recipe, road = layout.recipe, layout.road
    if not recipe.width or max(map(abs, actor.offset)) >= _INSIDE_M or road.lanes < 2:
        return None
    low = distances.swerving(layout.speed, recipe.width, _ASIDE_M)
    high = distances.braking(layout.speed, layout.weather.friction) - _STOPPED_BY_M
    if low + _CHOICE_M > high:
        return None
    escape = 1 if layout.ego_lane + 1 < road.lanes else -1
    aside = -escape * _ASIDE_M
    moved = actor.model_copy(update={"offset": (aside - _SCATTER_M, aside + _SCATTER_M)})
    actors = tuple(
        moved if recipe_actor is actor else recipe_actor for recipe_actor in recipe.actors
    )
    recipe = recipe.model_copy(update={"actors": actors})
    return replace(layout, recipe=recipe, escape=escape), lambda _: low + share * (high - low)


def _urgent_speed(layout: Layout) -> float | None:
    """Return the lowest speed, not below the ego's, at which the slowest driver can brake and the quickest cannot stop."""
    speed = layout.speed
    while speed <= layout.road.speed_limit:
        if _hard_braking_window(layout, speed) >= _LEAST_WINDOW_M:
            return round(speed, 2)
        speed *= _FASTER
    return None


def _hard_braking_window(layout: Layout, speed: float) -> float:
    """Return the range of distances at which only hard braking suffices, m; negative if there is none."""
    friction = layout.weather.friction
    return distances.too_late_to_stop(speed, friction) - distances.braking(speed, friction)
