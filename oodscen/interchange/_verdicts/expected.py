"""Expected courses of a scene's actors, given how the ego was driven."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from oodscen.driving import KinematicWorld
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.interchange._verdicts.plausibility import (
    ASKEW,
    IN_DEGREES,
    beyond_a_turn,
    turn,
    unusable,
)
from oodscen.numerics._exact import Floats
from oodscen.protocols import Control, State

_LATEST_START_S = 1.0
"""Time up to which a run may start as it is, s; a later one is counted from its start."""
_AT_START_M = 1.0
"""Distance of a body from its place at the start, m."""
_LAG_S = 0.1
"""Time that an actor may be ahead of or behind its course, s."""
_EGO_ACCELERATION_MPS2 = 10.0
"""Acceleration by which the ego may differ from a blind one before the first pose, m/s^2."""
_HIGH_AT_START_M = 1.5
"""Height above its place from which a body is elsewhere at the start, m."""

_SETTLED_STEPS = 2
"""Steps after which the ego's first speed is measured: some players move nothing at first."""
_SPEED_SPAN_S = 0.15
"""Time over which it is measured, s."""
_SPEED_TOLERANCE_MPS = 1.0
"""Tolerance of this speed, m/s; the next two are added."""
_SPEED_TOLERANCE_SHARE = 0.1
"""Further tolerance as a share of the scene's speed."""
_SPEED_TOLERANCE_MPS2 = 5.0
"""Further tolerance per second since the start, m/s^2."""

_HAZARD_BEFORE_M = 2.0
"""Distance of the hazard from its course before the decision, m."""
_HAZARD_AFTER_M = 10.0
"""This distance after the decision, m: the reactions of players differ."""
_OTHERS_M = 20.0
"""Distance of other actors from their courses, m."""
_HIGH_M = 2.0
"""Height above its course from which an actor has left it, m."""


class _Pace(NamedTuple):
    """The ego's speed, m/s, some time after a run's start, s."""

    speed: float
    since_s: float


def start_of(world: KinematicWorld, time: Floats, poses: Floats) -> tuple[float, str]:
    """Return the time by which a run is shifted, s, and the fault of its start, empty without one.

    Args:
        world: The scene at its start, which is changed.
        time: [n] the run's times, s.
        poses: [n, bodies, 4] the poses, in the order of the world.

    Raises:
        DataError: If the headings are degrees.
    """
    begin_s, driver = float(time[0]), Cruise()
    first, pace = poses[0], _first_pace(time, poses[:, 0])
    fault_at_zero = _fault_at_start(world, first, pace, 0.0)
    if not 0.0 <= begin_s <= _LATEST_START_S:
        return begin_s, fault_at_zero
    for _ in range(round(begin_s / world.dt)):
        world.step(driver.act(world.observe()))
    fault_later = _fault_at_start(world, first, pace, begin_s)
    # The bodies stand where the scene starts, not where it would be by then: only the clock is late.
    if fault_later and begin_s > 0.0 and not fault_at_zero:
        return begin_s, ""
    return 0.0, fault_later


def _first_pace(time: Floats, ego: Floats) -> _Pace:
    """Return the ego's speed soon after the start."""
    begin = min(_SETTLED_STEPS, len(time) - 2)
    end = max(begin + 1, int(np.searchsorted(time, time[begin] + _SPEED_SPAN_S + ROUNDING_S)) - 1)
    distance = np.hypot(*(ego[end, :2] - ego[begin, :2]))
    since_s = 0.5 * (time[begin] + time[end]) - time[0]
    return _Pace(float(distance / (time[end] - time[begin])), float(since_s))


def _fault_at_start(world: KinematicWorld, poses: Floats, pace: _Pace, since_s: float) -> str:
    """Return which body is out of place, or that the ego's speed is wrong; empty if all is well.

    The world is the scene at the time of the run's first poses, `since_s` after its start.
    """
    return (
        _misplaced(world, poses, since_s)
        or _askew(world, poses)
        or _wrong_speed(float(abs(world.speeds()[0])), pace, since_s)
    )


def _misplaced(world: KinematicWorld, poses: Floats, since_s: float) -> str:
    """Return the first body that is not in its place, or an empty text."""
    expected = world.poses()
    allowed_m = _AT_START_M + _LAG_S * np.abs(world.speeds())
    allowed_m[0] = _AT_START_M + 0.5 * _EGO_ACCELERATION_MPS2 * since_s**2
    apart_m = np.hypot(*(poses[:, :2] - expected[:, :2]).T)
    above_m = poses[:, 2] - expected[:, 2]
    misplaced = np.flatnonzero((apart_m > allowed_m) | (above_m > _HIGH_AT_START_M))
    if not len(misplaced):
        return ""
    row = misplaced[0]
    distance_m = max(float(apart_m[row]), float(above_m[row]))
    return f"{world.ids[row]} starts {distance_m:.1f} m from its place in the scene"


def _askew(world: KinematicWorld, poses: Floats) -> str:
    """Return the first body that faces another way than in the scene, or an empty text."""
    headings = world.poses()[:, 3]
    angles = turn(poses[:, 3] - headings)
    askew = np.flatnonzero(angles > ASKEW)
    if not len(askew):
        return ""
    row = askew[0]
    fits = turn(np.radians(poses[:, 3]) - headings).max() <= ASKEW
    if fits and beyond_a_turn(poses[:, 3]):
        raise unusable(world.ids[row], IN_DEGREES)
    hint = "; headings are in radians, and as degrees they would fit" if fits else ""
    return f"{world.ids[row]} starts turned by {np.degrees(angles[row]):.0f} degrees{hint}"


def _wrong_speed(expected: float, pace: _Pace, since_s: float) -> str:
    """Return that the ego is not as fast as expected, m/s, or an empty text."""
    tolerance = (
        _SPEED_TOLERANCE_MPS
        + _SPEED_TOLERANCE_SHARE * expected
        + _SPEED_TOLERANCE_MPS2 * (since_s + pace.since_s)
    )
    if abs(pace.speed - expected) <= tolerance:
        return ""
    return f"ego starts at {pace.speed:.1f} m/s, not {expected:.1f} m/s"


def strayed(world: KinematicWorld, states: Sequence[State], decision_s: float) -> str:
    """Return which actor leaves its course in the scene, and where, or an empty text.

    The scene is run beside the played one: its ego is moved to the played poses in every step, and its actors react
    to it. Ordinary actors that start behind the ego may follow it as they like.

    Args:
        world: The scene at its start, which is changed.
        states: The states of the run up to the end of what is judged.
        decision_s: Time of the decision, s.
    """
    hazards = {row for row, name in enumerate(world.ids) if name in world.scene.hazard.actors}
    start_s_m = [world.motion(name).s for name in world.ids]
    rows = [
        row
        for row, s_m in enumerate(start_s_m)
        if row > 0 and (s_m > start_s_m[0] or row in hazards)
    ]
    if not rows:
        return ""
    time = np.array([state.time for state in states])
    poses = np.array([state.poses for state in states])
    courses = _run_beside(world, states, time, poses)
    for row in rows:
        allowed_m = np.full(len(time), _OTHERS_M)
        if row in hazards:
            allowed_m = np.where(time > decision_s, _HAZARD_AFTER_M, _HAZARD_BEFORE_M)
        allowed_m += _LAG_S * np.abs([state.speeds[row] for state in states])
        departure = _first_departure(poses[:, row], courses[:, row], allowed_m)
        if departure is not None:
            step, distance_m = departure
            return f"{world.ids[row]} is {distance_m:.1f} m from its course at {time[step]:g} s"
    return ""


def _run_beside(
    world: KinematicWorld, states: Sequence[State], time: Floats, poses: Floats
) -> Floats:
    """Run a world with the played ego in it, and return its bodies' places at the run's times.

    Before the run begins, its ego is a blind one.

    Returns:
        [n, bodies, 3], m.
    """
    driver = Cruise()
    speeds = np.array([state.speeds[0] for state in states])
    ego = np.concatenate([poses[:, 0, :3], np.unwrap(poses[:, 0, 3])[:, None]], axis=1)
    world_poses, world_times = [world.poses()], [0.0]
    while world_times[-1] < time[-1]:
        has_begun = world.time >= time[0] - ROUNDING_S
        world.step(Control(0.0, 0.0) if has_begun else driver.act(world.observe()))
        if world.time >= time[0] - ROUNDING_S:
            pose = np.array([np.interp(world.time, time, column) for column in ego.T])
            world.set_pose(0, pose, float(np.interp(world.time, time, speeds)))
        world_poses.append(world.poses())
        world_times.append(world.time)
    places = np.array(world_poses)[:, :, :3]
    flat = places.reshape(len(places), -1)
    columns = [np.interp(time, world_times, column) for column in flat.T]
    return np.stack(columns, axis=1).reshape(len(time), *places.shape[1:])


def _first_departure(places: Floats, course: Floats, allowed_m: Floats) -> tuple[int, float] | None:
    """Return the first step in which a body is off its course, and its distance there, m; `None` if there is none.

    `allowed_m` is the distance along the ground that is allowed in each step.
    """
    apart_m = np.hypot(*(places[:, :2] - course[:, :2]).T)
    above_m = places[:, 2] - course[:, 2]
    departed = np.flatnonzero((apart_m > allowed_m) | (above_m > _HIGH_M))
    if not len(departed):
        return None
    step = int(departed[0])
    return step, float(max(apart_m[step], above_m[step]))
