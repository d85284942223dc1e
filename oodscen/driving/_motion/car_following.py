"""How actors move and how drivers among them pay attention: parts of which behaviours are made."""

import math

from oodscen.driving._motion.bodies import (
    DIRECTION,
    GOAL,
    GRAVITY,
    HEADING,
    IS_LIT,
    IS_PASSABLE,
    LANE,
    OFFSET,
    PATH_ACROSS,
    PATH_ALONG,
    PATH_S,
    PATH_SPEED,
    PATH_T,
    SPEED,
    TARGET,
    TRIGGERED,
    S,
    Situation,
    T,
)
from oodscen.driving._roads.track import bend, centre, curvature
from oodscen.numerics._exact import PI, atan2, cos, quantised, sincos, wrapped
from oodscen.numerics._kernels import part

_MAX_SLOPE = 0.5
"""Metres that a vehicle may move sideways per metre travelled."""
_MAX_TURN = 1.2
"""rad/s by which a lane follower's heading settles."""
_CLEARANCE = 0.2
"""Metres beside its own path within which a driver still counts a body as being in its way."""
_USED = 0.9
"""Share of the grip that actors use at most."""
_COMFORT = 0.6
"""Share of the grip that drivers use in curves."""
_SAMPLES = 10
"""Places ahead at which a driver looks for curves."""
_PEAK = 5.7735
"""Largest second derivative of the smooth course from 0 to 1."""
_MOST, _COMFORTABLE, _HEADWAY, _STANDSTILL = 1.8, 2.5, 1.2, 2.0
"""Of the intelligent-driver model: m/s^2, m/s^2, s, m."""


@part
def grip(w: Situation) -> float:
    """Return the acceleration that tyres, or soles, give at most, m/s^2."""
    return _USED * w.friction * GRAVITY


# ------------------------------------------------------------------ motion


@part
def move(w: Situation, i: int, distance: float) -> None:
    """Move along the actor's own heading against the road."""
    s, t = w.state[i, S], w.state[i, T]
    stretch = max(0.2, 1.0 - bend(w.track, s) * t)
    sine, cosine = sincos(w.state[i, HEADING])
    w.state[i, S] = quantised(s + distance * cosine / stretch)
    w.state[i, T] = quantised(t + distance * sine)


@part
def speed_up(w: Situation, i: int, acceleration: float, target: float) -> float:
    """Approach a speed, within the grip, and return the distance covered meanwhile."""
    before = w.state[i, SPEED]
    step = min(acceleration, grip(w)) * w.dt
    after = min(target, before + step) if target > before else max(target, before - step)
    w.state[i, SPEED] = quantised(after)
    return 0.5 * (before + after) * w.dt


@part
def accelerate(w: Situation, i: int, acceleration: float) -> float:
    """Change the speed without ever reversing, and return the distance covered meanwhile.

    What a curve takes of the grip is not there for braking or driving.
    """
    before = w.state[i, SPEED]
    across = before * before * curvature(w.track, w.state[i, S], w.state[i, T])
    total = grip(w)
    left = math.sqrt(max(0.04 * total * total, total * total - across * across))
    after = max(0.0, before + min(max(acceleration, -left), left) * w.dt)
    w.state[i, SPEED] = quantised(after)
    return 0.5 * (before + after) * w.dt


@part
def keep_lane(w: Situation, i: int, distance: float, blend: float, shift: float) -> None:
    """Move along the lane.

    Args:
        w: The world.
        i: The actor's row.
        distance: Covered in this step, m.
        blend: 0 in its own lane, 1 in its target lane.
        shift: Further to the left, m.
    """
    state, direction = w.state, w.codes[i, DIRECTION]
    s, t, heading = state[i, S], state[i, T], state[i, HEADING]
    stretch = max(0.2, 1.0 - bend(w.track, s) * t)
    along = distance * abs(cos(heading))
    s = quantised(s + direction * along / stretch)
    state[i, S] = s
    wanted = (centre(w.track, w.codes[i, LANE], s) + w.traits[i, OFFSET]) * (1.0 - blend) + shift
    if blend > 0.0:
        wanted += centre(w.track, w.codes[i, TARGET], s) * blend
    limit = _MAX_SLOPE * distance
    aside = min(max(wanted - t, -limit), limit)
    state[i, T] = quantised(t + aside)
    if distance > 1e-3:
        aim = atan2(aside, direction * along)
        most = _MAX_TURN * w.dt
        error = wrapped(aim - heading)
        state[i, HEADING] = quantised(wrapped(heading + min(max(error, -most), most)))


@part
def smooth(progress: float) -> float:
    """Return the fifth-order course from 0 to 1, which starts and ends at rest."""
    p = min(max(progress, 0.0), 1.0)
    return p * p * p * (10.0 + p * (6.0 * p - 15.0))


@part
def sideways(w: Situation, shift: float, duration: float) -> float:
    """Return how long a move to the side takes: longer than `duration` where it is slippery, s."""
    return max(duration, math.sqrt(_PEAK * abs(shift) / grip(w)))


@part
def since(w: Situation, i: int, time: float) -> float:
    """Return the time since the trigger, s; negative before."""
    return time - w.state[i, TRIGGERED] if w.state[i, TRIGGERED] >= 0.0 else -1.0


# ------------------------------------------------------------------ attention


@part
def free_road(w: Situation, i: int, slowest: float) -> tuple[float, float]:
    """Return the gap to what is ahead in an actor's path, m, and its speed away from it.

    The gap is infinite where nothing is ahead or nothing can be seen: through fog, rain and snow
    nobody sees beyond the visual range, and at night what has no lamps is seen in the beam only.

    Args:
        w: The world, at the beginning of the step.
        i: The actor's row.
        slowest: Bodies that move away more slowly are disregarded, m/s.
    """
    paths, direction = w.paths, w.codes[i, DIRECTION]
    s, t = paths[i, PATH_S], paths[i, PATH_T]
    best, away = math.inf, 0.0
    for j in range(paths.shape[0]):
        ahead = (paths[j, PATH_S] - s) * direction
        if ahead <= 0.0 or j == i or w.codes[j, IS_PASSABLE] == 1:
            continue
        room = paths[j, PATH_ACROSS] + paths[i, PATH_ACROSS] + _CLEARANCE
        if abs(paths[j, PATH_T] - t) >= room:
            continue
        gap = ahead - paths[j, PATH_ALONG] - paths[i, PATH_ALONG]
        speed = paths[j, PATH_SPEED] * direction
        reach = w.visual_range if w.codes[j, IS_LIT] == 1 else w.headlamp_range
        if gap < best and gap <= reach and speed >= slowest:
            best, away = gap, speed
    return best, away


@part
def curve_speed(w: Situation, i: int, grip: float) -> float:
    """Return the speed from which the curves ahead can be taken, m/s.

    Args:
        w: The world.
        i: Row of the driver.
        grip: What the tyres give at most, m/s^2.
    """
    along = _COMFORT * grip
    braking = min(_COMFORTABLE, 0.5 * grip)
    speed, rows, step = w.state[i, SPEED], w.track.samples, w.track.step
    s, t = w.state[i, S], w.state[i, T]
    reach = 0.5 * speed * speed / braking + 10.0
    square, last = 1e6, rows.shape[0] - 1
    for k in range(_SAMPLES):
        ahead = reach * k / (_SAMPLES - 1.0)
        place = (s + w.codes[i, DIRECTION] * ahead) / step
        turn = rows[min(max(int(place + 0.5), 0), last), 5]
        if abs(turn) > 1e-5:
            turn = abs(turn / max(0.2, 1.0 - turn * t))
            square = min(square, along / turn + 2.0 * braking * max(0.0, ahead - 5.0))
    return math.sqrt(square)


@part
def attentive(w: Situation, i: int, desired: float, headway: float, slowest: float) -> float:
    """Return the acceleration of the intelligent-driver model (Treiber et al. 2000), m/s^2.

    On slippery roads the driver counts on half of the grip for comfortable braking.
    """
    most, comfortable = _MOST, min(_COMFORTABLE, 0.5 * grip(w))
    if desired <= 0.0:
        return -comfortable
    speed = w.state[i, SPEED]
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
    """Return the behaviour's speed, or what the curves ahead allow."""
    return min(w.traits[i, GOAL], curve_speed(w, i, grip(w)))


@part
def cruise(w: Situation, i: int, blend: float, shift: float) -> None:
    """Drive in the lane at the behaviour's speed, attentive to what is ahead."""
    acceleration = attentive(w, i, desired_speed(w, i), _HEADWAY, -math.inf)
    keep_lane(w, i, accelerate(w, i, acceleration), blend, shift)


@part
def hurry(w: Situation, i: int, blend: float, shift: float, headway: float, slowest: float) -> None:
    """Drive like `cruise`, less attentively."""
    acceleration = attentive(w, i, desired_speed(w, i), headway, slowest)
    keep_lane(w, i, accelerate(w, i, acceleration), blend, shift)


@part
def turned(heading: float) -> float:
    """Return the opposite heading."""
    return quantised(wrapped(heading + PI))
