"""The columns of the tables that describe the bodies of a kinematic world.

Kernels take them as `col.SPEED`: numba freezes the numbers at compile time.
"""

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
"""First of six columns in which a behaviour keeps its memory."""
PITCH, ROLL = 16, 17
"""Tilt of a body that moves through key poses, rad; positive tips its top ahead, or to the right."""
STATE_WIDTH = 18

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
PIVOT = 13
"""Height above its underside about which it tilts, m."""
DELAY, PACE = 14, 15
"""Delay before its first key, and the factor of its pace."""
LET_GO = 16
"""Place in its keys at which it is let go; negative for never."""
FASTEST, SPINNIEST = 17, 18
"""Greatest speed through key poses, m/s, and rate of turn, rad/s."""
CLIMB = 19
"""Greatest speed up or down through key poses, m/s."""
FIRST = 20
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
KEY, KEYS = 9, 10
"""First of its key poses in `Situation.traits`, and their number."""
FRAME, BY, FACING, THEN = 11, 12, 13, 14
"""Reference, argument, heading and end of its key poses (`oodscen.driving._motion.keyframes`)."""
TILTS = 15
"""1 if its motion ever pitches, rolls or sinks."""
CODES_WIDTH = 16

# Columns of the rows of `Situation.traits` below the bodies: the argument, six values of a pose, and their slopes.
AT, POSE, SLOPE = 0, 1, 7
KEYS_WIDTH = 13

# Columns of `Situation.paths`: the bodies at the beginning of a step, as the others see them.
PATH_S, PATH_T, PATH_SPEED, PATH_ALONG, PATH_ACROSS = range(5)
PATHS_WIDTH = 5
