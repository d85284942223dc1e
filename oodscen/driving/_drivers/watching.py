"""Drivers that keep their lane, follow what is ahead, and brake in an emergency: what reference drivers share."""

import math
from abc import abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import replace

from oodscen._display import Brief
from oodscen.driving._drivers.braking import DELAY_S, DelayedBrake
from oodscen.driving._drivers.following import LEAST_DESIRED, following_acceleration
from oodscen.driving._drivers.perception import Neighbour, Perception
from oodscen.driving._motion.actions import Cruise
from oodscen.protocols import Control, Observation, State

HEADWAY_S = 2.0
"""Time headway of ordinary following, s."""
_STANDING_M, _COMFORTABLE, _MILDEST = 2.5, 2.0, 3.0
"""Gap at a standstill, m; comfortable acceleration and limit of comfortable braking, m/s^2."""


class WatchingDriver(Brief):
    """Knows the true positions within the visual range and never steers around a body.

    Ordinary driving is the intelligent driver model with a headway of 2.0 s and braking of at most 3 m/s^2.

    Args:
        delay_s: Time from an emergency to the beginning of the braking, s.
    """

    def __init__(self, delay_s: float = DELAY_S) -> None:
        self._cruise = Cruise()
        self._perception = Perception()
        self._brake = DelayedBrake(delay_s)
        self._desired: float | None = None
        self._state: State | None = None

    def look(self, state: State) -> None:
        """Take the true state."""
        self._state = state

    def act(self, observation: Observation) -> Control:
        """Follow, brake in an emergency, or keep the speed."""
        control = self._cruise.act(observation)
        if self._desired is None:
            self._desired = max(observation.speed, LEAST_DESIRED)
        if self._state is None:
            return control
        seen = self._perception.look(self._state, observation.visual_range_m)
        deceleration = self._emergency(seen, observation)
        following = (
            following_acceleration(
                observation.speed,
                self._desired,
                neighbour.gap,
                observation.speed - neighbour.along,
                headway_s=HEADWAY_S,
                standing_m=_STANDING_M,
                comfortable=_COMFORTABLE,
            )
            for neighbour in self._minded(seen, observation.time)
        )
        comfortable = max(-_MILDEST, min(following, default=math.inf))
        acceleration = min(control.acceleration, comfortable)
        if deceleration > 0.0:
            acceleration = min(acceleration, -deceleration)
        return replace(control, acceleration=acceleration)

    @abstractmethod
    def _emergency(self, seen: Sequence[Neighbour], observation: Observation) -> float:
        """Return the deceleration of the emergency braking, m/s^2; 0 without one."""

    def _minded(self, seen: Sequence[Neighbour], time: float) -> Iterable[Neighbour]:
        """Return the bodies that the driver follows."""
        return (neighbour for neighbour in seen if neighbour.is_in_the_way)
