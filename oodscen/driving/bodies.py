"""What moves in the kinematic world: the ego as a bicycle, and actors in road coordinates."""

import math
from dataclasses import dataclass, field

from oodscen.catalogue import Asset
from oodscen.protocols import Control

GRAVITY = 9.81
WHEELBASE = 2.7
"""Of the ego, m."""
MAX_STEERING = 0.6
"""Of the ego's front wheels, rad."""
MAX_DRIVE = 4.0
"""Largest acceleration that the ego's motor gives, m/s^2."""

EgoSnapshot = tuple[float, float, float, float, float, float]
ActorSnapshot = tuple[float, ...]


def quantised(value: float) -> float:
    """Round to 1e-6, so that the last bits of a mathematical library never accumulate."""
    return round(value, 6) + 0.0


def wrapped(angle: float) -> float:
    """Return the same angle within (-pi, pi]."""
    return math.remainder(angle, math.tau)


@dataclass(slots=True)
class EgoBody:
    """A kinematic bicycle about the vehicle's centre, limited by a friction circle."""

    x: float
    y: float
    yaw: float
    speed: float
    s: float
    t: float
    """Where on the road its centre is; kept by the world."""

    def advance(self, control: Control, friction: float, dt: float) -> None:
        """Move by one step.

        The demanded longitudinal and lateral accelerations are scaled back together onto the
        friction circle. There is no reverse gear.

        Args:
            control: Demand; not-a-number counts as zero.
            friction: Scale of the road's friction.
            dt: s
        """
        grip = friction * GRAVITY
        steering = _bounded(control.steering, -MAX_STEERING, MAX_STEERING)
        slip = math.atan(0.5 * math.tan(steering))
        curvature = math.sin(slip) / (0.5 * WHEELBASE)
        along = _bounded(control.acceleration, -2.0 * grip, min(MAX_DRIVE, grip))
        if self.speed <= 0.0 and along < 0.0:
            along = 0.0
        across = self.speed * self.speed * curvature
        total = math.sqrt(along * along + across * across)
        if total > grip:
            along *= grip / total
        speed = max(0.0, self.speed + along * dt)
        faster = max(speed, self.speed)
        left = math.sqrt(max(0.0, grip * grip - along * along))
        if faster * faster * abs(curvature) > left:
            curvature = math.copysign(left / (faster * faster), curvature)
        mean = 0.5 * (self.speed + speed)
        slip = math.asin(_bounded(0.5 * WHEELBASE * curvature, -1.0, 1.0))
        turn = mean * curvature * dt
        course = self.yaw + 0.5 * turn + slip
        self.x = quantised(self.x + mean * dt * math.cos(course))
        self.y = quantised(self.y + mean * dt * math.sin(course))
        self.yaw = quantised(wrapped(self.yaw + turn))
        self.speed = quantised(speed)

    def snapshot(self) -> EgoSnapshot:
        """Return everything that changes."""
        return (self.x, self.y, self.yaw, self.speed, self.s, self.t)

    def restore(self, values: EgoSnapshot) -> None:
        """Take back what `snapshot` returned."""
        self.x, self.y, self.yaw, self.speed, self.s, self.t = values


@dataclass(slots=True)
class ActorBody:
    """One actor in road coordinates; its behaviour changes s, t, heading, speed and memory."""

    id: str
    asset: Asset
    state: str
    behaviour: str
    parameters: dict[str, float]
    lane: int
    """Index of the strip in which it is placed."""
    target_lane: int
    """Index of the strip to which its behaviour may move it."""
    offset: float
    """To the left of its lane's centre, where it is placed, m."""
    direction: int
    """+1 when it travels towards larger s."""
    phase: float
    """Of whatever it does periodically, rad."""
    s: float
    t: float
    heading: float
    """Against the road, rad."""
    speed: float
    triggered: float = -1.0
    """When its trigger fired, s; negative before."""
    memory: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """What its behaviour remembers."""

    def snapshot(self) -> ActorSnapshot:
        """Return everything that changes."""
        return (self.s, self.t, self.heading, self.speed, self.triggered, *self.memory)

    def restore(self, values: ActorSnapshot) -> None:
        """Take back what `snapshot` returned."""
        self.s, self.t, self.heading, self.speed, self.triggered, *memory = values
        self.memory = list(memory)


def _bounded(value: float, low: float, high: float) -> float:
    """Return `value` within limits, 0 for not-a-number."""
    if math.isnan(value):
        return 0.0
    return low if value < low else high if value > high else value
