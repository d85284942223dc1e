"""Motion along a lane within the grip: the building blocks of behaviours.

Every kernel takes the world `w` and the row `i` of the actor that moves.
"""

import math

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import GRAVITY, Situation
from oodscen.driving._roads.track import centre, curvature, stretch
from oodscen.numerics._exact import atan2, cos, quantised, sincos, wrapped
from oodscen.numerics._kernels import part

_MAX_SLOPE = 0.5
"""Maximum sideways motion of a vehicle per metre travelled, m."""
_MAX_TURN = 1.2
"""Maximum turn rate of a lane follower's heading, rad/s."""
_USED = 0.9
"""Maximum share of the grip that actors use."""
_STEEPEST = 1.875
"""Maximum first derivative of the smooth course from 0 to 1."""
PEAK = 5.7735
"""Maximum second derivative of the smooth course from 0 to 1."""


@part
def grip(w: Situation) -> float:
    """Return the maximum acceleration that tyres or soles can transmit, m/s^2."""
    return _USED * w.friction * GRAVITY


@part
def since(w: Situation, i: int, time: float) -> float:
    """Return the time since the trigger fired, s; negative before."""
    return time - w.state[i, col.TRIGGERED] if w.state[i, col.TRIGGERED] >= 0.0 else -1.0


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
def move(w: Situation, i: int, distance: float) -> None:
    """Move along the actor's own heading relative to the road."""
    s, t = w.state[i, col.S], w.state[i, col.T]
    sine, cosine = sincos(w.state[i, col.HEADING])
    w.state[i, col.S] = quantised(s + distance * cosine / stretch(w.track, s, t))
    w.state[i, col.T] = quantised(t + distance * sine)


@part
def keep_lane(w: Situation, i: int, distance: float, blend: float, shift: float) -> None:
    """Move along the lane by a distance, m, with an additional offset to the left, m.

    `blend` is 0 in its own lane and 1 in its target lane.
    """
    state, direction = w.state, w.codes[i, col.DIRECTION]
    s, t, heading = state[i, col.S], state[i, col.T], state[i, col.HEADING]
    along = distance * abs(cos(heading))
    s = quantised(s + direction * along / stretch(w.track, s, t))
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
def sideways_rate(w: Situation, i: int, shift: float, duration: float) -> float:
    """Return the progress per second of a sideways move by `shift` metres, 1/s.

    The move takes longer than `duration` on slippery roads, and in a vehicle too slow to roll that far aside.
    """
    lasting = max(duration, math.sqrt(PEAK * abs(shift) / grip(w)))
    rolled, needed = _MAX_SLOPE * w.state[i, col.SPEED], _STEEPEST * abs(shift)
    return rolled / needed if rolled * lasting < needed else 1.0 / lasting
