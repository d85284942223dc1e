"""The layout of a road in words: its cross-section, bends, stop lines and side roads."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from oodscen.driving._roads.corridor import Corridor

_REACH_M = 300.0
"""Largest distance of a described place from the ego's start, m."""
_BEHIND_M = 150.0
"""Largest distance of an actor behind the ego's start, m."""
_BENT = 1.0 / 500.0
"""Curvature from which a road bends, 1/m."""
_SHORTEST_M = 8.0
"""Shortest bend, m."""
_NAMES = {
    "sidewalk": "pavement",
    "border": "verge",
    "parking": "parking bays",
    "shoulder": "shoulder",
    "median": "median",
    "rail": "track",
}
_SIDE_M = (20.0, 60.0)
"""Distances from the ego's road between which a side road must run straight away from it, m."""


def layout(road: "Corridor") -> str:
    """Describe a road in the coordinates of a placement, as one line.

    Offsets are measured from the centre of the rightmost lane in the ego's direction, positive to the left.
    """
    section = _section(road, road.start)
    parts = [f"offsets from right to left: {section}", *_structures(road, section)]
    parts += [*_ends(road), *_bends(road), *_stop_lines(road), *_tracks(road), *_sides(road)]
    return "; ".join(parts)


def _structures(road: "Corridor", usual: str) -> Iterator[str]:
    """Yield the strips inside tunnels and on bridges where they differ from those at the start."""
    for structure in road.structures:
        if structure.end > road.start and structure.start - road.start <= _REACH_M:
            section = _section(road, 0.5 * (structure.start + structure.end))
            if section != usual:
                where = "in" if structure.kind == "tunnel" else "on"
                yield f"{where} the {structure.kind}: {section}"


def _section(road: "Corridor", s: float) -> str:
    """Return the strips at a place along the road, from right to left."""
    at = round(s / road.step)
    zero = road.centre(road.ego_lanes[0], s)
    strips: list[tuple[str, float, float]] = []
    for strip in road.strips:
        right, left = float(strip.right[at]) - zero, float(strip.left[at]) - zero
        if left - right < 0.3 or strip.kind == "none":
            continue
        name = _NAMES.get(strip.kind, strip.kind)
        if strip.kind == "driving":
            name = "oncoming lane" if strip.direction < 0 else "lane"
        elif strips and strips[-1][0] == name:
            right = strips.pop()[1]
        strips.append((name, right, left))
    told = [
        f"{name} {right:.1f} to {left:.1f}"
        + (f" (centre {round(0.5 * (right + left), 2) + 0.0:g})" if name.endswith("lane") else "")
        for name, right, left in strips
    ]
    return ", ".join(told)


def _ends(road: "Corridor") -> Iterator[str]:
    if road.start < _BEHIND_M:
        yield f"begins {road.start:.0f} m behind the ego"
    if road.length - road.start < _REACH_M:
        yield f"ends {road.length - road.start:.0f} m ahead"


def _bends(road: "Corridor") -> Iterator[str]:
    ahead = road.s - road.start
    near = (ahead >= 0.0) & (ahead <= _REACH_M)
    for sign, side in ((1.0, "left"), (-1.0, "right")):
        bent = near & (sign * road.curvature > _BENT)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], bent.astype(int), [0]])))
        for first, last in edges.reshape(-1, 2):
            begin, end = float(ahead[first]), float(ahead[last - 1])
            if end - begin >= _SHORTEST_M:
                radius = 1.0 / float(np.abs(road.curvature[first:last]).max())
                yield f"bends {side} from {begin:.0f} to {end:.0f} m ahead, radius {radius:.0f} m"


def _stop_lines(road: "Corridor") -> Iterator[str]:
    lane = road.ego_lanes[0]
    for kind, name in (("stop_line", "stop line"), ("crosswalk", "zebra crossing")):
        found = set()
        for mark in road.crosswalks:
            if mark.kind != kind:
                continue
            x, y = (float(value) for value in mark.points.mean(axis=0))
            s, t = road.locate(x, y)
            right, left = road.extent(s)
            own = t <= road.edges(road.ego_lanes[-1], s)[1] if kind == "stop_line" else True
            ahead = s - road.start
            is_beside = not right <= t <= left or abs(t - road.centre(lane, s)) > 30.0
            if own and not is_beside and 0.0 < ahead <= _REACH_M:
                found.add(round(ahead))
        yield from (f"{name} {ahead} m ahead" for ahead in sorted(found))


def _tracks(road: "Corridor") -> Iterator[str]:
    """Yield the railways that cross the ego's road."""
    zero = road.ego_lanes[0]
    for other in road.others:
        track = other.corridor
        if all(strip.kind == "rail" for strip in track.strips):
            s, t = road.locate_all(track.x, track.y)
            nearest = int(np.abs(t).argmin())
            ahead = float(s[nearest]) - road.start
            if abs(float(t[nearest])) < 1.0 and 0.0 < ahead <= _REACH_M:
                offset = t - road.centre(zero, float(s[nearest]))
                reach = f"{offset.min():.0f} to {offset.max():.0f}"
                yield f"railway track {ahead:.0f} m ahead across the road, offsets {reach}"


def _sides(road: "Corridor") -> Iterator[str]:
    """Yield the lanes of the roads that leave the ego's road at about a right angle."""
    zero = road.ego_lanes[0]
    for other in road.others:
        if other.is_connecting:
            continue
        lanes: dict[str, list[str]] = {}
        reach: dict[str, float] = {}
        for strip in other.corridor.strips:
            if strip.kind != "driving" or not strip.direction:
                continue
            middle = 0.5 * (strip.right + strip.left)
            x = other.corridor.x - middle * other.corridor.sin
            y = other.corridor.y + middle * other.corridor.cos
            s, t = road.locate_all(x, y)
            offset = t - np.array([road.centre(zero, float(one)) for one in s])
            for side, sign in (("right", -1.0), ("left", 1.0)):
                low, high = _SIDE_M
                part = (sign * offset >= low) & (sign * offset <= high)
                ahead = s[part] - road.start
                if part.sum() < 3 or float(np.ptp(ahead)) > 5.0 or not 0 < ahead.mean() <= _REACH_M:
                    continue
                way = float(np.sign(np.diff(offset[part]).mean())) * strip.direction
                where = "towards" if way * sign < 0 else "away from"
                text = f"lane {where} the ego's road {ahead.mean():.1f} m ahead (heading_deg {90 * way:.0f})"
                lanes.setdefault(side, []).append(text)
                straight = abs(s - road.start - ahead.mean()) <= 5.0
                far = float((sign * offset)[straight].max())
                reach[side] = max(far, reach.get(side, 0.0))
        for side, told in lanes.items():
            if len(told) > 1:
                yield f"side road on the {side}, to {reach[side]:.0f} m aside: {', '.join(told)}"
