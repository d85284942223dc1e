"""Kernels of the kinematic world: the time step, the published state and the driver's observation."""

import math

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.actions import SeenRoad
from oodscen.driving._motion.behaviours.kernels import act, stand_in_world
from oodscen.driving._motion.bodies import GRAVITY, WHEELBASE, Situation, drive_ego
from oodscen.driving._motion.boxes import Shape, box_gap, radius, shape
from oodscen.driving._motion.car_following import curve_speed
from oodscen.driving._motion.tilting import tilted_box
from oodscen.driving._motion.triggers import TIME, fires
from oodscen.driving._roads.track import (
    alignment,
    bend,
    centre,
    curvature,
    drivable_range,
    edges,
    is_drivable,
    locate,
    neighbour,
    point,
    stretch,
)
from oodscen.numerics._exact import atan2, quantised, sincos, wrapped
from oodscen.numerics._kernels import Kernel, Numbers, part

FAR_M = 60.0
"""Distance beyond which a gap counts as infinite, m."""
SUNK_M = 0.08
"""Height above the road up to which what has sunk into it can be driven over, m."""
_SAMPLES = 8
"""Number of places ahead at which the driver looks for a roadside to stop at."""
_REACH = 3.0
"""Distance to either side over which a lane's course is measured, m."""


@Kernel
def advance(w: Situation, count: int, acceleration: float, steering: float) -> None:
    """Move all bodies by one step, after `count` earlier ones.

    The ego's control is its acceleration, m/s^2, and its steering angle, rad.
    """
    time = quantised(count * w.dt)
    see_paths(w)
    before = w.state[0, col.SPEED]
    drive_ego(w, acceleration, steering)
    w.state[0, col.ACCELERATION] = quantised((w.state[0, col.SPEED] - before) / w.dt)
    stand_in_world(w, 0)
    for k in range(w.order.shape[0]):
        act(w, w.order[k], time)
    pull_triggers(w, quantised((count + 1) * w.dt))


@part
def see_paths(w: Situation) -> None:
    """Record all positions and speeds for the other bodies to see."""
    state, paths = w.state, w.paths
    for i in range(state.shape[0]):
        sine, cosine = sincos(state[i, col.HEADING])
        length, width = w.traits[i, col.LENGTH], w.traits[i, col.WIDTH]
        paths[i, col.PATH_S], paths[i, col.PATH_T] = state[i, col.S], state[i, col.T]
        paths[i, col.PATH_SPEED] = state[i, col.SPEED] * cosine
        paths[i, col.PATH_ALONG] = 0.5 * (length * abs(cosine) + width * abs(sine))
        paths[i, col.PATH_ACROSS] = 0.5 * (length * abs(sine) + width * abs(cosine))


@part
def is_pulled(w: Situation, code: int, value: float, row: int, time: float) -> bool:
    """Return whether a trigger measured to a row fires."""
    if code == TIME:
        return fires(code, value, time, 0.0, 0.0, 0.0)
    state = w.state
    return fires(
        code,
        value,
        time,
        state[row, col.S] - state[0, col.S],
        state[0, col.SPEED] * alignment(w.track, state[0, col.S], state[0, col.YAW]),
        state[row, col.SPEED] * alignment(w.track, state[row, col.S], state[row, col.YAW]),
    )


@part
def pull_triggers(w: Situation, time: float) -> None:
    """Record the time at which each actor's trigger first fires."""
    for i in range(1, w.state.shape[0]):
        if w.state[i, col.TRIGGERED] < 0.0 and is_pulled(
            w, w.codes[i, col.TRIGGER], w.traits[i, col.VALUE], w.codes[i, col.MEASURED], time
        ):
            w.state[i, col.TRIGGERED] = time


@Kernel
def publish(w: Situation, poses: Numbers, rows: Numbers, places: Numbers) -> bool:
    """Fill in the published state, and return whether the ego is off the road.

    Args:
        w: The world.
        poses: [n, 4] x, y, z, yaw.
        rows: [4, n] speeds, accelerations, gaps between boxes, and gaps between the circles around the footprints. The
            last two are infinite for the ego; gaps between boxes are also infinite for passable bodies.
        places: [n, 2] s, t.
    """
    state, traits = w.state, w.traits
    x, y, yaw = state[0, col.X], state[0, col.Y], state[0, col.YAW]
    ego = shape(yaw, traits[0, col.LENGTH], traits[0, col.WIDTH])
    own = radius(traits[0, col.LENGTH], traits[0, col.WIDTH])
    for i in range(state.shape[0]):
        _, _, z, _, _ = point(w.track, state[i, col.S], state[i, col.T])
        poses[i, 0], poses[i, 1], poses[i, 3] = state[i, col.X], state[i, col.Y], state[i, col.YAW]
        poses[i, 2] = quantised(z + state[i, col.LIFT])
        rows[0, i], rows[1, i] = state[i, col.SPEED], state[i, col.ACCELERATION]
        places[i, 0], places[i, 1] = state[i, col.S], state[i, col.T]
        rows[2, i] = rows[3, i] = math.inf
        if i == 0:
            continue
        length, width = traits[i, col.LENGTH], traits[i, col.WIDTH]
        dx, dy = state[i, col.X] - x, state[i, col.Y] - y
        apart = math.sqrt(dx * dx + dy * dy) - own - radius(length, width)
        if w.codes[i, col.TILTS] == 1:
            apart -= traits[i, col.HEIGHT] + traits[i, col.PIVOT]
        rows[3, i] = apart
        if apart <= FAR_M and w.codes[i, col.IS_PASSABLE] == 0:
            rows[2, i] = gap_to(w, i, ego)
    return is_off_road(w)


@part
def gap_to(w: Situation, i: int, ego: Shape) -> float:
    """Return the distance between the ego's box, of this shape, and a body's, m."""
    state, traits = w.state, w.traits
    dx, dy = state[i, col.X] - state[0, col.X], state[i, col.Y] - state[0, col.Y]
    other = shape(state[i, col.YAW], traits[i, col.LENGTH], traits[i, col.WIDTH])
    low = state[i, col.LIFT]
    if w.codes[i, col.TILTS] == 1:
        box = tilted_box(w, i)
        if low < 0.0 and box.high < SUNK_M:
            return math.inf
        dx += box.x * other.cos - box.y * other.sin
        dy += box.x * other.sin + box.y * other.cos
        other = Shape(other.cos, other.sin, box.half_length, box.half_width)
        low = box.low
    level = box_gap(dx, dy, ego, other)
    # Heights are relative to the road under both bodies: boxes do not pitch on a slope.
    above = max(0.0, low - traits[0, col.HEIGHT])
    return quantised(math.sqrt(level * level + above * above))


@part
def is_touching(w: Situation) -> bool:
    """Return whether the ego touches a body that cannot be driven over or through."""
    state, traits = w.state, w.traits
    length, width = traits[0, col.LENGTH], traits[0, col.WIDTH]
    ego, own = shape(state[0, col.YAW], length, width), radius(length, width)
    for i in range(1, state.shape[0]):
        if w.codes[i, col.IS_PASSABLE] == 0:
            dx, dy = state[i, col.X] - state[0, col.X], state[i, col.Y] - state[0, col.Y]
            reach = own + radius(traits[i, col.LENGTH], traits[i, col.WIDTH]) + 1e-3
            if w.codes[i, col.TILTS] == 1:
                reach += traits[i, col.HEIGHT] + traits[i, col.PIVOT]
            if dx * dx + dy * dy <= reach * reach and gap_to(w, i, ego) <= 0.0:
                return True
    return False


@part
def is_off_road(w: Situation) -> bool:
    """Return whether any part of the ego's footprint is beside the drivable road."""
    track, s, t = w.track, w.state[0, col.S], w.state[0, col.T]
    length, width = w.traits[0, col.LENGTH], w.traits[0, col.WIDTH]
    across, along = sincos(w.state[0, col.HEADING])
    reach = 0.5 * (length * abs(across) + width * abs(along)) + 0.1
    if abs(bend(track, s)) < 0.02 and is_drivable(track, s, t - reach, t + reach):
        return False
    sine, cosine = sincos(w.state[0, col.YAW])
    low, high = math.inf, -math.inf
    for sweep in range(2):
        for corner in range(4):
            u = 0.5 * length if corner < 2 else -0.5 * length
            v = 0.5 * width if corner % 2 == 0 else -0.5 * width
            x = w.state[0, col.X] + u * cosine - v * sine
            y = w.state[0, col.Y] + u * sine + v * cosine
            there, offset = locate(track, x, y, s)
            if sweep == 0:
                low, high = min(low, offset), max(high, offset)
            elif not is_drivable(track, there, low, high):
                return True
    return False


@Kernel
def look(w: Situation, lane: int) -> SeenRoad:
    """Return the driver's observation; `lane` is the strip in which the ego started."""
    track, s, t = w.track, w.state[0, col.S], w.state[0, col.T]
    middle = centre(track, lane, s)
    here = lane
    for k in range(track.driving.shape[0]):
        right, left = edges(track, track.driving[k], s)
        if right <= t < left:
            here = track.driving[k]
            break
    beside_left, beside_right = neighbour(track, here, s, 1), neighbour(track, here, s, -1)
    _, _, _, cosine, sine = point(track, s, 0.0)
    along = stretch(track, s, t)
    slope, _ = lane_course(w, lane, s)
    preview = s + max(1.0, 0.2 * w.state[0, col.SPEED])
    _, turn = lane_course(w, lane, preview)
    # The room needed to stop, as `plan_action` plans it.
    speed = w.state[0, col.SPEED]
    braking = min(2.5, 0.5 * w.friction * GRAVITY)
    reach = max(12.0, 2.5 * speed, 0.5 * speed * speed / braking)
    roadside = -math.inf
    for k in range(1 if w.track.is_even else _SAMPLES):
        roadside = max(roadside, roadside_at(w, lane, s + reach * k / (_SAMPLES - 1.0)))
    return SeenRoad(
        speed,
        t - middle,
        wrapped(w.state[0, col.YAW] - atan2(sine, cosine) - atan2(slope, along)),
        curvature(track, preview, t) + turn / (along * along),
        math.inf if beside_left < 0 else centre(track, beside_left, s) - middle,
        -math.inf if beside_right < 0 else centre(track, beside_right, s) - middle,
        roadside,
        curve_speed(w, 0, GRAVITY),
        w.friction,
        WHEELBASE,
    )


@part
def lane_course(w: Situation, lane: int, s: float) -> tuple[float, float]:
    """Return the slope and curvature of a lane's centre relative to the reference line."""
    behind, here = centre(w.track, lane, s - _REACH), centre(w.track, lane, s)
    ahead = centre(w.track, lane, s + _REACH)
    return (ahead - behind) / (2.0 * _REACH), (ahead - 2.0 * here + behind) / (_REACH * _REACH)


@part
def roadside_at(w: Situation, lane: int, s: float) -> float:
    """Return the offset from the lane's centre at which the ego is clear of the lanes at `s`, m."""
    track, outer, beside = w.track, lane, lane
    while beside >= 0:
        outer = beside
        beside = neighbour(track, outer, s, -1)
    edge, _ = edges(track, outer, s)
    is_road, low, _ = drivable_range(track, s, centre(track, outer, s))
    verge = low if is_road else edge
    half = 0.5 * w.traits[0, col.WIDTH]
    return max(edge - half - 0.2, verge + half + 0.25) - centre(track, lane, s)
