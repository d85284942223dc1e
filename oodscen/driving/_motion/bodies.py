"""The tables in which the kinematic world keeps its bodies, and the ego as a bicycle.

Row 0 of every table is the ego; actors follow in the scene's order. `Situation` bundles the tables
with the road and the air for kernels. State is rounded to 1e-6 in every step.
"""

import math
from typing import NamedTuple

from oodscen.driving._roads.track import Track
from oodscen.numerics._exact import asin, atan, quantised, sin, sincos, tan, wrapped
from oodscen.numerics._kernels import Integers, Numbers, part

GRAVITY = 9.81
WHEELBASE = 2.7
"""Of the ego, m."""
MAX_STEERING = 0.6
"""Of the ego's front wheels, rad."""
MAX_DRIVE = 4.0
"""Largest acceleration that the ego's motor gives, m/s^2."""

# Columns of `Situation.state`.
X, Y, YAW = 0, 1, 2
S, T = 3, 4
"""Place on the road."""
HEADING = 5
"""Against the road, rad."""
SPEED, ACCELERATION = 6, 7
"""Along the heading."""
LIFT = 8
"""Above the road, m."""
TRIGGERED = 9
"""When the trigger fired, s; negative before."""
MEMORY = 10
"""What a behaviour remembers: this column and the next three."""
STATE_WIDTH = 14

# Columns of `Situation.traits`: constants of a body; a behaviour's parameters follow from FIRST on.
LENGTH, WIDTH = 0, 1
OFFSET = 2
"""To the left of its lane's centre, where it is placed, m."""
PHASE = 3
"""Of whatever it does periodically, rad."""
VALUE = 4
"""Of its trigger, s or m."""
QUICKNESS = 5
"""How quickly it reaches its speed, m/s^2."""
HOME_S, HOME_T = 6, 7
"""Where it is placed."""
APART_X, APART_Y, APART_YAW = 8, 9, 10
"""Where it is in the axes of the body to which it belongs."""
POLE = 11
"""From the body that tows it to its own axle, m."""
HEIGHT = 12
"""With `LENGTH` and `WIDTH` the box that it is, m."""
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
"""Of behaviours, in the order of their columns; `lanes` is kept as a lane instead."""
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
"""What it does, and the strips in which it is placed and to which it may move."""
DIRECTION = 3
"""+1 when it travels towards larger s, else -1."""
OTHER = 4
"""Row of the body to which it belongs, -1 for none."""
TRIGGER, MEASURED = 5, 6
"""Kind of its trigger (`oodscen.driving._motion.triggers`), and the row to which it is measured."""
IS_PASSABLE, IS_LIT = 7, 8
"""Whether it can be driven over or through, and whether it has lamps."""
CODES_WIDTH = 9

# Columns of `Situation.paths`: the bodies at the beginning of a step, as others see them.
PATH_S, PATH_T, PATH_SPEED, PATH_ALONG, PATH_ACROSS = range(5)
PATHS_WIDTH = 5


class Situation(NamedTuple):
    """Everything that kernels know of a world."""

    track: Track
    state: Numbers
    traits: Numbers
    codes: Integers
    paths: Numbers
    order: Integers
    """[n - 1] rows of the actors, each after the one to which it belongs."""
    dt: float
    friction: float
    visual_range: float
    """How far anybody sees, m."""
    headlamp_range: float
    """How far anybody sees what has no lamps, m."""


@part
def bounded(value: float, low: float, high: float) -> float:
    """Return `value` within limits, 0 for not-a-number."""
    if value != value:
        return 0.0
    return low if value < low else high if value > high else value


@part
def drive_ego(w: Situation, acceleration: float, steering: float) -> None:
    """Move the ego by one step: a kinematic bicycle about its centre within a friction circle.

    The demanded longitudinal and lateral accelerations are scaled back together onto the circle
    (Rajamani 2012, chapters 2 and 13). There is no reverse gear.

    Args:
        w: Of which row 0 moves.
        acceleration: Demand, m/s^2; not-a-number counts as zero.
        steering: Demand, rad; likewise.
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
