"""Checks of claims about single actors: their place, distance, motion, state and speed."""

from collections.abc import Mapping, Sequence

import numpy as np

from oodscen.claims._observation import STILL_MPS, ObservedActor
from oodscen.claims._things import words_of
from oodscen.data._claim import Claim

Verdict = tuple[bool | None, str]
"""A verdict on a claim (`None` if it cannot be decided), and a description of the scene."""

_MOVING_MPS = 0.3
"""Speed above which an actor counts as moving."""
_SLOW_SHARE, _SLOW_MPS = 0.7, 5.0
"""Share of the ego's speed, and speed, below either of which an actor counts as slow."""
_REVERSING_MPS = 0.2
"""Speed against its heading above which an actor reverses."""
_BRAKING_SHARE, _BRAKING_MPS = 0.25, 0.8
"""Loss of speed above which an actor brakes: that share of its peak or that much, whichever is more."""
_ACROSS_M = 0.8
"""Lateral movement that counts as crossing."""
_SIDEWAYS_M = 0.3
"""Lateral movement away from a side that counts as coming from there."""
_ASIDE_M = 0.5
"""Lateral distance from the lane's middle beyond which an actor is to the left or right."""
_IN_LANE = 0.3
"""Share of the lane, or of the actor if it is narrower, that an actor in the lane must cover."""
_ACROSS_LANES = 0.5
"""Share of a further lane, or of the actor if it is narrower, that an actor in several lanes must cover."""
_LANE_CHANGE = 0.1
"""Change of the covered share of the lane that counts as entering or leaving it."""
_CLEAR_M = 1.0
"""Half the width that an ego in the middle of its lane needs."""
_DISTANCE_M, _SPEED_KMH, _TOLERANCE = 6.0, 5.0, 0.2
"""Permitted difference from a stated distance or speed: that much or that share of it, whichever is more."""
_COLOURS = frozenset({"red", "amber", "green"})
_POSES_AND_PARTS: Mapping[str, tuple[str, ...]] = {
    "lying": ("collapsed",), "sitting": (), "kneeling": (), "crouching": (), "crawling": (),
    "waving": (), "stopping": ("checkpoint", "traffic_control", "raised"), "pointing": (),
    "pushing": ("pram", "stroller"), "pulling": (), "carrying": (),
    "doors_open": (), "bonnet_open": (), "boot_open": (), "damaged": ("wreck", "crash"), "dirty": (),
}  # fmt: skip
"""Poses of people and states of parts of vehicles, each with further words of the assets that show it."""
_SPREADING = "obscured"
"""Tag of assets that spread out from where they are instead of moving."""


def judge_actor(claim: Claim, actor: ObservedActor, claims: Sequence[Claim]) -> Verdict:
    """Judge a claim about a thing for the actor that shows it.

    Args:
        claim: The claim of the text.
        actor: The actor.
        claims: All claims about the same thing. One that also moves has to be stationary only at the start,
            and one signal of two colours shows all.
    """
    match claim.kind:
        case "place":
            return _judge_place(claim.value, actor)
        case "distance":
            return _judge_distance(float(claim.value), actor)
        case "motion":
            motions = {other.value for other in claims if other.kind == "motion"}
            return _judge_motion(claim.value, actor, moves=bool(motions - {"stationary"}))
        case "state":
            states = {other.value for other in claims if other.kind == "state"}
            return _judge_state(claim.value, actor, states)
        case "speed":
            return _judge_speed(float(claim.value), actor)
    return True, "it is there"


def _judge_place(value: str, actor: ObservedActor) -> Verdict:
    ahead, aside = actor.ahead_m[actor.before], actor.aside_m[actor.before]
    where = (
        f"it is {ahead[0]:.0f} m ahead and {aside[0]:+.1f} m aside (left positive) at first, "
        f"{ahead[-1]:.0f} m and {aside[-1]:+.1f} m at the decision"
    )
    match value:
        case "ahead":
            holds = ahead[0] > 0.0 or ahead[-1] > 0.0
        case "behind":
            holds = ahead[0] < 0.0 or ahead[-1] < 0.0
        case "in_lane":
            holds = (actor.lane_share >= _IN_LANE).any()
        case "clear_of_lane":
            holds = (np.abs(aside) - actor.half_width_m[actor.before] > _CLEAR_M).all()
        case "left":
            holds = (aside > _ASIDE_M).any()
        case "right":
            holds = (aside < -_ASIDE_M).any()
        case _:
            holds = _is_in_other_lane(value, actor)
    return bool(holds), where


def _is_in_other_lane(value: str, actor: ObservedActor) -> bool:
    lane = actor.lane[actor.before]
    is_centred = {
        "left_lane": lane >= 1.0,
        "right_lane": lane <= -1.0,
        "oncoming_lane": lane >= actor.first_oncoming,
    }[value]
    is_across = actor.other_lane_shares[value][actor.before] >= _ACROSS_LANES
    return bool((is_centred | is_across).any())


def _judge_distance(metres: float, actor: ObservedActor) -> Verdict:
    away = np.abs(actor.ahead_m[actor.before])
    gap = actor.gap_m[actor.before]
    difference = min(np.abs(away - metres).min(), np.abs(gap - metres).min())
    found = f"it is {away.max():.0f} to {away.min():.0f} m away until the decision"
    return bool(difference <= max(_DISTANCE_M, _TOLERANCE * metres)), found


def _judge_speed(kmh: float, actor: ObservedActor) -> Verdict:
    speeds = 3.6 * actor.speed_mps
    difference = float(np.abs(speeds - kmh).min())
    found = f"it moves at {speeds.min():.0f} to {speeds.max():.0f} km/h"
    return difference <= max(_SPEED_KMH, _TOLERANCE * kmh), found


def _judge_motion(value: str, actor: ObservedActor, *, moves: bool) -> Verdict:
    """Judge a claim of motion; a thing that also moves is stationary only at the start."""
    speed, along = actor.speed_mps, actor.along_mps
    fastest = float(speed.max())
    found = f"it moves at {speed[0]:.1f} m/s at first and at most at {fastest:.1f} m/s"
    match value:
        case "stationary":
            standing = speed[:1] if moves else speed[actor.before]
            is_still = bool(standing.max() < STILL_MPS)
            return is_still, f"{found}; what stands moves at less than {STILL_MPS:g} m/s"
        case "moving":
            return fastest > _MOVING_MPS, found
        case "slow":
            limit = max(_SLOW_SHARE * actor.ego_speed_mps, _SLOW_MPS)
            at_first = float(speed[actor.before].max())
            moving = at_first if at_first > _MOVING_MPS else fastest
            is_slow = _MOVING_MPS < moving < limit
            return is_slow, f"{found}; slow is less than {limit:.1f} m/s until the decision"
        case "oncoming":
            return bool(along.min() < -_MOVING_MPS), _along_road(float(along.min()))
        case "same_way":
            return bool(along.max() > _MOVING_MPS), _along_road(float(along.max()))
        case "reversing":
            walks_backwards = "backwards" in actor.asset.tags
            forward = -actor.forward_mps if walks_backwards else actor.forward_mps
            slowest = float(forward.min())
            return slowest < -_REVERSING_MPS, f"it moves ahead at {slowest:+.1f} m/s at least"
        case "braking":
            peak = np.maximum.accumulate(speed)
            loss = np.maximum(_BRAKING_SHARE * peak, _BRAKING_MPS)
            return bool((peak - speed > loss).any()), found
    if _SPREADING in actor.asset.tags:
        return None, f"{actor.asset.id} spreads where it is"
    return _judge_sideways_motion(value, actor)


def _along_road(speed_mps: float) -> str:
    return f"it moves along the road at {speed_mps:+.1f} m/s"


def _judge_sideways_motion(value: str, actor: ObservedActor) -> Verdict:
    aside, share = actor.aside_m, actor.lane_share
    width = float(aside.max() - aside.min())
    found = (
        f"it is {aside[0]:+.1f} m aside (left positive) at first, {aside.min():+.1f} to {aside.max():+.1f} m "
        f"in all, {aside[-1]:+.1f} m at last"
    )
    match value:
        case "crossing":
            holds = width > _ACROSS_M
        case "from_left":
            holds = aside[0] > _ASIDE_M and aside[0] - aside.min() > _SIDEWAYS_M
        case "from_right":
            holds = aside[0] < -_ASIDE_M and aside.max() - aside[0] > _SIDEWAYS_M
        case "into_lane":
            lands = actor.is_carried and share.max() >= _IN_LANE
            holds = lands or share.max() - share[0] > _LANE_CHANGE
        case _:
            holds = share.max() - share[-1] > _LANE_CHANGE
    return bool(holds), found


def _judge_state(value: str, actor: ObservedActor, claimed_states: set[str]) -> Verdict:
    if value in _POSES_AND_PARTS:
        return _judge_pose_or_part(value, actor)
    asset, states = actor.asset, actor.asset.states
    if not states:
        return None, f"{asset.id} has no states"
    state = actor.state or states[0]
    found = f"its state is {state!r}"
    if value == "off" and asset.category == "vehicle":
        is_parked = state == "off" and float(actor.speed_mps.max()) < STILL_MPS
        if state == "off" and not is_parked:
            found = f"it moves, and only in the state 'unlit' without lights; {found}"
        return is_parked or state == "unlit", found
    if value in _COLOURS and len(claimed_states & _COLOURS) > 1 and "all_on" in states:
        return state == "all_on", f"{found}; several colours at once are 'all_on'"
    if value not in states:
        return None, f"{asset.id} cannot show {value!r}"
    return state == value, found


def _judge_pose_or_part(value: str, actor: ObservedActor) -> Verdict:
    """Judge a pose of a person, or the state of a vehicle's part, by the words that the asset is known by."""
    asset, offers = actor.asset, actor.asset.offers
    found = f"it is {asset.description}"
    if words_of(asset) & {value, *_POSES_AND_PARTS[value]}:
        return True, found
    if value == "carrying" or offers is None:
        return None, f"{asset.id} cannot show {value!r}"
    able = offers.poses if asset.category == "pedestrian" else offers.parts
    return (False if able else None), found
