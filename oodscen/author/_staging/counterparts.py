"""Ordinary counterparts of a hazard, as near in the twin at the decision as the hazard is in the scene."""

from collections.abc import Mapping, Sequence

from oodscen.author._staging.actors import SceneDraftState
from oodscen.author._staging.background_traffic import along
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


def replaced(
    one: StandIn, scene: SceneDraftState, hazard: Actor, decision_s: float
) -> dict[str, Actor]:
    """Return the ordinary road user in the place of a hazard, by that one's id."""
    does = "follow_lane" if one.is_ahead else "walk_along"
    can = {kind.id for kind in scene.digest.behaviours}
    if does not in can or not set(one.assets) <= {asset.id for asset in scene.digest.assets}:
        return {}
    gap = _gap(hazard, scene, decision_s)
    if one.is_ahead:
        near = _near(scene)
        place = Placement(ahead_m=round(min(max(gap, near), max(_FARTHEST_M, near)), 2))
        behaviour = Behaviour(name=does, parameters={"speed": scene.speed})
    else:
        aside = scene.draw(_PAVEMENT_M["residential" in scene.road.traits])
        least = scene.draw(_IN_VIEW) * (_LANE_M * scene.ego_lane - aside)
        ahead = max(_NEARER * gap, least) + (scene.speed - _WALKING) * decision_s
        place = Placement(
            ahead_m=round(ahead, 2), lane=-scene.ego_lane, offset_m=aside, heading_deg=0.0
        )
        behaviour = Behaviour(name=does, parameters={"speed": _WALKING})
    asset = scene.choose(one.assets, ())
    return {hazard.id: Actor(id=hazard.id, asset=asset, placement=place, behaviour=behaviour)}


def drawn_near(
    unusual: Mapping[str, Actor | None],
    scene: SceneDraftState,
    actors: Sequence[Actor],
    hazard: Actor,
    decision_s: float,
) -> dict[str, Actor | None]:
    """Move counterparts that drive ahead in the ego's lane so that the nearest of them is where the hazard is.

    They would have driven away by the decision. Those that are slower than the ego stay where they are, and so do
    those that tow or carry another.
    """
    tied = {one.behaviour.other for one in (*actors, *unusual.values()) if one}
    row = {
        name: one
        for name, one in unusual.items()
        if one and name not in tied and _is_ahead(one, scene)
    }
    if not row:
        return dict(unusual)
    first = min(row.values(), key=lambda one: one.placement.ahead_m)
    wanted = max(_gap(hazard, scene, decision_s), _near(scene))
    back = min(_gap(first, scene, decision_s) - wanted, first.placement.ahead_m - _near(scene))
    if back <= 0.0:
        return dict(unusual)
    return {**unusual, **{name: _moved_back(one, back) for name, one in row.items()}}


def _is_ahead(one: Actor, scene: SceneDraftState) -> bool:
    """Return whether an actor drives ahead in the ego's lane, no slower than the ego."""
    place, does = one.placement, one.behaviour
    is_with_ego = place.lane == 0 and abs(place.heading_deg) < 90.0 and place.ahead_m > 0.0
    is_driving = does.name == "follow_lane" and does.other is None
    return is_with_ego and is_driving and along(one) >= scene.speed


def _moved_back(one: Actor, metres: float) -> Actor:
    place = one.placement
    there = place.model_copy(update={"ahead_m": round(place.ahead_m - metres, 2)})
    return one.model_copy(update={"placement": there})


def _gap(one: Actor, scene: SceneDraftState, decision_s: float) -> float:
    """Return about the distance of an actor from the ego at the decision, m."""
    return one.placement.ahead_m + (along(one) - scene.speed) * decision_s


def _near(scene: SceneDraftState) -> float:
    """Return the least gap to a vehicle ahead, m."""
    return _HEADWAY_S * scene.speed + _STANDSTILL_M
