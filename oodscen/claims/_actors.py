"""Checks of claims about single actors: their place, distance, motion and state."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from oodscen.claims._things import words_of
from oodscen.claims._watching import decision_s
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._claim import Claim
from oodscen.data._scene import Scene
from oodscen.driving._roads.projection import places
from oodscen.driving._trace import Course, Trace

if TYPE_CHECKING:
    from oodscen.driving._roads.corridor import Corridor

Floats = NDArray[np.float64]
Verdict = tuple[bool | None, str]
"""A verdict on a claim (`None` if it cannot be decided), and a description of the scene."""

_STILL = 0.5
"""Speed below which an actor counts as standing, m/s; gusts and milling about exceed it."""
_MOVES = 0.3
"""Speed above which an actor counts as moving, m/s."""
_SLOW, _SLOW_MPS = 0.7, 5.0
"""Share of the ego's speed, and speed in m/s, below either of which an actor counts as slow."""
_ACROSS_M = 0.8
"""Lateral movement that counts as crossing, m."""
_ASIDE_M = 0.5
"""Lateral distance from the lane's middle beyond which an actor is to the left or right, m."""
_IN_LANE = 0.3
"""Share of the lane, or of the actor if it is narrower, that an actor in the lane must cover."""
_ACROSS_LANES = 0.5
"""Share of a further lane, or of the actor if it is narrower, that an actor in several lanes must cover."""
_COLOURS = frozenset({"red", "amber", "green"})
_DETAILS: Mapping[str, tuple[str, ...]] = {
    "lying": ("collapsed",), "sitting": (), "kneeling": (), "crouching": (), "crawling": (),
    "waving": (), "stopping": ("checkpoint", "traffic_control", "raised"), "pointing": (),
    "pushing": ("pram", "stroller"), "pulling": (), "carrying": (),
    "doors_open": (), "bonnet_open": (), "boot_open": (), "damaged": ("wreck", "crash"), "dirty": (),
}  # fmt: skip
"""Poses of people and states of parts of vehicles, each with further words of the assets that show it."""
_SPREADS = frozenset({"obscured"})
"""Tags of assets that spread out from where they are instead of moving."""
_CLEAR_M = 1.0
"""Half the width that an ego in the middle of its lane needs, m."""
_BEFORE_S = 1e-6
"""Time before the decision from which a step counts as it, s."""
_LEAST_M = 1e-6
"""Least width by which a covered part is divided, m."""


@dataclass(frozen=True, eq=False)
class ObservedActor:
    """The motion of one actor relative to the ego; arrays are [steps]."""

    actor: int
    """Index of the actor in the scene."""
    id: str
    asset: Asset
    state: str
    is_hazard: bool
    is_carried: bool
    """True if it belongs to another actor, which carries or tows it at first."""
    before: slice
    """Steps up to the decision."""
    ego_speed: float
    """Speed of the ego at the start, m/s."""
    own_lanes: int
    """Number of lanes to the left of the ego's at which the oncoming lanes begin."""
    time: Floats
    ahead: Floats
    """Distance along the road from the ego's centre to the actor's, m."""
    aside: Floats
    """Offset from the middle of the ego's lane, positive to the left, m."""
    half_width: Floats
    """Half the width of the footprint across the road, m."""
    lane_width: Floats
    """Width of the ego's lane, m."""
    lane: Floats
    """Lanes to the left of the ego's; NaN off the lanes."""
    covered: Mapping[str, Floats]
    """Greatest share of a `left_lane`, `right_lane` or `oncoming_lane` that the actor covers, as in `share`."""
    along: Floats
    """Speed along the road, m/s."""
    speed: Floats
    """Speed over the ground, m/s."""
    gear: Floats
    """Speed along the actor's heading, m/s; negative in reverse."""
    gap: Floats
    """Gap between the actor's body and the ego's, m."""

    @classmethod
    def of(cls, scene: Scene, catalogue: Catalogue, trace: Trace) -> list[Self]:
        """Return one record per actor, in the scene's order."""
        catalogue = catalogue.for_scene(scene)
        course = Course.of(scene, catalogue)
        corridor, strip = course.corridor, course.corridor.strips[course.strip]
        rows = [trace.ids.index(actor.id) for actor in scene.actors]
        s, time = trace["s"], trace["time"][:, 0]
        middle = np.interp(s, corridor.s, 0.5 * (strip.left + strip.right))
        width = np.interp(s, corridor.s, strip.left - strip.right)
        _, _, cos, sin = places(corridor, trace["x"], trace["y"])
        yaw = trace["yaw"]
        askew = np.abs(np.sin(yaw) * cos - np.cos(yaw) * sin)
        straight = np.abs(np.cos(yaw) * cos + np.sin(yaw) * sin)
        across = 0.5 * (trace["length"] * askew + trace["width"] * straight)
        along = trace["vx"] * cos + trace["vy"] * sin
        speed = np.sqrt(trace["vx"] ** 2 + trace["vy"] ** 2)
        decision = int(np.searchsorted(time, decision_s(scene, trace) - _BEFORE_S)) + 1
        own = len(corridor.ego_lanes) - scene.ego.lane
        return [
            cls(
                actor=number,
                id=actor.id,
                asset=catalogue.shown(actor),
                state=actor.state,
                is_hazard=actor.id in scene.hazard.actors,
                is_carried=actor.behaviour.other is not None,
                before=slice(0, decision),
                ego_speed=scene.ego.speed,
                own_lanes=own,
                time=time,
                ahead=s[:, row] - s[:, 0],
                aside=trace["t"][:, row] - middle[:, row],
                half_width=across[:, row],
                lane_width=width[:, row],
                lane=trace["lane"][:, row],
                covered=_covered(
                    corridor, course.strip, s[:, row], trace["t"][:, row], across[:, row]
                ),
                along=along[:, row],
                speed=speed[:, row],
                gear=trace["speed"][:, row],
                gap=trace["gap_m"][:, row],
            )
            for number, (actor, row) in enumerate(zip(scene.actors, rows, strict=True))
        ]

    @property
    def is_traffic(self) -> bool:
        """Return whether this is an ordinary road user that moves."""
        return not self.is_hazard and float(self.speed.max()) >= _STILL

    @property
    def share(self) -> Floats:
        """Return the share of the ego's lane that the actor covers, or of the actor if it is narrower."""
        half = 0.5 * self.lane_width
        low = np.maximum(self.aside - self.half_width, -half)
        high = np.minimum(self.aside + self.half_width, half)
        least = np.minimum(self.lane_width, 2.0 * self.half_width)
        taken: Floats = np.maximum(high - low, 0.0) / np.maximum(least, _LEAST_M)
        return taken

    def judge(self, claim: Claim, claims: Sequence[Claim] = ()) -> Verdict:
        """Judge a claim of kind place, distance, motion, state or speed about this actor.

        Args:
            claim: The claim of the text.
            claims: All claims about the same thing. One that also moves has to be stationary only at the start,
                and one signal of two colours shows all.
        """
        if claim.kind == "place":
            return self._place(claim.value)
        if claim.kind == "distance":
            return self._distance(float(claim.value))
        if claim.kind == "motion":
            moves = any(one.kind == "motion" and one.value != "stationary" for one in claims)
            return self._motion(claim.value, moves)
        if claim.kind == "state":
            return self._state(claim.value, {one.value for one in claims if one.kind == "state"})
        if claim.kind == "speed":
            return self._speed(float(claim.value))
        return True, "it is there"

    def _place(self, value: str) -> Verdict:
        ahead, aside, lane = self.ahead[self.before], self.aside[self.before], self.lane
        where = (
            f"it is {ahead[0]:.0f} m ahead and {aside[0]:+.1f} m aside (left positive) at first, "
            f"{ahead[-1]:.0f} m and {aside[-1]:+.1f} m at the decision"
        )
        if value == "ahead":
            return bool(ahead[0] > 0.0 or ahead[-1] > 0.0), where
        if value == "behind":
            return bool(ahead[0] < 0.0 or ahead[-1] < 0.0), where
        if value == "in_lane":
            return bool((self.share >= _IN_LANE).any()), where
        if value == "clear_of_lane":
            room = np.abs(aside) - self.half_width[self.before]
            return bool((room > _CLEAR_M).all()), where
        if value in ("left", "right"):
            sign = 1.0 if value == "left" else -1.0
            return bool((sign * aside > _ASIDE_M).any()), where
        known = lane[self.before]
        is_centred = {
            "left_lane": known >= 1.0,
            "right_lane": known <= -1.0,
            "oncoming_lane": known >= self.own_lanes,
        }[value]
        is_across = self.covered[value][self.before] >= _ACROSS_LANES
        return bool((is_centred | is_across).any()), where

    def _distance(self, metres: float) -> Verdict:
        away = np.abs(self.ahead[self.before])
        gap = self.gap[self.before]
        near = min(np.abs(away - metres).min(), np.abs(gap - metres).min())
        found = f"it is {away.max():.0f} to {away.min():.0f} m away until the decision"
        return bool(near <= max(6.0, 0.2 * metres)), found

    def _motion(self, value: str, moves: bool) -> Verdict:
        speed, along, aside = self.speed, self.along, self.aside
        fastest = float(speed.max())
        found = f"it moves at {speed[0]:.1f} m/s at first and at most at {fastest:.1f} m/s"
        if value == "stationary":
            is_still = bool((speed[:1] if moves else speed[self.before]).max() < _STILL)
            return is_still, f"{found}; what stands moves at less than {_STILL:g} m/s"
        if value == "moving":
            return fastest > _MOVES, found
        if value == "slow":
            limit = max(_SLOW * self.ego_speed, _SLOW_MPS)
            is_slow = float(speed[self.before].max()) < limit and fastest > _MOVES
            return is_slow, f"{found}; slow is less than {limit:.1f} m/s until the decision"
        if value == "oncoming":
            return bool(along.min() < -_MOVES), f"it moves along the road at {along.min():+.1f} m/s"
        if value == "same_way":
            return bool(along.max() > _MOVES), f"it moves along the road at {along.max():+.1f} m/s"
        if value == "reversing":
            turned = -1.0 if "backwards" in self.asset.tags else 1.0
            return bool((turned * self.gear).min() < -0.2), "it does not move backwards"
        if value == "braking":
            peak = np.maximum.accumulate(speed)
            return bool((peak - speed > np.maximum(0.25 * peak, 0.8)).any()), found
        if _SPREADS & set(self.asset.tags):
            return None, f"{self.asset.id} spreads where it is"
        sway = float(aside.max() - aside.min())
        swayed = f"it moves {sway:.1f} m to the side, from {aside[0]:+.1f} to {aside[-1]:+.1f} m"
        if value == "crossing":
            return sway > _ACROSS_M, swayed
        if value in ("from_left", "from_right"):
            sign = 1.0 if value == "from_left" else -1.0
            start = sign * aside[0]
            return bool(start > _ASIDE_M and (start - sign * aside).max() > 0.3), swayed
        share = self.share
        if value == "into_lane":
            lands = self.is_carried and share.max() >= _IN_LANE
            return bool(lands or share.max() - share[0] > 0.1), swayed
        return bool(share.max() - share[-1] > 0.1), swayed

    def _speed(self, kmh: float) -> Verdict:
        speeds = 3.6 * self.speed
        near = float(np.abs(speeds - kmh).min())
        found = f"it moves at {speeds.min():.0f} to {speeds.max():.0f} km/h"
        return near <= max(5.0, 0.2 * kmh), found

    def _state(self, value: str, states_told: set[str]) -> Verdict:
        if value in _DETAILS:
            return self._detail(value)
        states = self.asset.states
        if not states:
            return None, f"{self.asset.id} has no states"
        found = f"its state is {self.state or states[0]!r}"
        if value == "off" and self.asset.category == "vehicle":
            stands_dark = self.state in ("", "off") and float(self.speed.max()) < _STILL
            return self.state == "unlit" or stands_dark, found
        if value in _COLOURS and len(states_told & _COLOURS) > 1 and "all_on" in states:
            return self.state == "all_on", f"{found}; several colours at once are 'all_on'"
        if value not in states:
            return None, f"{self.asset.id} cannot show {value!r}"
        return (self.state or states[0]) == value, found

    def _detail(self, value: str) -> Verdict:
        """Judge a pose of a person, or the state of a vehicle's part, by the words that the asset is known by."""
        asset, offers = self.asset, self.asset.offers
        found = f"it is {asset.description}"
        if words_of(asset) & {value, *_DETAILS[value]}:
            return True, found
        if value == "carrying" or offers is None:
            return None, f"{asset.id} cannot show {value!r}"
        able = offers.poses if asset.category == "pedestrian" else offers.parts
        return (False if able else None), found


def _covered(
    corridor: "Corridor", own: int, s: Floats, t: Floats, half_width: Floats
) -> dict[str, Floats]:
    """Return the greatest shares of the lanes beside the ego's that a footprint covers, by kind of lane."""
    middle = float(np.mean(corridor.strips[own].left + corridor.strips[own].right))
    shares = {name: np.zeros(len(s)) for name in ("left_lane", "right_lane", "oncoming_lane")}
    for number, strip in enumerate(corridor.strips):
        if number == own or strip.kind != "driving":
            continue
        left = np.interp(s, corridor.s, strip.left)
        right = np.interp(s, corridor.s, strip.right)
        taken = np.minimum(t + half_width, left) - np.maximum(t - half_width, right)
        share = np.maximum(taken, 0.0) / np.maximum(
            np.minimum(left - right, 2.0 * half_width), _LEAST_M
        )
        is_left = float(np.mean(strip.left + strip.right)) > middle
        kinds = ["left_lane" if is_left else "right_lane"]
        kinds += ["oncoming_lane"] if strip.direction < 0 else []
        for kind in kinds:
            shares[kind] = np.maximum(shares[kind], share)
    return shares
