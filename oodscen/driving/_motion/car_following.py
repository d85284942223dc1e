"""Car following and lane keeping: the building blocks of behaviours.

Every kernel takes the world `w` and the row `i` of the actor that moves or looks.
"""

import math

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import GRAVITY, Situation
from oodscen.driving._roads.track import bend, centre, curvature
from oodscen.numerics._exact import atan2, cos, quantised, sincos, wrapped
from oodscen.numerics._kernels import part

_MAX_SLOPE = 0.5
"""Maximum sideways motion of a vehicle per metre travelled, m."""
_MAX_TURN = 1.2
"""Maximum turn rate of a lane follower's heading, rad/s."""
_CLEARANCE = 0.2
"""Clearance beside its own path within which a driver counts a body as in its way, m."""
_USED = 0.9
"""Maximum share of the grip that actors use."""
_COMFORT = 0.6
"""Share of the grip that drivers use in curves."""
_SAMPLES = 10
"""Number of places ahead at which a driver looks for curves."""
PEAK = 5.7735
"""Maximum second derivative of the smooth course from 0 to 1."""
_MOST, _COMFORTABLE, _HEADWAY, _STANDSTILL = 1.8, 2.5, 1.2, 2.0
"""Intelligent driver model: maximum acceleration and comfortable braking, m/s^2; headway, s; standstill gap, m."""


@part
def grip(w: Situation) -> float:
    """Return the maximum acceleration that tyres or soles can transmit, m/s^2."""
    return _USED * w.friction * GRAVITY


@part
def move(w: Situation, i: int, distance: float) -> None:
    """Move along the actor's own heading relative to the road."""
    s, t = w.state[i, col.S], w.state[i, col.T]
    stretch = max(0.2, 1.0 - bend(w.track, s) * t)
    sine, cosine = sincos(w.state[i, col.HEADING])
    w.state[i, col.S] = quantised(s + distance * cosine / stretch)
    w.state[i, col.T] = quantised(t + distance * sine)


@part
def speed_up(w: Situation, i: int, acceleration: float, target: float) -> float:
    """Accelerate towards a speed within the grip, and return the distance covered, m."""
    before = w.state[i, col.SPEED]
    step = min(acceleration, grip(w)) * w.dt
    after = min(target, before + step) if target > before else max(target, before - step)
    w.state[i, col.SPEED] = quantised(after)
    return 0.5 * (before + after) * w.dt


@part
def accelerate(w: Situation, i: int, acceleration: float) -> float:
    """Change the speed without reversing, and return the distance covered, m.

    Grip that a curve uses is not available for braking or accelerating.
    """
    before = w.state[i, col.SPEED]
    across = before * before * curvature(w.track, w.state[i, col.S], w.state[i, col.T])
    total = grip(w)
    left = math.sqrt(max(0.04 * total * total, total * total - across * across))
    after = max(0.0, before + min(max(acceleration, -left), left) * w.dt)
    w.state[i, col.SPEED] = quantised(after)
    return 0.5 * (before + after) * w.dt


@part
def keep_lane(w: Situation, i: int, distance: float, blend: float, shift: float) -> None:
    """Move along the lane by a distance, m, with an additional offset to the left, m.

    `blend` is 0 in its own lane and 1 in its target lane.
    """
    state, direction = w.state, w.codes[i, col.DIRECTION]
    s, t, heading = state[i, col.S], state[i, col.T], state[i, col.HEADING]
    stretch = max(0.2, 1.0 - bend(w.track, s) * t)
    along = distance * abs(cos(heading))
    s = quantised(s + direction * along / stretch)
    state[i, col.S] = s
    own = centre(w.track, w.codes[i, col.LANE], s) + w.traits[i, col.OFFSET]
    wanted = own * (1.0 - blend) + shift
    if blend > 0.0:
        wanted += centre(w.track, w.codes[i, col.TARGET], s) * blend
    limit = _MAX_SLOPE * distance
    aside = min(max(wanted - t, -limit), limit)
    state[i, col.T] = quantised(t + aside)
    if distance > 1e-3:
        aim = atan2(aside, direction * along)
        most = _MAX_TURN * w.dt
        error = wrapped(aim - heading)
        state[i, col.HEADING] = quantised(wrapped(heading + min(max(error, -most), most)))


@part
def smooth(progress: float) -> float:
    """Return the quintic course from 0 to 1 that starts and ends at rest."""
    p = min(max(progress, 0.0), 1.0)
    return p * p * p * (10.0 + p * (6.0 * p - 15.0))


@part
def sideways_duration(w: Situation, shift: float, duration: float) -> float:
    """Return the duration of a sideways move, s: longer than `duration` on slippery roads."""
    return max(duration, math.sqrt(PEAK * abs(shift) / grip(w)))


@part
def since(w: Situation, i: int, time: float) -> float:
    """Return the time since the trigger fired, s; negative before."""
    return time - w.state[i, col.TRIGGERED] if w.state[i, col.TRIGGERED] >= 0.0 else -1.0


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
        place = (s + w.codes[i, col.DIRECTION] * ahead) / step
        turn = rows[min(max(int(place + 0.5), 0), last), 5]
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
