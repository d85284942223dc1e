"""Smooth curves through key poses: monotone cubics that never leave the range between two keys."""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple, Self

AHEAD, LEFT, UP, YAW, PITCH, ROLL = range(6)
"""Indices of a pose: metres, then radians."""
_SAMPLES = 8
"""Pieces of a stretch at whose ends speed and curvature are measured."""
_SLOW = 0.3
"""Speed below which a direction of travel means nothing, m per unit."""

_STRAIGHT = 1e-9
"""Product of speed and sideways acceleration up to which a way is straight, m^2/s^3."""

Pose = tuple[float, ...]


class Measures(NamedTuple):
    """Greatest rates over one stretch, per unit of `at`."""

    speed: float
    """Along the ground, m."""
    acceleration: float
    """Along the ground, m per squared unit."""
    climb: float
    """Up or down, m."""
    spin: float
    """About any axis, degrees."""
    radius: float
    """Least radius of the way, m; infinite for a straight one."""


class PoseTrack(NamedTuple):
    """Key poses with the slopes of a cubic between each two."""

    at: tuple[float, ...]
    poses: tuple[Pose, ...]
    slopes: tuple[Pose, ...]

    @classmethod
    def of(
        cls, rows: Sequence[Sequence[float]], ending: str = "stay", *, is_moving: bool = False
    ) -> Self:
        """Return the curve through rows of `at` and six values.

        Slopes are those of the parabola through three keys, limited so that the cubic stays monotone between two
        keys (Fritsch and Carlson, "Monotone piecewise cubic interpolation", 1980). A body starts and ends at
        rest; one that is moving already, repeats or goes on keeps its pace.

        Args:
            rows: `at` and pose of each key, in order.
            ending: `stay`, `repeat` or `go_on`.
            is_moving: True if it moves before the first key.
        """
        at = tuple(row[0] for row in rows)
        poses = tuple(tuple(row[1:]) for row in rows)
        last = len(rows) - 1
        spans = [end - start for start, end in itertools.pairwise(at)]
        columns = []
        for axis in range(6):
            rise = [(poses[k + 1][axis] - poses[k][axis]) / spans[k] for k in range(last)]
            inner = [_slope(rise[k - 1], rise[k], spans[k - 1], spans[k]) for k in range(1, last)]
            ends = [0.0, 0.0]
            if last and ending == "repeat":
                ends = [_slope(rise[-1], rise[0], spans[-1], spans[0])] * 2
            elif last and axis != UP:
                ends = [rise[0] * is_moving, rise[-1] * (ending == "go_on")]
            columns.append([ends[0], *inner, ends[1]] if last else [0.0])
        return cls(at, poses, tuple(zip(*columns, strict=True)))

    @property
    def spans(self) -> tuple[float, ...]:
        """Lengths of the stretches in units of `at`."""
        return tuple(b - a for a, b in itertools.pairwise(self.at))

    def moved(self, index: int) -> float:
        """Return the distance along the ground between two keys, m."""
        start, end = self.poses[index], self.poses[index + 1]
        return math.dist(start[:UP], end[:UP])

    def measure(self, index: int) -> Measures:
        """Return the greatest rates over one stretch."""
        speed = climb = spin = acceleration = 0.0
        radius = math.inf
        for k in range(_SAMPLES + 1):
            rates, bends = self._rates(index, k / _SAMPLES)
            vx, vy = rates[AHEAD], rates[LEFT]
            ax, ay = bends[AHEAD], bends[LEFT]
            pace = math.sqrt(vx * vx + vy * vy)
            speed, climb = max(speed, pace), max(climb, abs(rates[UP]))
            spin = max(spin, *(math.degrees(abs(rates[axis])) for axis in (YAW, PITCH, ROLL)))
            acceleration = max(acceleration, math.sqrt(ax * ax + ay * ay))
            turning = abs(vx * ay - vy * ax)
            if pace > _SLOW and turning > _STRAIGHT:
                radius = min(radius, pace**3 / turning)
        return Measures(speed, acceleration, climb, spin, radius)

    def set_off(self, ease: float) -> tuple[float, int]:
        """Return the greatest acceleration with which a repeated motion gets under way, and its stretch.

        Args:
            ease: Length over which it gathers pace evenly, in units of `at`; it covers half of that.
        """
        greatest = (0.0, 0)
        for k in range(4 * _SAMPLES + 1):
            pace = k / (4 * _SAMPLES)
            at = self.at[0] + 0.5 * ease * pace * pace % (self.at[-1] - self.at[0])
            index = max(i for i in range(len(self.spans)) if self.at[i] <= at)
            rates, bends = self._rates(index, (at - self.at[index]) / self.spans[index])
            parts = [bends[axis] * pace * pace + rates[axis] / ease for axis in (AHEAD, LEFT)]
            greatest = max(greatest, (math.hypot(*parts), index))
        return greatest

    def _rates(self, index: int, share: float) -> tuple[list[float], list[float]]:
        """Return the first and second derivatives at a share of a stretch."""
        span = self.at[index + 1] - self.at[index]
        rates, bends = [], []
        for axis in range(6):
            rise = (self.poses[index + 1][axis] - self.poses[index][axis]) / span
            first, second = self.slopes[index][axis], self.slopes[index + 1][axis]
            c, d = 3.0 * rise - 2.0 * first - second, first + second - 2.0 * rise
            rates.append(first + 2.0 * c * share + 3.0 * d * share * share)
            bends.append((2.0 * c + 6.0 * d * share) / span)
        return rates, bends


def _slope(before: float, after: float, span: float, following: float) -> float:
    """Return the slope at a key between two stretches; 0 at a turning point or a pause."""
    if before * after <= 0.0:
        return 0.0
    mean = (before * following + after * span) / (span + following)
    limit = 3.0 * min(abs(before), abs(after))
    return min(max(mean, -limit), limit)
