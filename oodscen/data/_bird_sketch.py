"""A compact bird's-eye sketch of a decision and the outcome of every action, in road coordinates.

The road is straightened: the origin is the ego's centre at the decision point, x runs forward along
the ego's road and y to its left, both in metres.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from oodscen.data._base import Data

if TYPE_CHECKING:
    from oodscen.driving._trace import Course, Trace

_AHEAD_M, _BEHIND_M, _ASIDE_M = 120.0, 40.0, 30.0
"""Maximum distances of the bodies in the sketch from the ego at the decision point, m."""
_MOVED_M = 0.5
"""Distance along and across the road from which an actor has moved, m."""
_LEAST_WIDTH_M = 0.1
"""Width up to which a strip of the road is left out, m."""


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
    rows = [
        row
        for row in range(len(approach.ids))
        if -_BEHIND_M <= s[row] - s[0] <= _AHEAD_M and abs(t[row] - t[0]) <= _ASIDE_M
    ]
    headings = _headings(course, approach)
    bodies = {
        approach.ids[row]: SketchBody(
            x=_tenth(s[row] - s[0]),
            y=_tenth(t[row] - t[0]),
            heading_deg=float(headings[row]),
            length=_tenth(course.sizes[row, 0]),
            width=_tenth(course.sizes[row, 1]),
        )
        for row in rows
    }
    origin = float(s[0]), float(t[0])
    return Sketch(
        lanes=_lanes(course, *origin),
        bodies=bodies,
        paths={action: _path(trace, *origin) for action, trace in rollouts.items()},
        ends={
            action: _ends(course, trace, rows[1:], *origin) for action, trace in rollouts.items()
        },
    )


def _path(trace: "Trace", s: float, t: float) -> tuple[float, ...]:
    """Return the ego's x, y, x, y ... once a second until it stops, and at the end."""
    time = trace["time"][:, 0]
    stride = max(1, round(1.0 / float(time[1] - time[0]))) if len(time) > 1 else 1
    steps = sorted({*range(0, len(time), stride), len(time) - 1})
    x, y = trace["s"][:, 0] - s, trace["t"][:, 0] - t
    points = dict.fromkeys((_tenth(x[step]), _tenth(y[step])) for step in steps)
    return tuple(value for point in points for value in point)


def _ends(
    course: "Course", trace: "Trace", rows: Sequence[int], s: float, t: float
) -> dict[str, tuple[float, float, float]]:
    """Return the final x, y and heading of the actors in some rows that moved."""
    x, y = trace["s"] - s, trace["t"] - t
    headings = _headings(course, trace)
    return {
        trace.ids[row]: (_tenth(x[-1, row]), _tenth(y[-1, row]), float(headings[row]))
        for row in rows
        if abs(x[-1, row] - x[0, row]) + abs(y[-1, row] - y[0, row]) > _MOVED_M
    }


def _lanes(course: "Course", s: float, t: float) -> tuple[SketchLane, ...]:
    corridor = course.corridor
    index = min(max(round(s / corridor.step), 0), len(corridor.s) - 1)
    return tuple(
        SketchLane(
            kind=strip.kind,
            direction=strip.direction,
            right=_tenth(strip.right[index] - t),
            left=_tenth(strip.left[index] - t),
        )
        for strip in corridor.strips
        if strip.left[index] - strip.right[index] > _LEAST_WIDTH_M
    )


def _headings(course: "Course", trace: "Trace") -> list[int]:
    """Return every body's last heading relative to the road, in whole degrees."""
    corridor = course.corridor
    steps = np.rint(trace["s"][-1] / corridor.step)
    index = np.clip(steps, 0, len(corridor.s) - 1).astype(np.intp)
    road_yaw = np.arctan2(corridor.sin[index], corridor.cos[index])
    degrees = np.rint(np.degrees(trace["yaw"][-1] - road_yaw)) % 360
    return [int(value) - 360 if value > 180 else int(value) for value in degrees]


def _tenth(value: float) -> float:
    """Return a value rounded to a tenth, never -0.0."""
    return round(float(value), 1) + 0.0
