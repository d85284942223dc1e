"""The discrete actions as drivers, which follow the lane and ignore other road users."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar, NamedTuple

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen._numbers import finite_number
from oodscen.data._reactions import LONGEST_REACTION_S
from oodscen.driving._motion.bodies import GRAVITY, MAX_STEERING
from oodscen.driving._motion.lane_keeping import PEAK
from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.errors import UnknownComponent
from oodscen.numerics._exact import asin, atan, power, sin, tan
from oodscen.numerics._kernels import Kernel, part
from oodscen.protocols import Control, Driver, Observation

KEEP, SLOW, STOP, BRAKE, LEFT, RIGHT, ASIDE = range(7)
"""Codes of the actions in kernels, in the order of `oodscen.data._episode.ACTIONS`."""
CODES: Mapping[str, int] = MappingProxyType(
    {
        "keep_speed": KEEP,
        "slow_down": SLOW,
        "stop": STOP,
        "emergency_brake": BRAKE,
        "change_lane_left": LEFT,
        "change_lane_right": RIGHT,
        "pull_over": ASIDE,
    }
)
"""Codes by action id."""
_COMFORTABLE, _HARDEST = 3.5, 8.0
"""Decelerations of stopping and of emergency braking, m/s^2."""
_NO_SHIFT = 1e-9
"""Added to a shift whose root is taken, which may be 0."""


class SeenRoad(NamedTuple):
    """The part of a driver's observation that actions use, as kernels take it; see `Observation`."""

    speed: float
    offset: float
    heading_error: float
    curvature: float
    left: float
    """Infinite if there is no lane to the left."""
    right: float
    """Minus infinity if there is no lane to the right."""
    roadside: float
    curve_speed: float
    friction: float
    wheelbase: float

    @classmethod
    def at(cls, now: Observation) -> "SeenRoad":
        """Return an observation as kernels take it."""
        return cls(
            now.speed,
            now.offset_m,
            now.heading_error,
            now.curvature,
            math.inf if now.lane_left_m is None else now.lane_left_m,
            -math.inf if now.lane_right_m is None else now.lane_right_m,
            now.roadside_m,
            now.curve_speed,
            now.friction,
            now.wheelbase,
        )


class Plan(NamedTuple):
    """An action as planned at its start: a speed to hold or a deceleration, and a move sideways."""

    goal: float
    """Speed to hold, m/s; negative if the ego brakes to a standstill."""
    deceleration: float
    """Deceleration of an ego that brakes to a standstill, m/s^2."""
    origin: float
    """Offset at which the move sideways begins, m."""
    shift: float
    """Length of the move to the left, m."""
    distance: float
    """Distance travelled during the move, m."""


@Kernel
def plan_action(action: int, now: SeenRoad) -> Plan:
    """Plan an action.

    Lane changes take about three seconds at constant speed, longer on slippery roads. Pulling over brakes
    over a distance long enough for its move.
    """
    if action == STOP:
        return Plan(-1.0, _COMFORTABLE, 0.0, 0.0, 1.0)
    if action == BRAKE:
        return Plan(-1.0, _HARDEST, 0.0, 0.0, 1.0)
    if action in (LEFT, RIGHT):
        target = now.left if action == LEFT else now.right
        shift = target - now.offset if abs(target) < math.inf else 0.0
        return Plan(now.speed, 0.0, now.offset, shift, _stretch(now, shift, 3.0, 0.5))
    if action == ASIDE:
        shift = now.roadside - now.offset
        # In a shorter distance, the outer front corner would swing beyond the edge of the road.
        shortest = power(2800.0 * abs(shift) + _NO_SHIFT, 1.0 / 3.0)
        distance = max(_stretch(now, shift, 2.0, 0.45), shortest)
        comfortable = min(2.5, 0.5 * now.friction * GRAVITY)
        room = max(1.15 * distance, 0.5 * now.speed * now.speed / comfortable)
        deceleration = max(0.5 * now.speed * now.speed / max(room, 1.0), 0.3)
        return Plan(-1.0, deceleration, now.offset, shift, distance)
    return Plan(0.5 * now.speed if action == SLOW else now.speed, 0.0, 0.0, 0.0, 1.0)


@part
def lateral_course(plan: Plan, travelled: float) -> tuple[float, float, float]:
    """Return the offset of a plan's course, m, and its first two derivatives by the distance travelled.

    The course is quintic from the origin to the target: straight at both ends.
    """
    p = min(max(travelled / plan.distance, 0.0), 1.0)
    rest = 1.0 - p
    offset = plan.origin + plan.shift * p * p * p * (10.0 + p * (6.0 * p - 15.0))
    slope = plan.shift / plan.distance * 30.0 * p * p * rest * rest
    turn = plan.shift / (plan.distance * plan.distance) * 60.0 * p * rest * (1.0 - 2.0 * p)
    return offset, slope, turn


@Kernel
def follow_plan(plan: Plan, travelled: float, now: SeenRoad) -> tuple[float, float]:
    """Return the acceleration, m/s^2, and the steering angle, rad, of a plan's next step.

    `travelled` is the distance since the plan's start, m.
    """
    offset, slope, turn = lateral_course(plan, travelled)
    steering, across = _steering(offset, slope, turn, now)
    grip = 0.97 * now.friction * GRAVITY
    most = math.sqrt(max(0.0, grip * grip - across * across))
    acceleration = -plan.deceleration
    if plan.goal >= 0.0:
        acceleration = min(max(1.5 * (plan.goal - now.speed), -2.0), 2.0)
    # Actions ignore the traffic, not the road: they take a roundabout slowly.
    acceleration = min(acceleration, 3.0 * (now.curve_speed - now.speed))
    return min(max(acceleration, -most), most), steering


@part
def _steering(offset: float, slope: float, turn: float, now: SeenRoad) -> tuple[float, float]:
    """Return the steering angle that follows a course, and the resulting lateral acceleration.

    The course is given by its offset, m, and its first two derivatives by the distance travelled.
    """
    speed, curvature, wheelbase = now.speed, now.curvature, now.wheelbase
    # Shorten the look-ahead in tight bends.
    reach = max(3.0, min(0.8 * speed, 0.3 / max(abs(curvature), 1e-3)))
    aside = now.offset - offset
    ahead = curvature + turn / math.sqrt(1.0 - slope * slope)
    # In a curve, the path of the centre differs from the heading by the slip angle.
    slip = asin(min(max(0.5 * wheelbase * ahead, -0.6), 0.6))
    askew = now.heading_error + slip - asin(slope)
    bend = ahead - aside / (reach * reach) - 2.0 * sin(askew) / reach
    square = max(speed * speed, 0.01)
    most = 0.92 * now.friction * GRAVITY / square
    bend = min(max(bend, -most), most)
    slip = asin(min(max(0.5 * wheelbase * bend, -0.6), 0.6))
    steering = atan(2.0 * tan(slip))
    return min(max(steering, -MAX_STEERING), MAX_STEERING), square * bend


@part
def _stretch(now: SeenRoad, shift: float, seconds: float, share: float) -> float:
    """Return the distance for a shift, m, such that it uses at most a given share of the grip."""
    grip = min(2.5, share * now.friction * GRAVITY)
    needed = math.sqrt(PEAK * abs(shift) / grip)
    return max(now.speed * max(seconds, needed), 4.0 * abs(shift), 1.0)


class ActionDriver(Brief):
    """Executes one action in the lane in which the ego started; an instance drives only once.

    Steering is the course's own curvature plus feedback of offset and heading error, critically damped
    over a look-ahead distance and limited by the road's friction.

    Args:
        action: Id of the action.
        reaction_s: Time for which the ego keeps lane and speed before the action begins, s.
        cruise: Speed that `keep_speed` holds, m/s; by default the speed at its start.
    """

    _repr_fields: ClassVar[tuple[str, ...]] = ("action", "reaction_s")

    def __init__(
        self, action: str, reaction_s: float = 0.0, *, cruise: float | None = None
    ) -> None:
        self.action = action
        self.reaction_s = reaction_s
        self.cruise = cruise
        self._begins = -math.inf
        self._plan: Plan | None = None
        self._travelled = 0.0
        self._time = 0.0

    def act(self, observation: Observation) -> Control:
        """Return the control for the next step."""
        now = SeenRoad.at(observation)
        if self._plan is None and self.reaction_s > 0.0:
            self._begins = observation.time + self.reaction_s - ROUNDING_S
            self._start(KEEP, now, observation.time)
        elif self._plan is None or observation.time >= self._begins > -math.inf:
            self._begins = -math.inf
            self._start(CODES[self.action], now, observation.time)
        assert self._plan is not None
        self._travelled += observation.speed * (observation.time - self._time)
        self._time = observation.time
        return Control(*follow_plan(self._plan, self._travelled, now))

    def _start(self, code: int, now: SeenRoad, time: float) -> None:
        self._plan, self._travelled, self._time = plan_action(code, now), 0.0, time
        if code == KEEP and self.cruise is not None:
            self._plan = self._plan._replace(goal=self.cruise)


class Cruise(ActionDriver):
    """Keeps lane and speed, and ignores everything else."""

    _repr_fields = ()

    def __init__(self) -> None:
        super().__init__("keep_speed")


@checked
def action_driver(action_id: str, reaction_s: float = 0.0) -> Driver:
    """Return a new driver that executes one discrete action.

    Args:
        action_id: One of `oodscen.data._episode.ACTIONS`.
        reaction_s: Time for which the ego keeps lane and speed before the action begins, s.

    Raises:
        UnknownComponent: If there is no such action.
        UsageError: If the reaction time is negative or longer than `LONGEST_REACTION_S`.
    """
    if action_id not in CODES:
        raise UnknownComponent("action", action_id, CODES)
    return ActionDriver(action_id, finite_number("reaction_s", reaction_s, 0.0, LONGEST_REACTION_S))


def is_available(action_id: str, observation: Observation) -> bool:
    """Return whether the lane that an action needs exists; an oncoming lane counts.

    Raises:
        UnknownComponent: If there is no such action.
    """
    if action_id not in CODES:
        raise UnknownComponent("action", action_id, CODES)
    if action_id == "change_lane_left":
        return observation.lane_left_m is not None
    if action_id == "change_lane_right":
        return observation.lane_right_m is not None
    return True
