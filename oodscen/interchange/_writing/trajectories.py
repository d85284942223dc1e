"""Trajectories: the courses of bodies as poses of their reference points."""

import math
from collections.abc import Callable

import numpy as np

from oodscen.driving._roads.corridor import Corridor
from oodscen.interchange._recording import RecordedRun
from oodscen.interchange._writing.elements import Element, attribute_text, child, within
from oodscen.interchange._writing.entities import Entity
from oodscen.numerics._exact import Floats

PositionWriter = Callable[[Element, Floats], None]
"""Completes a `Position` with a pose."""

_EXACT = 2e-5
"""Largest error of a course from which vertices are left out, m and rad."""
_STILL = 1e-9
"""Change in one step up to which a body rests, m and rad."""
_REST_STEPS = 4
"""Shortest rest that parts two phases of a motion, in steps."""
_TURN_M = 2e-5
"""Distance by which a body that turns on the spot moves to and fro: players follow by arc length, m.

It adds to the error of its course.
"""
_TURNING_RAD = 1e-6
"""Turn in one step above which a body turns, rad."""


def reference_poses(run: RecordedRun, row: int, entity: Entity, corridor: Corridor) -> Floats:
    """Return x, y, z, heading and pitch of an entity's reference point: [n, 5].

    The heading is continuous. A vehicle on a slope is pitched about its rear axle such that the centre of
    its box is where the run has it.
    """
    centre = run.poses[:, row]
    poses = np.zeros((len(centre), 5))
    poses[:, :4] = centre
    poses[:, 3] = np.unwrap(centre[:, 3])
    if entity.ahead_m == 0.0:
        return poses
    cos, sin = np.cos(poses[:, 3]), np.sin(poses[:, 3])
    grade = np.zeros(len(poses))
    if np.ptp(corridor.z) > 0.0:
        axle_x, axle_y = centre[:, 0] - entity.ahead_m * cos, centre[:, 1] - entity.ahead_m * sin
        axle_s, _ = corridor.locate_all(axle_x, axle_y)
        centre_z = np.interp(run.places[:, row, 0], corridor.s, corridor.z)
        axle_z = np.interp(axle_s, corridor.s, corridor.z)
        grade = (centre_z - axle_z) / entity.ahead_m
    level = entity.ahead_m / np.sqrt(1.0 + grade * grade)
    poses[:, 0] -= level * cos
    poses[:, 1] -= level * sin
    poses[:, 2] -= level * grade
    poses[:, 4] = -np.arctan(grade)
    return poses


def phases(poses: Floats) -> list[tuple[int, int]]:
    """Return the first and last step of every stretch that moves, parted by rests of several steps."""
    moves = np.abs(np.diff(poses, axis=0)).max(axis=1, initial=0.0) > _STILL
    spans, step = [], 0
    while step < len(moves):
        if not moves[step]:
            step += 1
            continue
        first = step
        while step < len(moves) and moves[step : step + _REST_STEPS].any():
            step += 1
        spans.append((first, step))
    return spans


def vertices(time: Floats, poses: Floats) -> tuple[Floats, Floats]:
    """Return the times and poses of a polyline's vertices.

    Steps that lie on the straight line in space and time between the vertices around them are left out.
    """
    poses = _with_arc_length(poses)
    steps = [0]
    last = len(time) - 1
    while steps[-1] < last:
        steps.append(_next_vertex(time, poses, steps[-1], last))
    return time[steps], poses[steps]


def _next_vertex(time: Floats, poses: Floats, first: int, last: int) -> int:
    """Return the farthest step to which a straight line from `first` is exact, doubling the reach."""
    good, reach = first + 1, 2
    while good < last:
        trial = min(first + reach, last)
        if not _is_straight(time, poses, first, trial):
            break
        good, reach = trial, 2 * reach
    low, high = good, min(first + reach, last)
    while high - low > 1:
        middle = (low + high) // 2
        if _is_straight(time, poses, first, middle):
            low = middle
        else:
            high = middle
    return low


def _is_straight(time: Floats, poses: Floats, first: int, last: int) -> bool:
    share = (time[first : last + 1] - time[first]) / (time[last] - time[first])
    line = poses[first] + share[:, None] * (poses[last] - poses[first])
    return bool(np.abs(line - poses[first : last + 1]).max() <= _EXACT)


def _with_arc_length(poses: Floats) -> Floats:
    """Give some arc length to a body that turns on the spot, alternately forward and back."""
    steps = np.diff(poses, axis=0)
    is_still = np.hypot(steps[:, 0], steps[:, 1]) < 0.5 * _TURN_M
    is_spinning = is_still & (np.abs(steps[:, 3]) > _TURNING_RAD)
    if not is_spinning.any():
        return poses
    poses, sign = poses.copy(), 1.0
    for step in np.flatnonzero(is_spinning) + 1:
        heading = poses[step, 3]
        poses[step, 0] += sign * _TURN_M * math.cos(heading)
        poses[step, 1] += sign * _TURN_M * math.sin(heading)
        sign = -sign
    return poses


def write_trajectory(
    action: Element,
    name: str,
    time: Floats,
    poses: Floats,
    *,
    is_relative: bool = False,
    write_position: PositionWriter | None = None,
) -> None:
    """Append the action that follows a course of reference points, [n, 5].

    Relative times count from the start of the action; the caller gives them so. The positions of vertices are by
    default in the world.
    """
    holder = within(action, "PrivateAction", "RoutingAction", "FollowTrajectoryAction")
    reference = child(holder, "TrajectoryRef")
    trajectory = child(reference, "Trajectory", name=name, closed=False)
    line = within(trajectory, "Shape", "Polyline")
    write = write_position or world_position
    for vertex_time, pose in zip(*vertices(time, poses), strict=True):
        vertex = child(line, "Vertex", time=float(vertex_time))
        write(child(vertex, "Position"), pose)
    domain = "relative" if is_relative else "absolute"
    timing = child(holder, "TimeReference")
    child(timing, "Timing", domainAbsoluteRelative=domain, scale=1.0, offset=0.0)
    child(holder, "TrajectoryFollowingMode", followingMode="position")


def world_position(position: Element, pose: Floats) -> None:
    """Complete a position with a pose in the world."""
    x, y, z, heading, pitch = map(float, pose)
    child(position, "WorldPosition", x=x, y=y, z=z, h=heading, p=pitch, r=0.0)


def own_position(name: str, origin: Floats) -> PositionWriter:
    """Return a writer of positions relative to an entity itself, whose pose is `origin` as its course begins.

    They are along the axes of the entity, which its heading and its pitch turn.
    """
    heading, pitch = float(origin[3]), float(origin[4])
    cos, sin = math.cos(heading), math.sin(heading)
    level, steep = math.cos(pitch), math.sin(pitch)

    def write(position: Element, pose: Floats) -> None:
        x, y, z, turn, tilt = map(float, pose - origin)
        ahead, left = cos * x + sin * y, cos * y - sin * x
        relative = child(
            position,
            "RelativeObjectPosition",
            entityRef=name,
            dx=level * ahead - steep * z,
            dy=left,
            dz=level * z + steep * ahead,
        )
        orientation = child(relative, "Orientation", type="relative", h=turn)
        if tilt != 0.0:
            orientation.set("p", attribute_text(tilt))

    return write
