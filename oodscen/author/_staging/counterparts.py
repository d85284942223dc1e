"""Ordinary counterparts of a hazard, as near in the twin at the decision as the hazard is in the layout."""

from collections.abc import Mapping

from oodscen.author._staging.background_traffic import along
from oodscen.author._staging.layout import Cast, Layout
from oodscen.author._writing.stand_in import StandIn
from oodscen.data._scene import Actor, Behaviour, Placement

_HEADWAY_S, _STANDSTILL_M, _FARTHEST_M = 0.9, 8.0, 55.0
"""Gap to a vehicle ahead in an ordinary twin: time, m at standstill, and the most, m."""
_PAVEMENT_M = {True: (-5.0, -4.5), False: (-3.2, -2.7)}
"""Offsets of the pavement from the rightmost lane's centre, with and without a lane for parking, m."""
_LANE_M = 3.5
_WALKING = 1.2
"""Speed of someone on the pavement, m/s."""
_NEARER = 0.5
"""Ratio of the distance of someone on the pavement to the hazard's: people look smaller than most hazards."""
_IN_VIEW = (2.1, 2.4)
"""Least ratios of the distance ahead to the distance aside of someone in the camera's view."""


def replaced(one: StandIn, layout: Layout, hazard: Actor, decision_s: float) -> dict[str, Actor]:
    """Return the ordinary road user in the place of a hazard, by that one's id."""
    does = "follow_lane" if one.is_ahead else "walk_along"
    can = {kind.id for kind in layout.digest.behaviours}
    if does not in can or not layout.assets.keys() >= set(one.assets):
        return {}
    gap = _gap(hazard, layout, decision_s)
    if one.is_ahead:
        near = _near(layout)
        place = Placement(ahead_m=round(min(max(gap, near), max(_FARTHEST_M, near)), 2))
        behaviour = Behaviour(name=does, parameters={"speed": layout.speed})
    else:
        aside = layout.draw(_PAVEMENT_M["residential" in layout.road.traits])
        least = layout.draw(_IN_VIEW) * (_LANE_M * layout.ego_lane - aside)
        ahead = max(_NEARER * gap, least) + (layout.speed - _WALKING) * decision_s
        place = Placement(
            ahead_m=round(ahead, 2), lane=-layout.ego_lane, offset_m=aside, heading_deg=0.0
        )
        behaviour = Behaviour(name=does, parameters={"speed": _WALKING})
    asset = layout.choose(one.assets, ())
    return {hazard.id: Actor(id=hazard.id, asset=asset, placement=place, behaviour=behaviour)}


def drawn_near(
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
    wanted = max(_gap(hazard, layout, decision_s), _near(layout))
    back = min(_gap(first, layout, decision_s) - wanted, first.placement.ahead_m - _near(layout))
    if back <= 0.0:
        return cast.unusual
    return {**cast.unusual, **{name: _moved_back(actor, back) for name, actor in row.items()}}


def _is_ahead(one: Actor, layout: Layout) -> bool:
    """Return whether an actor drives ahead in the ego's lane, no slower than the ego."""
    place, does = one.placement, one.behaviour
    is_with_ego = place.lane == 0 and abs(place.heading_deg) < 90.0 and place.ahead_m > 0.0
    is_driving = does.name == "follow_lane" and does.other is None
    return is_with_ego and is_driving and along(one) >= layout.speed


def _moved_back(one: Actor, metres: float) -> Actor:
    place = one.placement
    there = place.model_copy(update={"ahead_m": round(place.ahead_m - metres, 2)})
    return one.model_copy(update={"placement": there})


def _gap(one: Actor, layout: Layout, decision_s: float) -> float:
    """Return about the distance of an actor from the ego at the decision, m."""
    return one.placement.ahead_m + (along(one) - layout.speed) * decision_s


def _near(layout: Layout) -> float:
    """Return the least gap to a vehicle ahead, m."""
    return _HEADWAY_S * layout.speed + _STANDSTILL_M
