"""Checks that played poses can be judged: regular steps, the right units, and motion that bodies can have."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.data._motion import ABILITIES
from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.errors import DataError, Issue
from oodscen.numerics._exact import Floats

_FARTHEST = 1e7
"""Largest place, m, and heading, rad, to either side of zero."""
_LATEST_S = 1e10
"""Largest time to either side of zero, s: clocks may count from 1970."""
_COARSEST_S, _ROUNDED = 0.2, 1.001
"""Largest usual step, s: between coarser ones a contact can go unseen. It may be longer by the rounding of times."""
_HOLE, _SHORTEST_HOLE_S = 2.5, 0.1
"""Length above which a step is a hole, in usual steps and in s."""
_FASTEST = 90.0
"""Largest speed of a body, m/s."""
_JUMP_M, _JUMP = 0.5, 2.0
"""Distance by which a step is a jump, m, beyond this multiple of the way at the speed before or after it."""
_WINDOW_S, _SETTLED_S = 0.2, 0.5
"""Time over which the ego's acceleration is measured, and the time at which measuring begins, s."""
_HARDEST = 30.0
"""Largest acceleration of the ego, m/s^2; a road allows a third of it."""
_MOVES = 2.0
"""Speed above which a motion has a direction, m/s."""
_FASTEST_TURN = np.radians(ABILITIES["car"].spin)
"""Largest rate of turn of a vehicle that moves, rad/s; headings may be off by `ASKEW` besides."""
_SIDEWAYS_S = 0.5
"""Time from which the ego's heading off its motion is noted, s."""
ASKEW = 0.35
"""Largest angle between a heading and the expected one, rad."""
IN_DEGREES = "headings fit the motion as degrees; they are read as radians"
_FEW = 5
"""Number of steps in motion below which headings are not checked."""


def unusable(where: str, message: str) -> DataError:
    """Return the error that refuses a run."""
    return DataError("run of a player", [Issue(where, message)])


def check_bounds(names: Sequence[str], time: Floats, poses: Floats) -> None:
    """Refuse times and poses that no run has; NaN, which stands for a missing body, passes.

    Raises:
        DataError: With the body and the time of the first.
    """
    for at in time[~(np.abs(time) <= _LATEST_S)][:1]:
        raise unusable("time", f"{at:g} s is not within +-{_LATEST_S:g}")
    for step, row, column in np.argwhere(np.abs(poses) > _FARTHEST)[:1]:
        value = f"{'xyzh'[column]} is {poses[step, row, column]:g}"
        message = f"{value} at {time[step]:g} s, which is not within +-{_FARTHEST:g}"
        raise unusable(names[row], message)


def check_steps(time: Floats) -> None:
    """Refuse times with a hole, and steps that are too coarse to see a contact.

    Raises:
        DataError: With the time of the first hole.
    """
    steps = np.diff(time)
    usual = float(np.median(steps))
    if usual > _ROUNDED * _COARSEST_S:
        raise unusable(
            "time",
            f"steps are {usual:g} s, and at most {_COARSEST_S:g} s can be judged; is the time in seconds?",
        )
    holes = np.flatnonzero(steps > max(_HOLE * usual, _SHORTEST_HOLE_S) + ROUNDING_S)
    if len(holes):
        first = holes[0]
        raise unusable(
            "time",
            f"there are no poses from {time[first]:g} s to {time[first + 1]:g} s; steps are {usual:g} s",
        )


def check_motion(names: Sequence[str], time: Floats, poses: Floats, steered: Sequence[int]) -> str:
    """Refuse impossible motion and headings of the ego that do not fit its motion, and return a note on less.

    Args:
        names: The bodies, the ego first.
        time: [n], s.
        poses: [n, bodies, 4] x, y, z and heading, up to the end of what is judged.
        steered: Rows of the bodies that turn by steering; others may turn on the spot.

    Raises:
        DataError: With the body, the time, and the unit that is likely wrong.
    """
    _check_jumps(names, time, poses)
    ego = _mean_motion(time, poses[:, 0])
    _check_ego(time, ego)
    _check_turns([names[row] for row in steered], time, poses[:, steered])
    return _heading_note(time, ego)


def _check_jumps(names: Sequence[str], time: Floats, poses: Floats) -> None:
    steps = np.diff(time)[:, None]
    ways = _ways(poses)
    speeds = ways / steps
    if len(speeds) > 1:
        beside = np.maximum(
            np.concatenate([speeds[1:2], speeds[:-1]]), np.concatenate([speeds[1:], speeds[-2:-1]])
        )
        jumps = np.argwhere(ways > _JUMP_M + _JUMP * beside * steps)
        if len(jumps):
            step, row = jumps[0]
            raise unusable(
                names[row], f"jumps {ways[step, row]:.1f} m from {time[step]:g} s to the next step"
            )
    fast = np.argwhere(speeds > _FASTEST)
    if len(fast):
        step, row = fast[0]
        raise unusable(
            names[row],
            f"moves at {speeds[step, row]:.0f} m/s at {time[step]:g} s; is the time in seconds, and the place in "
            "metres?",
        )


def _check_turns(names: Sequence[str], time: Floats, poses: Floats) -> None:
    steps = np.diff(time)[:, None]
    turns, speeds = turn(np.diff(poses[:, :, 3], axis=0)), _ways(poses) / steps
    sudden = np.argwhere((turns > ASKEW + _FASTEST_TURN * steps) & (speeds > _MOVES))
    for step, row in sudden[:1]:
        raise unusable(
            names[row],
            f"turns by {np.degrees(turns[step, row]):.0f} degrees from {time[step]:g} s to the next step, at "
            f"{speeds[step, row]:.0f} m/s",
        )


def _check_ego(time: Floats, ego: "_MeanMotion") -> None:
    """Check the acceleration and the headings of the ego."""
    width = ego.width
    if len(time) <= 2 * width:
        return
    velocities = ego.velocities
    changes = np.hypot(*(velocities[width:] - velocities[:-width]).T) / ego.spans[width:]
    hard = np.flatnonzero((changes > _HARDEST) & (time[: len(changes)] > time[0] + _SETTLED_S))
    if len(hard):
        at = time[hard[0] + width]
        raise unusable(
            "ego", f"accelerates by {changes[hard[0]]:.0f} m/s^2 at {at:g} s, which no vehicle does"
        )
    if ego.moves.sum() < _FEW:
        return
    way, heading = ego.ways[ego.moves], ego.headings[ego.moves]
    off, in_degrees = _askew(way, heading), _askew(way, np.radians(heading))
    wrong = off > ASKEW
    fits = np.median(in_degrees) < 0.5 * ASKEW
    if wrong.mean() > 0.05 and beyond_a_turn(heading[wrong]) and fits:
        raise unusable("ego", IN_DEGREES)
    if wrong.mean() > 0.5:
        raise unusable(
            "ego",
            f"heads {np.degrees(np.median(off)):.0f} degrees off its motion; headings are in radians, from the x "
            f"axis towards the y axis{'; as degrees they would fit' if fits else ''}",
        )


def _heading_note(time: Floats, ego: "_MeanMotion") -> str:
    """Return a note on the first time for which the ego heads off its motion, or an empty text."""
    off = _askew(ego.ways, ego.headings)
    steps = np.flatnonzero(ego.moves & (off > ASKEW))
    for run in np.split(steps, np.flatnonzero(np.diff(steps) > 1) + 1):
        if len(run) and (lasts := time[run[-1] + ego.width] - time[run[0]]) > _SIDEWAYS_S:
            angle = np.degrees(np.median(off[run]))
            return f"ego heads {angle:.0f} degrees off its motion for {lasts:.2g} s from {time[run[0]]:g} s"
    return ""


class _MeanMotion(NamedTuple):
    """The mean motion of a body over short spans of time, one from each step on."""

    width: int
    """Steps in a span."""
    spans: Floats
    """[n] s"""
    velocities: Floats
    """[n, 2] m/s"""
    headings: Floats
    """[n] rad, in the middle of the span."""

    @property
    def moves(self) -> NDArray[np.bool_]:
        """Return where the motion has a direction: [n]."""
        moves: NDArray[np.bool_] = np.hypot(*self.velocities.T) > _MOVES
        return moves

    @property
    def ways(self) -> Floats:
        """Return the directions of the motion: [n] rad."""
        return np.arctan2(self.velocities[:, 1], self.velocities[:, 0])


def _mean_motion(time: Floats, poses: Floats) -> _MeanMotion:
    width = min(len(time) - 1, max(1, round(_WINDOW_S / float(np.median(np.diff(time))))))
    spans = time[width:] - time[:-width]
    velocities = (poses[width:, :2] - poses[:-width, :2]) / spans[:, None]
    headings = poses[width // 2 : width // 2 + len(velocities), 3]
    return _MeanMotion(width, spans, velocities, headings)


def _askew(way: Floats, heading: Floats) -> Floats:
    """Return the angles between motion and headings, forwards or backwards, rad."""
    return np.abs((way - heading + 0.5 * np.pi) % np.pi - 0.5 * np.pi)


def beyond_a_turn(headings: Floats) -> bool:
    """Return whether some headings are beyond a whole turn, in rad; smaller ones fit many motions as degrees, too."""
    return bool((np.abs(headings) > 2.0 * np.pi + 0.1).any())


def turn(angle: Floats) -> Floats:
    """Return the sizes of angles, at most half a turn, rad."""
    return np.abs((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _ways(poses: Floats) -> Floats:
    """Return how far each body moves in each step, m."""
    ways: Floats = np.linalg.norm(np.diff(poses[:, :, :3], axis=0), axis=2)
    return ways
