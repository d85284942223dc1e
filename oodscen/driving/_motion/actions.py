"""The discrete actions as drivers, which follow the lane and ignore other road users."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

from oodscen._display import Brief
from oodscen.driving._motion.bodies import GRAVITY, MAX_STEERING
from oodscen.errors import UnknownComponent
from oodscen.numerics._exact import asin, atan, power, sin, tan
from oodscen.numerics._kernels import Kernel
from oodscen.protocols import Control, Driver, Observation

_PEAK = 5.7735
"""Maximum second derivative of the smooth course from 0 to 1."""


class LaneTracker(Brief):
    """Follows a course beside the starting lane's centre at a given speed.

    Steering is the course's own curvature plus feedback of offset and heading error, critically damped
    over a look-ahead distance and limited by the road's friction. A subclass defines the path
    (`course`) and the acceleration (`accelerate`); both may use values that `begin` stored. An instance
    drives only once.
    """

    def __init__(self) -> None:
        self.start: Observation | None = None
        self.travelled = 0.0
        self._time = 0.0

    def act(self, observation: Observation) -> Control:
        """Return the control for the next step."""
        if self.start is None:
            self.start = observation
            self._time = observation.time
            self.begin(observation)
        self.travelled += observation.speed * (observation.time - self._time)
        self._time = observation.time
        steering, across = self._steer(observation)
        grip = 0.97 * observation.friction * GRAVITY
        left = math.sqrt(max(0.0, grip * grip - across * across))
        wanted = self.accelerate(observation)
        # Actions ignore the traffic, not the road: they take a roundabout slowly.
        wanted = min(wanted, 3.0 * (observation.curve_speed - observation.speed))
        return Control(min(max(wanted, -left), left), steering)

    def begin(self, observation: Observation) -> None:
        """Plan the action from the first observation."""

    def course(self) -> tuple[float, float, float]:
        """Return the desired offset, m, and its first two derivatives by the distance travelled."""
        return 0.0, 0.0, 0.0

    def accelerate(self, observation: Observation) -> float:
        """Return the desired acceleration, m/s^2; by default it holds the initial speed."""
        assert self.start is not None
        return _hold(observation.speed, self.start.speed)

    def _steer(self, now: Observation) -> tuple[float, float]:
        """Return the steering angle, rad, and the resulting lateral acceleration, m/s^2."""
        return _steering(
            *self.course(),
            now.speed,
            now.offset_m,
            now.heading_error,
            now.curvature,
            now.wheelbase,
            now.friction,
        )


@Kernel
def _steering(
    offset: float,
    slope: float,
    turn: float,
    speed: float,
    place: float,
    heading: float,
    curvature: float,
    wheelbase: float,
    friction: float,
) -> tuple[float, float]:
    """Return the steering angle that follows a course, and the resulting lateral acceleration.

    Args:
        offset: Offset of the course, m.
        slope: Its first derivative by the distance travelled.
        turn: Its second derivative, 1/m.
        speed: The ego's speed, m/s.
        place: The ego's offset, m.
        heading: The ego's heading relative to the road, rad.
        curvature: Curvature of the road ahead, 1/m.
        wheelbase: The ego's wheelbase, m.
        friction: Friction scale of the road.
    """
    # Shorten the look-ahead in tight bends.
    reach = max(3.0, min(0.8 * speed, 0.3 / max(abs(curvature), 1e-3)))
    aside = place - offset
    ahead = curvature + turn / math.sqrt(1.0 - slope * slope)
    # In a curve, the path of the centre differs from the heading by the slip angle.
    slip = asin(min(max(0.5 * wheelbase * ahead, -0.6), 0.6))
    askew = heading + slip - asin(slope)
    wanted = ahead - aside / (reach * reach) - 2.0 * sin(askew) / reach
    square = max(speed * speed, 0.01)
    most = 0.92 * friction * GRAVITY / square
    wanted = min(max(wanted, -most), most)
    slip = asin(min(max(0.5 * wheelbase * wanted, -0.6), 0.6))
    steering = atan(2.0 * tan(slip))
    return min(max(steering, -MAX_STEERING), MAX_STEERING), square * wanted


class Cruise(LaneTracker):
    """Keeps lane and speed, and ignores everything else."""


class SlowDown(LaneTracker):
    """Slows down gently to half of the initial speed."""

    def accelerate(self, observation: Observation) -> float:
        """Return -2 m/s^2 until half of the initial speed is reached."""
        assert self.start is not None
        return max(-2.0, _hold(observation.speed, 0.5 * self.start.speed))


class Brake(LaneTracker):
    """Brakes to a standstill."""

    _repr_fields = ("deceleration",)

    def __init__(self, deceleration: float) -> None:
        super().__init__()
        self.deceleration = deceleration

    def accelerate(self, observation: Observation) -> float:
        """Return the deceleration; the car does not reverse."""
        return -self.deceleration


class _Shift(LaneTracker):
    """Moves sideways on a smooth course; a subclass plans it in `begin`."""

    origin = shift = 0.0
    distance = 1.0

    def course(self) -> tuple[float, float, float]:
        """Return the quintic course from the initial offset to the target: straight at both ends."""
        shift, distance = self.shift, self.distance
        p = min(max(self.travelled / distance, 0.0), 1.0)
        rest = 1.0 - p
        offset = self.origin + shift * p * p * p * (10.0 + p * (6.0 * p - 15.0))
        slope = shift / distance * 30.0 * p * p * rest * rest
        bend = shift / (distance * distance) * 60.0 * p * rest * (1.0 - 2.0 * p)
        return offset, slope, bend


class ChangeLane(_Shift):
    """Moves to the centre of the neighbouring lane in about three seconds at constant speed."""

    _repr_fields = ("side",)

    def __init__(self, side: int) -> None:
        super().__init__()
        self.side = side

    def begin(self, observation: Observation) -> None:
        """Plan the shift; it takes longer on slippery roads."""
        target = target_offset(observation, self.side)
        self.origin = observation.offset_m
        self.shift = (self.origin if target is None else target) - self.origin
        self.distance = _stretch(observation, self.shift, seconds=3.0)


class PullOver(_Shift):
    """Moves to the roadside and stops there."""

    deceleration = 2.5

    def begin(self, observation: Observation) -> None:
        """Plan the shift, and a braking distance long enough for it."""
        self.origin = observation.offset_m
        self.shift = observation.roadside_m - self.origin
        # In a shorter distance, the outer front corner would swing beyond the edge of the road.
        shortest = power(2800.0 * abs(self.shift) + 1e-9, 1.0 / 3.0)
        planned = _stretch(observation, self.shift, seconds=2.0, share=0.45)
        self.distance = max(planned, shortest)
        comfortable = min(2.5, 0.5 * observation.friction * GRAVITY)
        room = max(1.15 * self.distance, 0.5 * observation.speed * observation.speed / comfortable)
        self.deceleration = 0.5 * observation.speed * observation.speed / max(room, 1.0)

    def accelerate(self, observation: Observation) -> float:
        """Return the planned deceleration."""
        return -max(self.deceleration, 0.3)


ACTION_DRIVERS: Mapping[str, Callable[[], Driver]] = MappingProxyType(
    {
        "keep_speed": Cruise,
        "slow_down": SlowDown,
        "stop": lambda: Brake(3.5),
        "emergency_brake": lambda: Brake(8.0),
        "change_lane_left": lambda: ChangeLane(1),
        "change_lane_right": lambda: ChangeLane(-1),
        "pull_over": PullOver,
    }
)
"""Factories of single-use drivers, by the ids in `oodscen.data._episode.ACTIONS`."""


def action_driver(action_id: str) -> Driver:
    """Return a new driver that executes one discrete action.

    Raises:
        UnknownComponent: If there is no such action.
    """
    try:
        return ACTION_DRIVERS[action_id]()
    except KeyError:
        raise UnknownComponent("action", action_id, ACTION_DRIVERS) from None


def is_available(action_id: str, observation: Observation) -> bool:
    """Return whether the lane that an action needs exists; an oncoming lane counts.

    Raises:
        UnknownComponent: If there is no such action.
    """
    if action_id not in ACTION_DRIVERS:
        raise UnknownComponent("action", action_id, ACTION_DRIVERS)
    if action_id == "change_lane_left":
        return observation.lane_left_m is not None
    if action_id == "change_lane_right":
        return observation.lane_right_m is not None
    return True


def target_offset(observation: Observation, side: int) -> float | None:
    """Return the offset of the neighbouring lane's centre on the left (+1) or right (-1), or `None`."""
    return observation.lane_left_m if side > 0 else observation.lane_right_m


def _hold(speed: float, target: float) -> float:
    """Return a gentle acceleration towards the target speed."""
    return min(max(1.5 * (target - speed), -2.0), 2.0)


def _stretch(now: Observation, shift: float, *, seconds: float, share: float = 0.5) -> float:
    """Return the distance for a shift, m, such that it uses at most a given share of the grip."""
    grip = min(2.5, share * now.friction * GRAVITY)
    needed = math.sqrt(_PEAK * abs(shift) / grip)
    return max(now.speed * max(seconds, needed), 4.0 * abs(shift), 1.0)
