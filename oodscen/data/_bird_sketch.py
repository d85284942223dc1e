"""A compact bird's-eye sketch of a decision and the outcome of every action, in road coordinates.

The road is straightened: the origin is the ego's centre at the decision point, x runs forward along
the ego's road and y to its left, both in metres.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from oodscen.data._base import Data

if TYPE_CHECKING:
    from oodscen.driving._trace import Course, Trace

AHEAD_M, BEHIND_M, ASIDE_M = 120.0, 40.0, 30.0
"""Maximum distances of the bodies in the sketch from the ego at the decision point, m."""
_MOVED_M = 0.5


class SketchLane(Data):
    """One strip of the road at the decision point."""

    kind: str
    """The strip's kind: `driving`, `shoulder`, `sidewalk` ..."""
    direction: int
    """Direction of travel: +1 with the ego, -1 oncoming, 0 neither."""
    right: float
    """y of the right edge, m."""
    left: float


class SketchBody(Data):
    """The footprint of a body at the decision point."""

    x: float
    y: float
    heading_deg: float
    """Heading relative to the road, degrees, counter-clockwise."""
    length: float
    width: float


class Sketch(Data):
    """All nearby bodies at the decision point, and their paths under every action."""

    lanes: tuple[SketchLane, ...] = ()
    """Strips from right to left."""
    bodies: dict[str, SketchBody] = {}
    """Footprints of the ego and nearby actors, by id (`ego` for the ego)."""
    paths: dict[str, tuple[float, ...]] = {}
    """By action: the ego's x, y, x, y ... once a second until it stops, and at the end.
    Unavailable actions are left out."""
    ends: dict[str, dict[str, tuple[float, float, float]]] = {}
    """By action and actor: final x, y and heading in degrees, for actors that moved."""


def sketch(course: "Course", approach: "Trace", rollouts: Mapping[str, "Trace"]) -> Sketch:
    """Return a sketch of the rollouts of a scene's actions.

    Args:
        course: The scene's course.
        approach: The trace up to the decision point.
        rollouts: Traces from the decision point on, by action id.
    """
    s, t = approach["s"][-1], approach["t"][-1]
    angle = _headings(course, approach)
    near = [
        row
        for row in range(len(approach.ids))
        if -BEHIND_M <= s[row] - s[0] <= AHEAD_M and abs(t[row] - t[0]) <= ASIDE_M
    ]
    bodies = {
        approach.ids[row]: SketchBody(
            x=_tenth(s[row] - s[0]),
            y=_tenth(t[row] - t[0]),
            heading_deg=float(angle[row]),
            length=_tenth(course.sizes[row, 0]),
            width=_tenth(course.sizes[row, 1]),
        )
        for row in near
    }
    paths, ends = {}, {}
    for action, trace in rollouts.items():
        x, y = trace["s"] - s[0], trace["t"] - t[0]
        time = trace["time"][:, 0]
        every = max(1, round(1.0 / float(time[1] - time[0]))) if len(time) > 1 else 1
        steps = sorted({*range(0, len(time), every), len(time) - 1})
        places = dict.fromkeys((_tenth(x[i, 0]), _tenth(y[i, 0])) for i in steps)
        paths[action] = tuple(value for place in places for value in place)
        turned = _headings(course, trace)
        ends[action] = {
            trace.ids[row]: (_tenth(x[-1, row]), _tenth(y[-1, row]), float(turned[row]))
            for row in near
            if row and abs(x[-1, row] - x[0, row]) + abs(y[-1, row] - y[0, row]) > _MOVED_M
        }
    return Sketch(
        lanes=_lanes(course, float(s[0]), float(t[0])), bodies=bodies, paths=paths, ends=ends
    )


def _lanes(course: "Course", s: float, t: float) -> tuple[SketchLane, ...]:
    corridor = course.corridor
    at = min(max(round(s / corridor.step), 0), len(corridor.s) - 1)
    return tuple(
        SketchLane(
            kind=strip.kind,
            direction=strip.direction,
            right=_tenth(strip.right[at] - t),
            left=_tenth(strip.left[at] - t),
        )
        for strip in corridor.strips
        if strip.left[at] - strip.right[at] > 0.1
    )


def _headings(course: "Course", trace: "Trace") -> list[int]:
    """Return every body's last heading relative to the road, in whole degrees."""
    corridor = course.corridor
    at = np.clip(np.rint(trace["s"][-1] / corridor.step), 0, len(corridor.s) - 1).astype(np.intp)
    turned = trace["yaw"][-1] - np.arctan2(corridor.sin[at], corridor.cos[at])
    degrees = np.rint(np.degrees(turned)) % 360
    return [int(value) - 360 if value > 180 else int(value) for value in degrees]


def _tenth(value: float) -> float:
    return round(float(value), 1) + 0.0
