"""Landmarks of a map at which a scene can be staged: junction, tunnel, bridge, crest and lights."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from oodscen.data._base import Data
from oodscen.data._catalogue import LandmarkKind
from oodscen.numerics._exact import cos

if TYPE_CHECKING:
    from oodscen.driving._roads.corridor import Corridor

_REACH_M = 300.0
"""Largest distance of a listed landmark from the ego's start, m."""
_GAP_M = 15.0
"""Largest gap between the parts of one junction or roundabout, m."""
_CREST_FROM_M = 20.0
"""Distance from the ego's start from which a crest counts, m."""
_LEAST_RISE_M = 2.5
"""Least height of a crest above the road before and behind it, m."""
_FACING_COSINE = -0.7
"""Cosine between the headings of a light and the ego up to which the light applies to the ego."""


class Landmark(Data):
    """A landmark of a map at which a scene can be staged."""

    kind: LandmarkKind
    ahead_m: float
    """Distance from the ego's start along its road, m: to the middle of a junction or roundabout,
    the near end of a tunnel or bridge, the highest point of a crest, or a light that faces the
    ego."""
    length_m: float = 0.0
    left_m: float = 0.0
    """For a traffic light: offset to the left of the rightmost lane's centre, m."""


def landmarks(corridor: "Corridor", traits: tuple[str, ...] = ()) -> tuple[Landmark, ...]:
    """Return the landmarks of a road ahead of the ego's start, in order.

    Args:
        corridor: The road.
        traits: Traits of its map; `roundabout` distinguishes a roundabout from a junction.
    """
    marks = [
        *_junctions(corridor, traits),
        *_structures(corridor),
        *_lights(corridor),
        *_crest(corridor),
    ]
    return tuple(sorted(marks, key=lambda mark: (mark.ahead_m, mark.kind, mark.left_m)))


def _junctions(road: "Corridor", traits: tuple[str, ...]) -> Iterator[Landmark]:
    spans: list[list[float]] = []
    for s in road.s[road.in_junction]:
        ahead = float(s) - road.start
        if spans and ahead - spans[-1][1] <= _GAP_M:
            spans[-1][1] = ahead
        else:
            spans.append([ahead, ahead])
    for begin, end in spans:
        middle = 0.5 * (begin + end)
        if 0.0 < middle <= _REACH_M:
            kind: LandmarkKind = "roundabout" if "roundabout" in traits else "junction"
            yield _landmark(kind, middle, length=end - begin)


def _structures(road: "Corridor") -> Iterator[Landmark]:
    for structure in road.structures:
        ahead = structure.start - road.start
        if abs(ahead) <= _REACH_M and structure.end > road.start:
            yield _landmark(structure.kind, ahead, length=structure.end - structure.start)


def _lights(road: "Corridor") -> Iterator[Landmark]:
    lane = road.ego_lanes[0]
    for signal in road.signals:
        ahead = signal.s - road.start
        if signal.kind != "traffic_light" or not 0.0 < ahead <= _REACH_M:
            continue
        if cos(signal.yaw - road.heading(signal.s)) <= _FACING_COSINE:
            yield _landmark("traffic_light", ahead, left=signal.t - road.centre(lane, signal.s))


def _crest(road: "Corridor") -> Iterator[Landmark]:
    first = int((road.start + _CREST_FROM_M) / road.step)
    last = min(int((road.start + _REACH_M) / road.step), len(road.z) - 1)
    if last - first < 3:
        return
    heights = road.z[first : last + 1]
    top = int(heights.argmax())
    if min(heights[top] - heights[0], heights[top] - heights[-1]) >= _LEAST_RISE_M:
        yield _landmark("crest", float(road.s[first + top]) - road.start)


def _landmark(
    kind: LandmarkKind, ahead: float, *, length: float = 0.0, left: float = 0.0
) -> Landmark:
    return Landmark(
        kind=kind,
        ahead_m=round(float(ahead), 1),
        length_m=round(float(length), 1),
        left_m=round(float(left), 1),
    )
