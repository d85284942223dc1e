"""The bodies ahead of the ego, as reference drivers perceive them in a simulator's states."""

import math
from typing import NamedTuple

from oodscen.protocols import State

WIDTHS_M = 1.9
"""Assumed sum of the half widths of the ego and a body, m: two cars of 1.9 m."""
LENGTHS_M = 4.7
"""Assumed sum of the half lengths of the ego and a body beyond `CERTAIN_M`, m."""
CERTAIN_M = 50.0
"""Distance within which every solid body has a gap in the state, m."""


class Neighbour(NamedTuple):
    """A body ahead of the ego, in road coordinates."""

    id: str
    gap: float
    """Distance along the road between the ego's front and the body, m; 0 beside the ego."""
    aside: float
    """Offset of its centre from the ego's, m, left positive."""
    place: float
    """Its offset on the road, m, left positive."""
    along: float
    """Its speed along the road, m/s; negative if it comes towards the ego."""
    across: float
    """Its speed across the road, m/s, left positive."""
    acceleration: float
    """Its acceleration along its heading, m/s^2."""

    @property
    def clearance(self) -> float:
        """Distance across the road between the ego's side and the body, m; 0 if it is in the way."""
        return max(0.0, abs(self.aside) - WIDTHS_M)

    @property
    def is_in_the_way(self) -> bool:
        """Return whether the ego would touch the body by driving on parallel to the road."""
        return self.clearance <= 0.0

    def time_to_collision(self, speed: float) -> float:
        """Return the time until the gap closes at a speed of the ego, s; infinite if it does not."""
        closing = speed - self.along
        return self.gap / closing if closing > 0.0 else math.inf


class Perception:
    """Measures speeds along and across the road from consecutive states.

    A state has no sizes: gaps along the road follow from the measured gaps between boxes and an assumed
    width. A body without a gap within `CERTAIN_M` can be driven over or through and is ignored.
    """

    def __init__(self) -> None:
        self._before: State | None = None
        self.across = 0.0
        """The ego's own speed across the road, m/s, left positive."""

    def look(self, state: State, visual_range_m: float = math.inf) -> list[Neighbour]:
        """Return the solid bodies ahead within the visual range, in the state's order.

        Nothing is seen in a state without `places`.
        """
        before, self._before = self._before, state
        if state.places is None:
            return []
        s, t = state.places[:, 0].tolist(), state.places[:, 1].tolist()
        along, across = _speeds(before, state)
        self.across = across[0]
        accelerations = [0.0] * len(s)
        if state.accelerations is not None:
            accelerations = state.accelerations.tolist()
        neighbours = []
        for row in range(1, len(s)):
            distance, gap = s[row] - s[0], float(state.gaps[row])
            is_passable = math.isinf(gap) and distance < CERTAIN_M
            if is_passable or not 0.0 < distance <= visual_range_m:
                continue
            aside = t[row] - t[0]
            neighbours.append(
                Neighbour(
                    id=state.ids[row],
                    gap=_gap_along(distance, aside, gap),
                    aside=aside,
                    place=t[row],
                    along=along[row],
                    across=across[row],
                    acceleration=accelerations[row],
                )
            )
        return neighbours


def _gap_along(distance: float, aside: float, gap: float) -> float:
    """Return the gap along the road to a body, m, from its distance along and across it and the gap between boxes."""
    if math.isinf(gap):
        return distance - LENGTHS_M
    beside = max(0.0, abs(aside) - WIDTHS_M)
    return math.sqrt(max(0.0, gap * gap - beside * beside))


def _speeds(before: State | None, state: State) -> tuple[list[float], list[float]]:
    """Return all speeds along and across the road, from headings in the first state of a drive."""
    assert state.places is not None
    if before is not None and before.places is not None and state.time > before.time:
        speeds_st = (state.places - before.places) / (state.time - before.time)
        return speeds_st[:, 0].tolist(), speeds_st[:, 1].tolist()
    turns = (state.poses[:, 3] - state.poses[0, 3]).tolist()
    speeds = state.speeds.tolist()
    return (
        [speed * math.cos(turn) for speed, turn in zip(speeds, turns, strict=True)],
        [speed * math.sin(turn) for speed, turn in zip(speeds, turns, strict=True)],
    )
