"""The layout of a road in words: its cross-section, bends, stop lines and side roads."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from oodscen.driving._roads.corridor import Corridor, LaneStrip

_REACH_M = 300.0
"""Largest distance of a described place from the ego's start, m."""
_BEHIND_M = 150.0
"""Largest distance of an actor behind the ego's start, m."""
_BENT_PER_M = 1.0 / 500.0
"""Curvature above which a road bends, 1/m."""
_SHORTEST_BEND_M = 8.0
"""Length of the shortest bend, m."""
_NARROWEST_M = 0.3
"""Width of the narrowest strip that is named, m."""
_STRIP_NAMES = {
    "sidewalk": "pavement",
    "border": "verge",
    "parking": "parking bays",
    "shoulder": "shoulder",
    "median": "median",
    "rail": "track",
}
_ASIDE_M = 30.0
"""Largest distance of a crossing or stop line from the ego's lane, m."""
_SIDE_M = (20.0, 60.0)
"""Distances from the ego's road between which a side road must run straight away from it, m."""
_STRAIGHT_M = 5.0
"""Largest shift of a straight side road along the ego's road, m."""


def layout(road: "Corridor") -> str:
    """Describe a road in the coordinates of a placement, as one line.

    Offsets are measured from the centre of the rightmost lane in the ego's direction, positive to the left.
    """
    section = _cross_section(road, road.start)
    return "; ".join(
        [
            f"offsets from right to left: {section}",
            *_structures(road, section),
            *_ends(road),
            *_bends(road),
            *_stop_lines_and_crossings(road),
            *_tracks(road),
            *_side_roads(road),
        ]
    )


def _structures(road: "Corridor", usual: str) -> Iterator[str]:
    """Yield the strips inside tunnels and on bridges where they differ from those at the start."""
    for structure in road.structures:
        if structure.end > road.start and structure.start - road.start <= _REACH_M:
            section = _cross_section(road, 0.5 * (structure.start + structure.end))
            if section != usual:
                where = "in" if structure.kind == "tunnel" else "on"
                yield f"{where} the {structure.kind}: {section}"


def _cross_section(road: "Corridor", s: float) -> str:
    """Return the strips at a place along the road, from right to left."""
    index = round(s / road.step)
    zero = road.centre(road.ego_lanes[0], s)
    strips: list[tuple[str, float, float]] = []
    for strip in road.strips:
        right, left = float(strip.right[index]) - zero, float(strip.left[index]) - zero
        if left - right < _NARROWEST_M or strip.kind == "none":
            continue
        if strip.kind == "driving":
            name = "oncoming lane" if strip.direction < 0 else "lane"
        else:
            name = _STRIP_NAMES.get(strip.kind, strip.kind)
            if strips and strips[-1][0] == name:
                _, right, _ = strips.pop()
        strips.append((name, right, left))
    return ", ".join(_strip_words(*strip) for strip in strips)


def _strip_words(name: str, right: float, left: float) -> str:
    words = f"{name} {right:.1f} to {left:.1f}"
    if name.endswith("lane"):
        # Adding zero turns a negative zero into a positive one.
        words += f" (centre {round(0.5 * (right + left), 2) + 0.0:g})"
    return words


def _ends(road: "Corridor") -> Iterator[str]:
    if road.start < _BEHIND_M:
        yield f"begins {road.start:.0f} m behind the ego"
    if road.length - road.start < _REACH_M:
        yield f"ends {road.length - road.start:.0f} m ahead"


def _bends(road: "Corridor") -> Iterator[str]:
    ahead = road.s - road.start
    near = (ahead >= 0.0) & (ahead <= _REACH_M)
    for sign, side in ((1.0, "left"), (-1.0, "right")):
        bent = near & (sign * road.curvature > _BENT_PER_M)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], bent.astype(int), [0]])))
        for first, last in edges.reshape(-1, 2):
            begin, end = float(ahead[first]), float(ahead[last - 1])
            if end - begin >= _SHORTEST_BEND_M:
                radius = 1.0 / float(np.abs(road.curvature[first:last]).max())
                yield f"bends {side} from {begin:.0f} to {end:.0f} m ahead, radius {radius:.0f} m"


def _stop_lines_and_crossings(road: "Corridor") -> Iterator[str]:
    """Yield the stop lines on the ego's side of the road, then the zebra crossings."""
    lane = road.ego_lanes[0]
    for kind, name in (("stop_line", "stop line"), ("crosswalk", "zebra crossing")):
        distances = set()
        for mark in road.crosswalks:
            if mark.kind != kind:
                continue
            x, y = (float(value) for value in mark.points.mean(axis=0))
            s, t = road.locate(x, y)
            right, left = road.extent(s)
            if not right <= t <= left or abs(t - road.centre(lane, s)) > _ASIDE_M:
                continue
            if kind == "stop_line" and _is_for_oncoming(road, s, t):
                continue
            ahead = s - road.start
            if 0.0 < ahead <= _REACH_M:
                distances.add(round(ahead))
        yield from (f"{name} {ahead} m ahead" for ahead in sorted(distances))


def _is_for_oncoming(road: "Corridor", s: float, t: float) -> bool:
    """Return whether a place lies beyond the ego's lanes on the side of oncoming traffic."""
    if road.keeps_left:
        return t < road.edges(road.ego_lanes[0], s)[0]
    return t > road.edges(road.ego_lanes[-1], s)[1]


def _tracks(road: "Corridor") -> Iterator[str]:
    """Yield the railways that cross the ego's road."""
    zero = road.ego_lanes[0]
    for other in road.others:
        track = other.corridor
        if any(strip.kind != "rail" for strip in track.strips):
            continue
        s, t = road.locate_all(track.x, track.y)
        nearest = int(np.abs(t).argmin())
        ahead = float(s[nearest]) - road.start
        if abs(float(t[nearest])) < 1.0 and 0.0 < ahead <= _REACH_M:
            offset = t - road.centre(zero, float(s[nearest]))
            reach = f"{offset.min():.0f} to {offset.max():.0f}"
            yield f"railway track {ahead:.0f} m ahead across the road, offsets {reach}"


class _SideLane(NamedTuple):
    """A lane of a side road, where it runs straight away from the ego's road."""

    ahead_m: float
    """Distance from the ego's start along its road, m."""
    reach_m: float
    """Distance to which it runs straight away from the ego's road, m."""
    heading: float
    """Sign of the lane's direction across the ego's road: 1 to the left, -1 to the right."""


def _side_roads(road: "Corridor") -> Iterator[str]:
    """Yield the lanes of the roads that leave the ego's road at about a right angle."""
    for other in road.others:
        if other.is_connecting:
            continue
        lanes: dict[str, list[str]] = {}
        reach: dict[str, float] = {}
        for strip in other.corridor.strips:
            if strip.kind != "driving" or not strip.direction:
                continue
            for side, sign in (("right", -1.0), ("left", 1.0)):
                lane = _side_lane(road, other.corridor, strip, sign)
                if lane is None:
                    continue
                where = "towards" if lane.heading * sign < 0 else "away from"
                lanes.setdefault(side, []).append(
                    f"lane {where} the ego's road {lane.ahead_m:.1f} m ahead (heading_deg {90 * lane.heading:.0f})"
                )
                reach[side] = max(lane.reach_m, reach.get(side, 0.0))
        for side, texts in lanes.items():
            if len(texts) > 1:
                yield f"side road on the {side}, to {reach[side]:.0f} m aside: {', '.join(texts)}"


def _side_lane(
    road: "Corridor", other: "Corridor", strip: "LaneStrip", sign: float
) -> _SideLane | None:
    """Return a lane of another road on one side of the ego's, or `None` if it does not run straight away there."""
    middle = 0.5 * (strip.right + strip.left)
    x, y = other.x - middle * other.sin, other.y + middle * other.cos
    s, t = road.locate_all(x, y)
    zero = road.ego_lanes[0]
    offset = t - np.array([road.centre(zero, float(place)) for place in s])
    nearest, farthest = _SIDE_M
    is_beside = (sign * offset >= nearest) & (sign * offset <= farthest)
    ahead = s[is_beside] - road.start
    if is_beside.sum() < 3 or float(np.ptp(ahead)) > _STRAIGHT_M:
        return None
    if not 0 < ahead.mean() <= _REACH_M:
        return None
    is_straight = abs(s - road.start - ahead.mean()) <= _STRAIGHT_M
    return _SideLane(
        ahead_m=float(ahead.mean()),
        reach_m=float((sign * offset)[is_straight].max()),
        heading=float(np.sign(np.diff(offset[is_beside]).mean())) * strip.direction,
    )
