"""The courses that a scene gives its actors for the ego that was played, to compare a run with."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving import KinematicWorld
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._roads.corridor import Corridor
from oodscen.interchange._verdicts.plausibility import ASKEW, IN_DEGREES, unusable
from oodscen.protocols import Control, State

Floats = NDArray[np.float64]

_LATEST_START_S = 1.0
"""Time up to which a run may start as it is; others count from their start."""
_NEAR_M, _LAG_S = 1.0, 0.1
"""Distance of a body from its place at the start, m, and the way at an actor's speed allowed beside it, s."""
_SETTLED_STEPS, _SPEED_S = 2, 0.15
"""Steps after which the ego's first speed is measured, and for how long, s: some players move nothing at first."""
_SPEED, _SPEED_SHARE, _EASY = 1.0, 0.1, 5.0
"""By how much that speed may be off: m/s, as a share, and per second since the start, m/s^2."""
_EGO_ACCELERATION = 10.0
"""Acceleration by which the ego may differ from a blind one before the first pose, m/s^2."""
_HIGH_M = 1.5
"""Height above its place from which a body is elsewhere, m."""
_BEFORE_M, _AFTER_M, _OTHERS_M = 2.0, 10.0, 20.0
"""Distance of the hazard from its course before and after the decision, and of other actors from theirs, m: the
reactions of players differ.
"""


def start_of(
    scene: Scene, catalogue: Catalogue, corridor: Corridor, seed: int, time: Floats, poses: Floats
) -> tuple[float, str]:
    """Return the time by which a run is shifted, s, and what is not where the scene starts.

    Args:
        scene: The scene.
        catalogue: Source of sizes.
        corridor: The scene's road.
        seed: Seed of the scene's random streams.
        time: [n] the run's times, s.
        poses: [n, bodies, 4] the poses, in the order of the world.

    Raises:
        DataError: If the headings are degrees.
    """
    begun = float(time[0])
    is_early = 0.0 <= begun <= _LATEST_START_S
    world, driver = KinematicWorld(corridor, scene, catalogue, seed), Cruise()
    first, pace = poses[0], _first_speed(time, poses[:, 0])
    wrong = _misplaced(world, first, pace, 0.0)
    if is_early:
        for _ in range(round(begun / world.dt)):
            world.step(driver.act(world.observe()))
        at_start, wrong = wrong, _misplaced(world, first, pace, begun)
        return (begun, "") if wrong and begun > 0.0 and not at_start else (0.0, wrong)
    return begun, wrong


def _first_speed(time: Floats, ego: Floats) -> tuple[float, float]:
    """Return the ego's speed soon after the start, m/s, and the time since the start, s."""
    begin = min(_SETTLED_STEPS, len(time) - 2)
    end = max(begin + 1, int(np.searchsorted(time, time[begin] + _SPEED_S + 1e-9)) - 1)
    way = np.hypot(*(ego[end, :2] - ego[begin, :2]))
    since = 0.5 * (time[begin] + time[end]) - time[0]
    return float(way / (time[end] - time[begin])), float(since)


def _misplaced(
    world: KinematicWorld, poses: Floats, pace: tuple[float, float], since: float
) -> str:
    """Return the first body that is not in its place, or that the ego is too fast or slow, or an empty text."""
    own, speeds = world.poses(), np.abs(world.speeds())
    allowed = _NEAR_M + _LAG_S * speeds
    allowed[0] = _NEAR_M + 0.5 * _EGO_ACCELERATION * since**2
    apart = np.hypot(*(poses[:, :2] - own[:, :2]).T)
    above = poses[:, 2] - own[:, 2]
    far = np.flatnonzero((apart > allowed) | (above > _HIGH_M))
    if len(far):
        row = far[0]
        distance = max(float(apart[row]), float(above[row]))
        return f"{world.ids[row]} starts {distance:.1f} m from its place in the scene"
    turned = _turn(poses[:, 3] - own[:, 3])
    askew = np.flatnonzero(turned > ASKEW)
    if not len(askew):
        usual, (speed, later) = float(speeds[0]), pace
        is_off = abs(speed - usual) > _SPEED + _SPEED_SHARE * usual + _EASY * (since + later)
        return f"ego starts at {speed:.1f} m/s, not {usual:.1f} m/s" if is_off else ""
    row = askew[0]
    if _turn(np.radians(poses[:, 3]) - own[:, 3]).max() <= ASKEW:
        raise unusable(world.ids[row], IN_DEGREES)
    return f"{world.ids[row]} starts turned by {np.degrees(turned[row]):.0f} degrees"


def _turn(angle: Floats) -> Floats:
    return np.abs((angle + np.pi) % (2.0 * np.pi) - np.pi)


def strayed(
    scene: Scene,
    catalogue: Catalogue,
    corridor: Corridor,
    seed: int,
    states: Sequence[State],
    decision_s: float,
) -> str:
    """Return which actor leaves the course that the scene gives it, or an empty text.

    Actors that start behind the ego may follow it as they like.

    The scene is run beside the played one: its ego is moved to the played poses in every step, and its actors react
    to it.

    Args:
        scene: The scene.
        catalogue: Source of sizes.
        corridor: The scene's road.
        seed: Seed of the scene's random streams.
        states: The states of the run up to the end of what is judged.
        decision_s: Time of the decision, s.
    """
    world, driver = KinematicWorld(corridor, scene, catalogue, seed), Cruise()
    begin = [world.motion(name).s for name in world.ids]
    unusual = {world.ids.index(name) for name in world.ids if name in scene.hazard.actors}
    rows = [row for row, s in enumerate(begin) if row and (s > begin[0] or row in unusual)]
    if not rows:
        return ""
    time = np.array([one.time for one in states])
    poses = np.array([one.poses for one in states])
    speeds = np.array([one.speeds[0] for one in states])
    ego = np.concatenate([poses[:, 0, :3], np.unwrap(poses[:, 0, 3])[:, None]], axis=1)
    own, at = [world.poses()[rows]], [0.0]
    while at[-1] < time[-1]:
        is_played = world.time >= time[0] - 1e-9
        world.step(Control(0.0, 0.0) if is_played else driver.act(world.observe()))
        if world.time >= time[0] - 1e-9:
            now = np.array([np.interp(world.time, time, column) for column in ego.T])
            world.set_pose(0, now, float(np.interp(world.time, time, speeds)))
        own.append(world.poses()[rows])
        at.append(world.time)
    course = np.array(own)
    for index, row in enumerate(rows):
        place = np.stack([np.interp(time, at, column) for column in course[:, index, :3].T], axis=1)
        apart = np.hypot(*(poses[:, row, :2] - place[:, :2]).T)
        above = poses[:, row, 2] - place[:, 2]
        pace = np.abs([one.speeds[row] for one in states])
        near = np.where(time > decision_s, _AFTER_M, _BEFORE_M) if row in unusual else _OTHERS_M
        far = np.flatnonzero((apart > near + _LAG_S * pace) | (above > _BEFORE_M))
        if len(far):
            first = far[0]
            return f"{world.ids[row]} is {max(apart[first], above[first]):.1f} m from its course at {time[first]:g} s"
    return ""
