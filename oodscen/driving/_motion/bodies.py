"""The tables of bodies in the kinematic world, and the ego as a kinematic bicycle.

Row 0 of every table is the ego; actors follow in the scene's order. `Situation` bundles the tables
with the road and the visibility for kernels. State is rounded to 1e-6 in every step.
"""

import math
from typing import NamedTuple

from oodscen._numbers import finite_number
from oodscen.driving._motion import columns as col
from oodscen.driving._roads.track import Track
from oodscen.numerics._exact import asin, atan, quantised, sin, sincos, tan, wrapped
from oodscen.numerics._kernels import Integers, Numbers, part
from oodscen.protocols import Control

GRAVITY = 9.81
WHEELBASE = 2.7
"""The ego's wheelbase, m."""
MAX_STEERING = 0.6
"""Maximum angle of the ego's front wheels, rad."""
MAX_DRIVE = 4.0
"""Maximum acceleration of the ego's motor, m/s^2."""


class Situation(NamedTuple):
    """The complete input of kernels: all tables, the road and the visibility.

    Below the bodies, the rows of `traits` hold the key poses of motions made to order.
    """

    track: Track
    state: Numbers
    traits: Numbers
    codes: Integers
    paths: Numbers
    order: Integers
    """[n - 1] rows of the actors, each after the body that it belongs to."""
    dt: float
    friction: float
    visual_range: float
    """Visual range, m."""
    headlamp_range: float
    """Distance at which bodies without lamps are visible, m."""


@part
def clamp(value: float, low: float, high: float) -> float:
    """Return `value` clamped to the limits, or 0 for NaN."""
    if value != value:
        return 0.0
    return low if value < low else high if value > high else value


@part
def place_on(w: Situation, body: int, ahead: float, left: float) -> tuple[float, float]:
    """Return x and y in the world of a place so many metres ahead of a body and to its left."""
    sine, cosine = sincos(w.state[body, col.YAW])
    x, y = w.state[body, col.X], w.state[body, col.Y]
    return x + ahead * cosine - left * sine, y + ahead * sine + left * cosine


@part
def place_relative_to(w: Situation, body: int, i: int) -> tuple[float, float]:
    """Return how far the actor in row `i` is ahead of a body and to its left, m."""
    sine, cosine = sincos(w.state[body, col.YAW])
    dx = w.state[i, col.X] - w.state[body, col.X]
    dy = w.state[i, col.Y] - w.state[body, col.Y]
    return dx * cosine + dy * sine, dy * cosine - dx * sine


@part
def drive_ego(w: Situation, acceleration: float, steering: float) -> None:
    """Move the ego by one step: a kinematic bicycle about its centre within a friction circle.

    The demanded acceleration, m/s^2, and the lateral one that follows from the steering angle, rad, are scaled back
    together onto the circle (Rajamani 2012, chapters 2 and 13). NaN counts as zero. There is no reverse gear.
    """
    state, dt = w.state, w.dt
    before = state[0, col.SPEED]
    grip = w.friction * GRAVITY
    angle = clamp(steering, -MAX_STEERING, MAX_STEERING)
    curvature = sin(atan(0.5 * tan(angle))) / (0.5 * WHEELBASE)
    along = clamp(acceleration, -2.0 * grip, min(MAX_DRIVE, grip))
    across = before * before * curvature
    total = math.sqrt(along * along + across * across)
    if total > grip:
        along *= grip / total
    after = max(0.0, before + along * dt)
    faster = max(after, before)
    left = math.sqrt(max(0.0, grip * grip - along * along))
    if faster * faster * abs(curvature) > left:
        limit = left / (faster * faster)
        curvature = limit if curvature > 0.0 else -limit
    mean = 0.5 * (before + after)
    slip = asin(clamp(0.5 * WHEELBASE * curvature, -1.0, 1.0))
    turn = mean * curvature * dt
    sine, cosine = sincos(state[0, col.YAW] + 0.5 * turn + slip)
    state[0, col.X] = quantised(state[0, col.X] + mean * dt * cosine)
    state[0, col.Y] = quantised(state[0, col.Y] + mean * dt * sine)
    state[0, col.YAW] = quantised(wrapped(state[0, col.YAW] + turn))
    state[0, col.SPEED] = quantised(after)


def within_grip(control: Control, speed: float, friction: float) -> Control:
    """Return the part of the ego's control that motor, wheels and tyres can follow.

    The kinematic world drives its ego by this friction circle (Rajamani 2012, chapters 2 and 13).

    Args:
        control: The driver's control.
        speed: The ego's speed, m/s.
        friction: Friction scale of the road; 1 is dry asphalt.

    Raises:
        UsageError: If speed or friction is not a finite number.
    """
    speed = finite_number("speed", speed, -1e6, 1e6)
    friction = finite_number("friction", friction, 0.0, 100.0)
    grip = friction * GRAVITY
    angle = min(max(control.steering, -MAX_STEERING), MAX_STEERING)
    along = min(max(control.acceleration, -2.0 * grip), min(MAX_DRIVE, grip))
    curvature = math.sin(math.atan(0.5 * math.tan(angle))) / (0.5 * WHEELBASE)
    total = math.hypot(along, speed * speed * curvature)
    if total > grip:
        along *= grip / total
    left = math.sqrt(max(0.0, grip * grip - along * along))
    if speed * speed * abs(curvature) > left:
        curvature = math.copysign(left / (speed * speed), curvature)
        angle = math.atan(2.0 * math.tan(math.asin(0.5 * WHEELBASE * curvature)))
    return Control(along, angle)
