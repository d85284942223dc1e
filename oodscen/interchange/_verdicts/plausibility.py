"""Checks that played poses can be judged: regular steps, the right units, and motion that bodies can have."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.data._designs.motion import ABILITIES
from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.errors import DataError, Issue
from oodscen.numerics._exact import Floats

_MAX_COORDINATE = 1e7
"""Largest place, m, and heading, rad, to either side of zero."""
_MAX_TIME_S = 1e10
"""Largest time to either side of zero, s: clocks may count from 1970."""
_MAX_STEP_S, _ROUNDING_SHARE = 0.2, 1.001
"""Largest usual step, s: between coarser ones a contact can go unseen. It may be longer by the rounding of times."""
_HOLE_STEPS, _SHORTEST_HOLE_S = 2.5, 0.1
"""Length above which a step is a hole, in usual steps and in s."""
_MAX_SPEED_MPS = 90.0
_JUMP_M, _JUMP_SHARE = 0.5, 2.0
"""Distance by which a step is a jump, m, beyond this multiple of the way at the speed before or after it."""
_WINDOW_S, _SETTLED_S = 0.2, 0.5
"""Time over which the ego's acceleration is measured, and the time at which measuring begins, s."""
_MAX_ACCELERATION_MPS2 = 30.0
"""Largest acceleration of the ego, m/s^2; a road allows a third of it."""
_MOVING_MPS = 2.0
"""Speed above which a motion has a direction, m/s."""
_MAX_TURN_RATE = np.radians(ABILITIES["car"].spin)
"""Largest rate of turn of a vehicle that moves, rad/s; headings may be off by `ASKEW` besides."""
_SIDEWAYS_S = 0.5
"""Time from which the ego's heading off its motion is noted, s."""
ASKEW = 0.35
"""Largest angle between a heading and the expected one, rad."""
IN_DEGREES = "headings fit the motion as degrees; they are read as radians"
_MIN_MOVING_STEPS = 5
"""Number of steps in motion below which headings are not checked."""
_MAX_ASKEW_SHARE = 0.5
"""Share of steps with headings off the motion up to which a run is judged."""
_DEGREES_SHARE = 0.05
"""Share of such steps above which headings beyond half a turn are taken for degrees."""


def unusable(where: str, message: str) -> DataError:
    """Return the error that refuses a run."""
    return DataError("run of a player", [Issue(where, message)])


def check_bounds(names: Sequence[str], time: Floats, poses: Floats) -> None:
    """Refuse times and poses that no run has; NaN, which stands for a missing body, passes.

    Raises:
        DataError: With the body and the time of the first.
    """
    times_beyond = time[~(np.abs(time) <= _MAX_TIME_S)]
    if len(times_beyond):
        raise unusable("time", f"{times_beyond[0]:g} s is not within +-{_MAX_TIME_S:g}")
    poses_beyond = np.argwhere(np.abs(poses) > _MAX_COORDINATE)
    if len(poses_beyond):
        step, row, column = poses_beyond[0]
        value = f"{'xyzh'[column]} is {poses[step, row, column]:g}"
        message = f"{value} at {time[step]:g} s, which is not within +-{_MAX_COORDINATE:g}"
        raise unusable(names[row], message)


def check_steps(time: Floats) -> None:
    """Refuse times with a hole, and steps that are too coarse to see a contact.

    Raises:
        DataError: With the time of the first hole.
    """
    steps = np.diff(time)
    usual = float(np.median(steps))
    if usual > _ROUNDING_SHARE * _MAX_STEP_S:
        raise unusable(
            "time",
            f"steps are {usual:g} s, and at most {_MAX_STEP_S:g} s can be judged; is the time in seconds?",
        )
    holes = np.flatnonzero(steps > max(_HOLE_STEPS * usual, _SHORTEST_HOLE_S) + ROUNDING_S)
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
    if len(time) > 2 * ego.width:
        _check_ego_acceleration(time, ego)
        _check_ego_headings(ego)
    _check_turns([names[row] for row in steered], time, poses[:, steered])
    return _heading_note(time, ego)


def _check_jumps(names: Sequence[str], time: Floats, poses: Floats) -> None:
    durations_s = np.diff(time)[:, None]
    lengths_m = _step_lengths_m(poses)
    speeds = lengths_m / durations_s
    if len(speeds) > 1:
        before = np.concatenate([speeds[1:2], speeds[:-1]])
        after = np.concatenate([speeds[1:], speeds[-2:-1]])
        allowed_m = _JUMP_M + _JUMP_SHARE * np.maximum(before, after) * durations_s
        jumps = np.argwhere(lengths_m > allowed_m)
        if len(jumps):
            step, row = jumps[0]
            raise unusable(
                names[row],
                f"jumps {lengths_m[step, row]:.1f} m from {time[step]:g} s to the next step",
            )
    fast = np.argwhere(speeds > _MAX_SPEED_MPS)
    if len(fast):
        step, row = fast[0]
        raise unusable(
            names[row],
            f"moves at {speeds[step, row]:.0f} m/s at {time[step]:g} s; is the time in seconds, and the place in "
            "metres?",
        )


def _check_turns(names: Sequence[str], time: Floats, poses: Floats) -> None:
    durations_s = np.diff(time)[:, None]
    turns = turn(np.diff(poses[:, :, 3], axis=0))
    speeds = _step_lengths_m(poses) / durations_s
    is_sudden = (turns > ASKEW + _MAX_TURN_RATE * durations_s) & (speeds > _MOVING_MPS)
    sudden = np.argwhere(is_sudden)
    if len(sudden):
        step, row = sudden[0]
        raise unusable(
            names[row],
            f"turns by {np.degrees(turns[step, row]):.0f} degrees from {time[step]:g} s to the next step, at "
            f"{speeds[step, row]:.0f} m/s",
        )


def _check_ego_acceleration(time: Floats, ego: "_MeanMotion") -> None:
    width, velocities = ego.width, ego.velocities
    changes = np.hypot(*(velocities[width:] - velocities[:-width]).T) / ego.spans_s[width:]
    is_settled = time[: len(changes)] > time[0] + _SETTLED_S
    hard = np.flatnonzero((changes > _MAX_ACCELERATION_MPS2) & is_settled)
    if len(hard):
        first = hard[0]
        raise unusable(
            "ego",
            f"accelerates by {changes[first]:.0f} m/s^2 at {time[first + width]:g} s, which no vehicle does",
        )


def _check_ego_headings(ego: "_MeanMotion") -> None:
    if ego.is_moving.sum() < _MIN_MOVING_STEPS:
        return
    directions, headings = ego.directions[ego.is_moving], ego.headings[ego.is_moving]
    angles = _angles_off(directions, headings)
    fits_as_degrees = np.median(_angles_off(directions, np.radians(headings))) < 0.5 * ASKEW
    is_askew = angles > ASKEW
    is_beyond = beyond_a_turn(headings[is_askew])
    if is_askew.mean() > _DEGREES_SHARE and is_beyond and fits_as_degrees:
        raise unusable("ego", IN_DEGREES)
    if is_askew.mean() > _MAX_ASKEW_SHARE:
        hint = "; as degrees they would fit" if fits_as_degrees else ""
        raise unusable(
            "ego",
            f"heads {np.degrees(np.median(angles)):.0f} degrees off its motion; headings are in radians, from the x "
            f"axis towards the y axis{hint}",
        )


def _heading_note(time: Floats, ego: "_MeanMotion") -> str:
    """Return a note on the first time for which the ego heads off its motion, or an empty text."""
    angles = _angles_off(ego.directions, ego.headings)
    steps = np.flatnonzero(ego.is_moving & (angles > ASKEW))
    for run in np.split(steps, np.flatnonzero(np.diff(steps) > 1) + 1):
        if not len(run):
            continue
        begin_s = time[run[0]]
        duration_s = time[run[-1] + ego.width] - begin_s
        if duration_s > _SIDEWAYS_S:
            angle_deg = np.degrees(np.median(angles[run]))
            return f"ego heads {angle_deg:.0f} degrees off its motion for {duration_s:.2g} s from {begin_s:g} s"
    return ""


class _MeanMotion(NamedTuple):
    """The mean motion of a body over short spans of time, one from each step on."""

    width: int
    """Steps in a span."""
    spans_s: Floats
    """[n] durations of the spans, s."""
    velocities: Floats
    """[n, 2] m/s"""
    headings: Floats
    """[n] rad, in the middle of the span."""

    @property
    def is_moving(self) -> NDArray[np.bool_]:
        """Return where the motion has a direction: [n]."""
        is_moving: NDArray[np.bool_] = np.hypot(*self.velocities.T) > _MOVING_MPS
        return is_moving

    @property
    def directions(self) -> Floats:
        """Return the directions of the motion: [n] rad."""
        return np.arctan2(self.velocities[:, 1], self.velocities[:, 0])


def _mean_motion(time: Floats, poses: Floats) -> _MeanMotion:
    usual_step_s = float(np.median(np.diff(time)))
    width = min(len(time) - 1, max(1, round(_WINDOW_S / usual_step_s)))
    spans_s = time[width:] - time[:-width]
    velocities = (poses[width:, :2] - poses[:-width, :2]) / spans_s[:, None]
    headings = poses[width // 2 : width // 2 + len(velocities), 3]
    return _MeanMotion(width, spans_s, velocities, headings)


def _angles_off(directions: Floats, headings: Floats) -> Floats:
    """Return the angles between motion and headings, forwards or backwards, rad."""
    return np.abs((directions - headings + 0.5 * np.pi) % np.pi - 0.5 * np.pi)


def beyond_a_turn(headings: Floats) -> bool:
    """Return whether some headings are beyond a whole turn, in rad; smaller ones fit many motions as degrees, too."""
    return bool((np.abs(headings) > 2.0 * np.pi + 0.1).any())


def turn(angle: Floats) -> Floats:
    """Return the sizes of angles, at most half a turn, rad."""
    return np.abs((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _step_lengths_m(poses: Floats) -> Floats:
    """Return how far each body moves in each step, m."""
    lengths_m: Floats = np.linalg.norm(np.diff(poses[:, :, :3], axis=0), axis=2)
    return lengths_m
