"""Car following: what a driver sees ahead, and the accelerations that follow from it.

Every kernel takes the world `w` and the row `i` of the actor that moves or looks.
"""

import math

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._motion.lane_keeping import (
    accelerate,
    grip,
    keep_lane,
)
from oodscen.numerics._kernels import part

_CLEARANCE = 0.2
"""Clearance beside its own path within which a driver counts a body as in its way, m."""
_COMFORT = 0.6
"""Share of the grip that drivers use in curves."""
_SAMPLES = 10
"""Number of places ahead at which a driver looks for curves."""
_MOST, _COMFORTABLE, _HEADWAY, _STANDSTILL = 1.8, 2.5, 1.2, 2.0
"""Intelligent driver model: maximum acceleration and comfortable braking, m/s^2; headway, s; standstill gap, m."""


@part
def free_road(w: Situation, i: int, slowest: float) -> tuple[float, float]:
    """Return the gap to the body ahead in an actor's path, m, and the speed at which that body moves away, m/s.

    The gap is infinite if nothing is ahead or nothing is visible: no driver sees beyond the visual range
    of fog, rain and snow, and at night bodies without lamps are visible only in the headlamp beam.
    Bodies that move away more slowly than `slowest`, m/s, are ignored.
    """
    paths, direction = w.paths, w.codes[i, col.DIRECTION]
    s, t = paths[i, col.PATH_S], paths[i, col.PATH_T]
    best, away = math.inf, 0.0
    for j in range(paths.shape[0]):
        ahead = (paths[j, col.PATH_S] - s) * direction
        if ahead <= 0.0 or j == i or w.codes[j, col.IS_PASSABLE] == 1:
            continue
        room = paths[j, col.PATH_ACROSS] + paths[i, col.PATH_ACROSS] + _CLEARANCE
        if abs(paths[j, col.PATH_T] - t) >= room:
            continue
        gap = ahead - paths[j, col.PATH_ALONG] - paths[i, col.PATH_ALONG]
        speed = paths[j, col.PATH_SPEED] * direction
        reach = w.visual_range if w.codes[j, col.IS_LIT] == 1 else w.headlamp_range
        if gap < best and gap <= reach and speed >= slowest:
            best, away = gap, speed
    return best, away


@part
def curve_speed(w: Situation, i: int, grip: float) -> float:
    """Return the highest current speed that still allows for the curves ahead at a grip, m/s^2."""
    along = _COMFORT * grip
    braking = min(_COMFORTABLE, 0.5 * grip)
    speed, rows, step = w.state[i, col.SPEED], w.track.samples, w.track.step
    s, t = w.state[i, col.S], w.state[i, col.T]
    reach = 0.5 * speed * speed / braking + 10.0
    square, last = 1e6, rows.shape[0] - 1
    for k in range(_SAMPLES):
        ahead = reach * k / (_SAMPLES - 1.0)
        position = (s + w.codes[i, col.DIRECTION] * ahead) / step
        turn = rows[min(max(int(position + 0.5), 0), last), 5]
        if abs(turn) > 1e-5:
            turn = abs(turn / max(0.2, 1.0 - turn * t))
            square = min(square, along / turn + 2.0 * braking * max(0.0, ahead - 5.0))
    return math.sqrt(square)


@part
def idm_acceleration(w: Situation, i: int, desired: float, headway: float, slowest: float) -> float:
    """Return the acceleration of the intelligent driver model (Treiber et al. 2000), m/s^2.

    On slippery roads, comfortable braking uses half of the grip.
    """
    most, comfortable = _MOST, min(_COMFORTABLE, 0.5 * grip(w))
    if desired <= 0.0:
        return -comfortable
    speed = w.state[i, col.SPEED]
    gap, leader = free_road(w, i, slowest)
    ratio = speed / desired
    acceleration = most * (1.0 - ratio * ratio * ratio * ratio)
    if speed > desired:
        acceleration = max(acceleration, -comfortable)
    if gap < math.inf:
        closing = speed - leader
        wanted = _STANDSTILL + max(
            0.0, speed * headway + speed * closing / (2.0 * math.sqrt(most * comfortable))
        )
        ratio = wanted / max(gap, 0.1)
        acceleration -= most * ratio * ratio
    return max(acceleration, -grip(w))


@part
def desired_speed(w: Situation, i: int) -> float:
    """Return the behaviour's speed, or less if the curves ahead require it, m/s."""
    return min(w.traits[i, col.GOAL], curve_speed(w, i, grip(w)))


@part
def change_lane(
    w: Situation, i: int, blend: float, shift: float, headway: float, slowest: float
) -> None:
    """Drive in the lane at the behaviour's speed, reacting to traffic ahead."""
    acceleration = idm_acceleration(w, i, desired_speed(w, i), headway, slowest)
    keep_lane(w, i, accelerate(w, i, acceleration), blend, shift)


@part
def cruise(w: Situation, i: int, shift: float) -> None:
    """Drive in its own lane at the usual headway, with an offset to the left, m."""
    change_lane(w, i, 0.0, shift, _HEADWAY, -math.inf)
