"""Observation of a scene's actors: where each is relative to the ego, and how it moves."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen.claims._watching import decision_s
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._roads.projection import places
from oodscen.driving._trace import Course, Trace

Floats = NDArray[np.float64]

STILL_MPS = 0.5
"""Speed below which an actor counts as standing; gusts and milling about exceed it."""
_ROUNDING_S = 1e-6
"""Time by which the step of the decision may seem to come before it."""
_NARROWEST_M = 1e-6
"""Least width by which a covered part is divided."""


@dataclass(frozen=True, eq=False)
class ObservedActor:
    """The motion of one actor relative to the ego; arrays are [steps]."""

    index: int
    """Index of the actor in the scene."""
    id: str
    asset: Asset
    state: str
    is_hazard: bool
    is_carried: bool
    """True if it belongs to another actor, which carries or tows it at first."""
    before: slice
    """Steps up to the decision."""
    ego_speed_mps: float
    """Speed of the ego at the start."""
    first_oncoming: int
    """Number of lanes to the left of the ego's at which the oncoming lanes begin."""
    ahead_m: Floats
    """Distance along the road from the ego's centre to the actor's."""
    aside_m: Floats
    """Offset from the middle of the ego's lane, positive to the left."""
    half_width_m: Floats
    """Half the width of the footprint across the road."""
    lane: Floats
    """Lanes to the left of the ego's; NaN off the lanes."""
    lane_share: Floats
    """Share of the ego's lane that the actor covers, or of the actor if it is narrower."""
    other_lane_shares: Mapping[str, Floats]
    """The greatest such share of a `left_lane`, a `right_lane` and an `oncoming_lane`."""
    along_mps: Floats
    """Speed along the road."""
    speed_mps: Floats
    """Speed over the ground."""
    forward_mps: Floats
    """Speed along the actor's heading; negative in reverse."""
    gap_m: Floats
    """Gap between the actor's body and the ego's."""

    @property
    def is_traffic(self) -> bool:
        """True if this is an ordinary road user that moves."""
        return not self.is_hazard and float(self.speed_mps.max()) >= STILL_MPS


def observe(scene: Scene, catalogue: Catalogue, trace: Trace) -> list[ObservedActor]:
    """Return one observation per actor, in the scene's order."""
    catalogue = catalogue.for_scene(scene)
    course = Course.of(scene, catalogue)
    corridor, ego_strip = course.corridor, course.corridor.strips[course.strip]
    s, t, yaw = trace["s"], trace["t"], trace["yaw"]
    middle = np.interp(s, corridor.s, 0.5 * (ego_strip.left + ego_strip.right))
    lane_width = np.interp(s, corridor.s, ego_strip.left - ego_strip.right)
    _, _, cos, sin = places(corridor, trace["x"], trace["y"])
    sideways = np.abs(np.sin(yaw) * cos - np.cos(yaw) * sin)
    straight = np.abs(np.cos(yaw) * cos + np.sin(yaw) * sin)
    half_width = 0.5 * (trace["length"] * sideways + trace["width"] * straight)
    along = trace["vx"] * cos + trace["vy"] * sin
    speed = np.sqrt(trace["vx"] ** 2 + trace["vy"] ** 2)
    decision_step = np.searchsorted(trace["time"][:, 0], decision_s(scene, trace) - _ROUNDING_S)
    columns = [trace.ids.index(actor.id) for actor in scene.actors]
    return [
        ObservedActor(
            index=index,
            id=actor.id,
            asset=catalogue.shown(actor),
            state=actor.state,
            is_hazard=actor.id in scene.hazard.actors,
            is_carried=actor.behaviour.other is not None,
            before=slice(0, int(decision_step) + 1),
            ego_speed_mps=scene.ego.speed,
            first_oncoming=len(corridor.ego_lanes) - scene.ego.lane,
            ahead_m=s[:, column] - s[:, 0],
            aside_m=t[:, column] - middle[:, column],
            half_width_m=half_width[:, column],
            lane=trace["lane"][:, column],
            lane_share=_covered_share(
                t[:, column] - middle[:, column],
                half_width[:, column],
                -0.5 * lane_width[:, column],
                0.5 * lane_width[:, column],
            ),
            other_lane_shares=_other_lane_shares(
                corridor, course.strip, s[:, column], t[:, column], half_width[:, column]
            ),
            along_mps=along[:, column],
            speed_mps=speed[:, column],
            forward_mps=trace["speed"][:, column],
            gap_m=trace["gap_m"][:, column],
        )
        for index, (actor, column) in enumerate(zip(scene.actors, columns, strict=True))
    ]


def _covered_share(t: Floats, half_width: Floats, right: Floats, left: Floats) -> Floats:
    """Return the share of a lane between two edges that a footprint covers, or of the footprint if it is narrower."""
    covered = np.minimum(t + half_width, left) - np.maximum(t - half_width, right)
    narrower = np.minimum(left - right, 2.0 * half_width)
    share: Floats = np.maximum(covered, 0.0) / np.maximum(narrower, _NARROWEST_M)
    return share


def _other_lane_shares(
    corridor: Corridor, ego_strip: int, s: Floats, t: Floats, half_width: Floats
) -> dict[str, Floats]:
    """Return the greatest shares of the lanes beside the ego's that a footprint covers, by kind of lane."""
    middle = float(np.mean(corridor.strips[ego_strip].left + corridor.strips[ego_strip].right))
    shares = {kind: np.zeros(len(s)) for kind in ("left_lane", "right_lane", "oncoming_lane")}
    for index, strip in enumerate(corridor.strips):
        if index == ego_strip or strip.kind != "driving":
            continue
        right = np.interp(s, corridor.s, strip.right)
        left = np.interp(s, corridor.s, strip.left)
        share = _covered_share(t, half_width, right, left)
        is_left = float(np.mean(strip.left + strip.right)) > middle
        side = "left_lane" if is_left else "right_lane"
        shares[side] = np.maximum(shares[side], share)
        if strip.direction < 0:
            shares["oncoming_lane"] = np.maximum(shares["oncoming_lane"], share)
    return shares
