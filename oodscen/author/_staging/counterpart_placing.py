"""Ordinary counterparts of a hazard, as near in the twin at the decision as the hazard is in the layout."""

from collections.abc import Mapping

from oodscen.author._staging.background_traffic import along
from oodscen.author._staging.layout import Cast, Layout
from oodscen.author._writing.ordinary_road_user import OrdinaryRoadUser
from oodscen.data._scene import Actor, Behaviour, Placement

_HEADWAY_S, _STANDSTILL_M, _FARTHEST_M = 0.9, 8.0, 55.0
"""Gap to a vehicle ahead in an ordinary twin: time, m at standstill, and the most, m."""
_PAVEMENT_M = {True: (-5.0, -4.5), False: (-3.2, -2.7)}
"""Offsets of the pavement from the rightmost lane's centre, with and without a lane for parking, m."""
_LANE_WIDTH_M = 3.5
_WALKING_MPS = 1.2
"""Speed of someone on the pavement, m/s."""
_NEARER_RATIO = 0.5
"""Ratio of the distance of someone on the pavement to the hazard's: people look smaller than most hazards."""
_IN_VIEW_RATIOS = (2.1, 2.4)
"""Least ratios of the distance ahead to the distance aside of someone in the camera's view."""


def placed_counterpart(
    road_user: OrdinaryRoadUser, layout: Layout, hazard: Actor, decision_s: float
) -> dict[str, Actor]:
    """Return the ordinary road user in the place of a hazard, by the hazard's id; empty if the simulator has none."""
    name = "follow_lane" if road_user.is_ahead else "walk_along"
    behaviours = {kind.id for kind in layout.digest.behaviours}
    if name not in behaviours or not layout.assets.keys() >= set(road_user.assets):
        return {}
    gap = _gap_at_decision(hazard, layout, decision_s)
    if road_user.is_ahead:
        least = _least_gap(layout)
        placement = Placement(ahead_m=round(min(max(gap, least), max(_FARTHEST_M, least)), 2))
        behaviour = Behaviour(name=name, parameters={"speed": layout.speed})
    else:
        aside = layout.draw(_PAVEMENT_M["residential" in layout.road.traits])
        in_view = layout.draw(_IN_VIEW_RATIOS) * (_LANE_WIDTH_M * layout.ego_lane - aside)
        ahead = max(_NEARER_RATIO * gap, in_view) + (layout.speed - _WALKING_MPS) * decision_s
        placement = Placement(
            ahead_m=round(ahead, 2), lane=-layout.ego_lane, offset_m=aside, heading_deg=0.0
        )
        behaviour = Behaviour(name=name, parameters={"speed": _WALKING_MPS})
    asset = layout.choose(road_user.assets, ())
    return {hazard.id: Actor(id=hazard.id, asset=asset, placement=placement, behaviour=behaviour)}


def moved_near(
    cast: Cast, layout: Layout, hazard: Actor, decision_s: float
) -> Mapping[str, Actor | None]:
    """Move counterparts that drive ahead in the ego's lane so that the nearest of them is where the hazard is.

    They would have driven away by the decision. Those that are slower than the ego stay where they are, and so do
    those that tow or carry another.
    """
    tied = cast.tied
    row = {
        name: actor
        for name, actor in cast.unusual.items()
        if actor and name not in tied and _is_ahead(actor, layout)
    }
    if not row:
        return cast.unusual
    first = min(row.values(), key=lambda actor: actor.placement.ahead_m)
    gap = max(_gap_at_decision(hazard, layout, decision_s), _least_gap(layout))
    back = min(
        _gap_at_decision(first, layout, decision_s) - gap,
        first.placement.ahead_m - _least_gap(layout),
    )
    if back <= 0.0:
        return cast.unusual
    return {**cast.unusual, **{name: _moved_back(actor, back) for name, actor in row.items()}}


def _is_ahead(actor: Actor, layout: Layout) -> bool:
    """Return whether an actor drives ahead in the ego's lane, no slower than the ego."""
    placement, behaviour = actor.placement, actor.behaviour
    is_in_lane = placement.lane == 0 and abs(placement.heading_deg) < 90.0
    is_driving = behaviour.name == "follow_lane" and behaviour.other is None
    is_ahead = is_in_lane and placement.ahead_m > 0.0
    return is_ahead and is_driving and along(actor) >= layout.speed


def _moved_back(actor: Actor, metres: float) -> Actor:
    ahead_m = round(actor.placement.ahead_m - metres, 2)
    placement = actor.placement.model_copy(update={"ahead_m": ahead_m})
    return actor.model_copy(update={"placement": placement})


def _gap_at_decision(actor: Actor, layout: Layout, decision_s: float) -> float:
    """Return about the distance of an actor from the ego at the decision, m."""
    return actor.placement.ahead_m + (along(actor) - layout.speed) * decision_s


def _least_gap(layout: Layout) -> float:
    """Return the least gap to a vehicle ahead, m."""
    return _HEADWAY_S * layout.speed + _STANDSTILL_M
