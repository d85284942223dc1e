"""The legs of a route as stretches of one line without jumps."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from oodscen.driving._roads.geometry import piecewise_all
from oodscen.driving._roads.routes import Leg, joint, road_point, road_points
from oodscen.numerics._arrays import interpolated, sincos_each
from oodscen.numerics._exact import Floats, Real

SAMPLE_STEP_M = 0.5
"""Maximum distance between two samples of a line, m."""

_SNAP_M = 1e-3
"""Distance below which two reference lines count as one, m."""
_TIGHTEST = 0.1
"""Minimum share of its length that a line parallel to a bend must keep."""


class LegTrack:
    """One leg's share of a corridor's line: parallel to the road's own line, `shift` m to its left.

    The corridor's line continues without a jump where a road's own line begins beside the end of the previous
    one, so lanes that continue each other keep their offsets from it.

    Raises:
        ValueError: If the leg bends too tightly for the shift.
    """

    def __init__(self, leg: Leg, shift: float) -> None:
        self.leg = leg
        self.shift = shift
        road = leg.road
        self.span = min(road.length, road.curves[-1].s + road.curves[-1].length)
        """Length of the road's own line, m."""
        self._driven, self._nodes = [0.0], [0.0]
        if shift:
            self._measure()
        self.length = self._nodes[-1] if shift else self.span
        """Length of this track, m."""

    def _measure(self) -> None:
        """Record the distances along this track at distances driven along the road's own line."""
        inner = {self._own(curve.s) for curve in self.leg.road.curves}
        ends = sorted({0.0, self.span} | {s for s in inner if 0.0 < s < self.span})
        for begin, end in pairwise(ends):
            steps = max(1, math.ceil((end - begin) / SAMPLE_STEP_M))
            for step in range(steps):
                middle = begin + (end - begin) * (step + 0.5) / steps
                share = 1.0 - self.shift * self._curvature(middle)
                if share < _TIGHTEST:
                    name = self.leg.road.id
                    raise ValueError(f"road {name!r} bends too tightly for the lanes before it")
                self._driven.append(begin + (end - begin) * (step + 1) / steps)
                driven = self._driven[-1] - self._driven[-2]
                self._nodes.append(self._nodes[-1] + share * driven)

    def _own(self, driven: Real) -> Real:
        """Return s on the road's own line at a distance driven along it, m; and the other way round."""
        return driven if self.leg.forward else self.span - driven

    def _curvature(self, driven: float) -> float:
        curvature = road_point(self.leg.road, self._own(driven)).curvature
        return curvature if self.leg.forward else -curvature

    def own(self, along: Floats) -> Floats:
        """Return s on the road's own line at distances along this track, m."""
        if self.shift:
            along = interpolated(along, np.array(self._nodes), np.array(self._driven))
        return self._own(along)

    def from_start(self, own: float) -> float:
        """Return the distance along this track at s on the road's own line, m."""
        driven = self._own(own)
        if not self.shift:
            return driven
        nodes_driven, nodes_along = np.array(self._driven), np.array(self._nodes)
        return float(interpolated(np.array([driven]), nodes_driven, nodes_along)[0])

    def points(self, own: Floats) -> tuple[Floats, ...]:
        """Return x, y, z, cosine and sine of the heading, and curvature at s on the road's own line."""
        road, forward = self.leg
        x, y, heading, curvature = road_points(road, own)
        sign = 1.0 if forward else -1.0
        sine, cosine = sincos_each(heading)
        along, across = sign * cosine, sign * sine
        curvature = sign * curvature
        z = piecewise_all(road.elevation, own)
        if not self.shift:
            return x, y, z, along, across, curvature
        x, y = x - self.shift * across, y + self.shift * along
        return x, y, z, along, across, curvature / (1.0 - self.shift * curvature)


def tracks_of(legs: Sequence[Leg]) -> list[LegTrack]:
    """Return the tracks of a route's legs, each beginning where the one before it ends.

    Raises:
        ValueError: If a bend is too tight to drive.
    """
    tracks: list[LegTrack] = []
    for leg in legs:
        shift = 0.0
        if tracks:
            before = tracks[-1]
            _, across, _ = joint(before.leg, leg)
            shift = before.shift - across
            if abs(shift) < _SNAP_M:
                shift = 0.0
        tracks.append(LegTrack(leg, shift))
    return tracks
