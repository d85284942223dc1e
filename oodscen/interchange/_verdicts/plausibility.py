"""Checks that played poses can be judged: regular steps, the right units, and motion that bodies can have."""

from collections.abc import Sequence

import numpy as np

from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.errors import DataError, Issue
from oodscen.numerics._exact import Floats

_COARSEST_S = 0.2
"""Largest usual step, s: between coarser ones a contact can go unseen."""
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
"""Speed above which the ego's motion has a direction, m/s."""
ASKEW = 0.35
"""Largest angle between a heading and the expected one, rad."""
IN_DEGREES = "headings fit the motion as degrees; they are read as radians"
_FEW = 5
"""Number of steps in motion below which headings are not checked."""


def unusable(where: str, message: str) -> DataError:
    """Return the error that refuses a run."""
    return DataError("run of a player", [Issue(where, message)])


def check_steps(time: Floats) -> None:
    """Refuse times with a hole, and steps that are too coarse to see a contact.

    Raises:
        DataError: With the time of the first hole.
    """
    steps = np.diff(time)
    usual = float(np.median(steps))
    if usual > _COARSEST_S:
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


def check_motion(names: Sequence[str], time: Floats, poses: Floats) -> None:
    """Refuse impossible motion, and headings of the ego that do not fit its motion.

    Args:
        names: The bodies, the ego first.
        time: [n], s.
        poses: [n, bodies, 4] x, y, z and heading, up to the end of what is judged.

    Raises:
        DataError: With the body, the time, and the unit that is likely wrong.
    """
    _check_jumps(names, time, poses)
    _check_ego(time, poses[:, 0])


def _check_jumps(names: Sequence[str], time: Floats, poses: Floats) -> None:
    steps = np.diff(time)[:, None]
    ways = np.hypot(*np.moveaxis(np.diff(poses[:, :, :2], axis=0), 2, 0))
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


def _check_ego(time: Floats, poses: Floats) -> None:
    """Check the acceleration and the headings of the ego: [n, 4] poses."""
    width = max(1, round(_WINDOW_S / float(np.median(np.diff(time)))))
    if len(time) <= 2 * width:
        return
    spans = time[width:] - time[:-width]
    velocities = (poses[width:, :2] - poses[:-width, :2]) / spans[:, None]
    changes = np.hypot(*(velocities[width:] - velocities[:-width]).T) / spans[width:]
    hard = np.flatnonzero((changes > _HARDEST) & (time[: len(changes)] > time[0] + _SETTLED_S))
    if len(hard):
        at = time[hard[0] + width]
        raise unusable(
            "ego", f"accelerates by {changes[hard[0]]:.0f} m/s^2 at {at:g} s, which no vehicle does"
        )
    moves = np.hypot(*velocities.T) > _MOVES
    if moves.sum() < _FEW:
        return
    way = np.arctan2(velocities[:, 1], velocities[:, 0])[moves]
    heading = poses[width // 2 : width // 2 + len(velocities), 3][moves]
    off, in_degrees = _askew(way, heading), _askew(way, np.radians(heading))
    wrong = off > ASKEW
    beyond = np.abs(heading[wrong]) > np.pi + 0.1
    if wrong.mean() > 0.05 and beyond.any() and np.median(in_degrees) < 0.5 * ASKEW:
        raise unusable("ego", IN_DEGREES)
    if wrong.mean() > 0.5:
        fits = np.median(in_degrees) < 0.5 * ASKEW
        raise unusable(
            "ego",
            f"heads {np.degrees(np.median(off)):.0f} degrees off its motion; headings are in radians, from the x "
            f"axis towards the y axis{'; as degrees they would fit' if fits else ''}",
        )


def _askew(way: Floats, heading: Floats) -> Floats:
    """Return the angles between motion and headings, forwards or backwards, rad."""
    return np.abs((way - heading + 0.5 * np.pi) % np.pi - 0.5 * np.pi)
