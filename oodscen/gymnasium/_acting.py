"""Actions of an environment: two numbers, or one of the seven discrete actions."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._numbers import said
from oodscen.data._episode import ACTIONS
from oodscen.driving._motion.actions import ActionDriver
from oodscen.driving._motion.bodies import GRAVITY, MAX_DRIVE, MAX_STEERING
from oodscen.errors import UsageError
from oodscen.gymnasium._extra import gymnasium
from oodscen.gymnasium._observing import Space
from oodscen.protocols import Control, Observation


def action_space(kind: str) -> Space:
    """Return the space of a kind of action: `continuous` or `discrete`."""
    if kind == "discrete":
        return gymnasium.spaces.Discrete(len(ACTIONS))
    return gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)


def as_control(action: NDArray[np.float64]) -> Control:
    """Return the control of a continuous action; values beyond -1..1 count as the nearest of them.

    -1 brakes with the deceleration of gravity, 1 accelerates with all that the motor has.
    """
    along, turn = np.clip(action, -1.0, 1.0).tolist()
    return Control(along * (GRAVITY if along < 0.0 else MAX_DRIVE), turn * MAX_STEERING)


def as_action(control: Control) -> NDArray[np.float32]:
    """Return the continuous action of a control, within -1..1."""
    along = control.acceleration / (GRAVITY if control.acceleration < 0.0 else MAX_DRIVE)
    values = np.array([along, control.steering / MAX_STEERING], np.float32)
    return np.minimum(np.maximum(values, np.float32(-1.0)), np.float32(1.0))


def read_continuous(action: Any, source: str) -> NDArray[np.float64]:
    """Return a continuous action as two finite numbers; `source` is the method that took or returned it.

    Raises:
        UsageError: If it is anything else.
    """
    try:
        values = np.asarray(action)
        if values.dtype.kind not in "fiuO" or values.shape != (2,):
            raise TypeError
        values = values.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(
            f"{source}: an action must be two numbers, not {said(action, 80)}"
        ) from None
    if not np.isfinite(values).all():
        raise UsageError(f"{source}: an action must be finite, not {said(action, 80)}")
    return values


def read_discrete(action: Any, source: str) -> str:
    """Return the id of a discrete action from its number; `source` is the method that took or returned it.

    Raises:
        UsageError: If it is not a whole number, or no such action exists.
    """
    try:
        number = np.asarray(action)
    except ValueError:  # It is a ragged sequence.
        number = np.empty(0)
    if number.ndim or number.dtype.kind not in "iu" or not 0 <= number < len(ACTIONS):
        actions = ", ".join(f"{code} {name}" for code, name in enumerate(ACTIONS))
        raise UsageError(f"{source}: unknown action {said(action, 80)}; the actions are {actions}")
    return ACTIONS[int(number)]


class ActionDecoder:
    """Turns the actions of one episode into controls, one per step of the simulator."""

    def __init__(self, kind: str) -> None:
        self._kind = kind
        self._control = Control()
        self._manoeuvres = Manoeuvres()

    def begin(self, action: Any, now: Observation, source: str) -> None:
        """Take an action, which holds until the next one.

        Raises:
            UsageError: If it is not an action.
        """
        if self._kind == "discrete":
            self._manoeuvres.begin(read_discrete(action, source), now)
        else:
            self._control = as_control(read_continuous(action, source))

    def control(self, now: Observation) -> Control:
        """Return the control for the next step of the simulator."""
        return self._manoeuvres.control(now) if self._kind == "discrete" else self._control


class Manoeuvres:
    """Executes discrete actions one after another.

    A repeated action continues; a different one begins in the ego's lane at that time. `keep_speed` returns to the
    speed at the start.
    """

    def __init__(self) -> None:
        self._action: str | None = None
        self._driver = ActionDriver("keep_speed")
        self._cruise_mps: float | None = None
        self._begin_m = 0.0
        """Offset of the lane in which the action began, from the lane in which the ego started."""
        self._end_m = 0.0
        """Offset at which the action ends."""

    def begin(self, action: str, now: Observation) -> None:
        """Begin an action, or go on with it."""
        if self._cruise_mps is None:
            self._cruise_mps = now.speed
        if action == self._action:
            return
        self._begin_m = min(
            self._begin_m, self._end_m, key=lambda lane_m: abs(lane_m - now.offset_m)
        )
        ends_m = {
            "change_lane_left": now.lane_left_m,
            "change_lane_right": now.lane_right_m,
            "pull_over": now.roadside_m,
        }
        end_m = ends_m.get(action)
        self._end_m = self._begin_m if end_m is None else end_m
        self._action = action
        self._driver = ActionDriver(action, cruise=self._cruise_mps)

    def control(self, now: Observation) -> Control:
        """Return the control for the next step, relative to the lane in which the action began."""
        centre = self._begin_m
        left, right = now.lane_left_m, now.lane_right_m
        return self._driver.act(
            replace(
                now,
                offset_m=now.offset_m - centre,
                lane_left_m=None if left is None else left - centre,
                lane_right_m=None if right is None else right - centre,
                roadside_m=now.roadside_m - centre,
            )
        )
