"""The tables of bodies in the kinematic world, and the ego as a kinematic bicycle.

Row 0 of every table is the ego; actors follow in the scene's order. `Situation` bundles the tables
with the road and the visibility for kernels. State is rounded to 1e-6 in every step.
"""

import math
from typing import NamedTuple

from oodscen.driving._roads.track import Track
from oodscen.numerics._exact import asin, atan, quantised, sin, sincos, tan, wrapped
from oodscen.numerics._kernels import Integers, Numbers, part

GRAVITY = 9.81
WHEELBASE = 2.7
"""The ego's wheelbase, m."""
MAX_STEERING = 0.6
"""Maximum angle of the ego's front wheels, rad."""
MAX_DRIVE = 4.0
"""Maximum acceleration of the ego's motor, m/s^2."""

# Columns of `Situation.state`.
X, Y, YAW = 0, 1, 2
S, T = 3, 4
"""Position on the road, m."""
HEADING = 5
"""Heading relative to the road, rad."""
SPEED, ACCELERATION = 6, 7
"""Speed, m/s, and acceleration, m/s^2, along the heading."""
LIFT = 8
"""Height above the road, m."""
TRIGGERED = 9
"""Time at which the trigger fired, s; negative before."""
MEMORY = 10
"""First of four columns in which a behaviour keeps its memory."""
STATE_WIDTH = 14

# Columns of `Situation.traits`: constants of a body. The behaviour's parameters start at FIRST.
LENGTH, WIDTH = 0, 1
OFFSET = 2
"""Initial offset to the left of its lane's centre, m."""
PHASE = 3
"""Phase of periodic motion, rad."""
VALUE = 4
"""Threshold of its trigger, s or m."""
QUICKNESS = 5
"""Acceleration towards its speed, m/s^2."""
HOME_S, HOME_T = 6, 7
"""Initial position on the road, m."""
APART_X, APART_Y, APART_YAW = 8, 9, 10
"""Pose relative to the body that it belongs to."""
POLE = 11
"""Distance from the towing body to its own axle, m."""
HEIGHT = 12
"""With `LENGTH` and `WIDTH`, the size of its box, m."""
FIRST = 13
PARAMETERS = (
    "speed",
    "duration",
    "deceleration",
    "period",
    "amplitude",
    "distance",
    "pause",
    "lateral",
    "acceleration",
    "radius",
    "height",
    "spin_deg",
    "angle_deg",
    "lift",
    "headway",
)
"""Parameters of behaviours in the order of their columns; `lanes` is stored as a lane instead."""
TRAITS_WIDTH = FIRST + len(PARAMETERS)
(
    GOAL,
    DURATION,
    DECELERATION,
    PERIOD,
    AMPLITUDE,
    DISTANCE,
    PAUSE,
    LATERAL,
    PUSH,
    RADIUS,
    DROP,
    SPIN,
    ANGLE,
    FLIGHT,
    HEADWAY,
) = range(FIRST, TRAITS_WIDTH)

# Columns of `Situation.codes`.
BEHAVIOUR, LANE, TARGET = 0, 1, 2
"""Behaviour code, the strip of its placement, and the strip that it may move to."""
DIRECTION = 3
"""+1 if it travels towards larger s, else -1."""
OTHER = 4
"""Row of the body that it belongs to, -1 for none."""
TRIGGER, MEASURED = 5, 6
"""Kind of its trigger (`oodscen.driving._motion.triggers`), and the row that the trigger measures."""
IS_PASSABLE, IS_LIT = 7, 8
"""1 if it can be driven over or through; 1 if it has lamps."""
CODES_WIDTH = 9

# Columns of `Situation.paths`: the bodies at the beginning of a step, as the others see them.
PATH_S, PATH_T, PATH_SPEED, PATH_ALONG, PATH_ACROSS = range(5)
PATHS_WIDTH = 5


class Situation(NamedTuple):
    """The complete input of kernels: all tables, the road and the visibility."""

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
def bounded(value: float, low: float, high: float) -> float:
    """Return `value` clamped to the limits, or 0 for NaN."""
    if value != value:
        return 0.0
    return low if value < low else high if value > high else value


@part
def drive_ego(w: Situation, acceleration: float, steering: float) -> None:
    """Move the ego by one step: a kinematic bicycle about its centre within a friction circle.

    The demanded longitudinal and lateral accelerations are scaled back together onto the circle
    (Rajamani 2012, chapters 2 and 13). There is no reverse gear.

    Args:
        w: The world; row 0 of its state changes.
        acceleration: Demanded acceleration, m/s^2; NaN counts as zero.
        steering: Demanded steering angle, rad; NaN counts as zero.
    """
    state, dt = w.state, w.dt
    before = state[0, SPEED]
    grip = w.friction * GRAVITY
    angle = bounded(steering, -MAX_STEERING, MAX_STEERING)
    curvature = sin(atan(0.5 * tan(angle))) / (0.5 * WHEELBASE)
    along = bounded(acceleration, -2.0 * grip, min(MAX_DRIVE, grip))
    if before <= 0.0 and along < 0.0:
        along = 0.0
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
    slip = asin(bounded(0.5 * WHEELBASE * curvature, -1.0, 1.0))
    turn = mean * curvature * dt
    sine, cosine = sincos(state[0, YAW] + 0.5 * turn + slip)
    state[0, X] = quantised(state[0, X] + mean * dt * cosine)
    state[0, Y] = quantised(state[0, Y] + mean * dt * sine)
    state[0, YAW] = quantised(wrapped(state[0, YAW] + turn))
    state[0, SPEED] = quantised(after)
