"""The ego's start on a map that names none: a user's own OpenDRIVE file."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from oodscen.driving._roads.network import Network
from oodscen.driving._roads.routes import AHEAD_M, BEHIND_M, Leg, straight_on

_MAX_ROADS = 200
"""Maximum number of roads on which a start is looked for."""
_BEFORE_END_M = 20.0
"""Minimum distance between the start and the end of its road, m."""
_BEHIND_M, _BEHIND_SHARE = 160.0, 0.25
"""Preferred length of the way behind the start, m, and its maximum share of the whole way."""
_LONG_ENOUGH_M = BEHIND_M + 300.0
"""Length of a way beyond which no longer one is looked for, m."""


class Start(NamedTuple):
    """A place on a road where the ego may start."""

    leg: Leg
    driven_m: float
    """Distance from the leg's first point, m."""
    onward: tuple[Leg, ...]
    """The legs after it."""

    @property
    def s(self) -> float:
        """The place along the road's reference line, m."""
        return self.driven_m if self.leg.forward else self.leg.road.length - self.driven_m


def find_start(network: Network) -> Start | None:
    """Return a start on the longest way through a network; `None` without a lane outside junctions."""
    best: Start | None = None
    longest = 0.0
    for legs in _ways(network):
        total = sum(leg.road.length for leg in legs)
        if total > longest and (start := _start_on(legs, min(_BEHIND_M, _BEHIND_SHARE * total))):
            best, longest = start, total
        if longest >= _LONG_ENOUGH_M:
            break
    return best


def _ways(network: Network) -> Iterator[list[Leg]]:
    """Yield the ways straight on from the roads outside junctions, in both directions."""
    for road in list(network.roads.values())[:_MAX_ROADS]:
        for leg in (Leg(road, True), Leg(road, False)):
            if road.junction or not leg.has_lane(1):
                continue
            legs, total = [leg], road.length
            for after in straight_on(network, leg):
                if total >= AHEAD_M:
                    break
                legs.append(after)
                total += after.road.length
            yield legs


def _start_on(legs: Sequence[Leg], at: float) -> Start | None:
    """Return a start on the last usable leg that begins before a distance, m, else on the first after it."""
    start: Start | None = None
    for index, leg in enumerate(legs):
        if not leg.road.junction and leg.has_lane(1):
            latest = max(0.5 * leg.road.length, leg.road.length - _BEFORE_END_M)
            start = Start(leg, min(max(at, 0.0), latest), tuple(legs[index + 1 :]))
        at -= leg.road.length
        if at <= 0.0 and start is not None:
            break
    return start
