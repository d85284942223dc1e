"""The driver that all others are compared with: it follows, and brakes in an emergency."""

import math
from dataclasses import replace

from oodscen._display import Brief
from oodscen._numbers import finite_number
from oodscen.driving._drivers.following import LEAST_DESIRED, following_acceleration
from oodscen.driving._drivers.perception import Perception
from oodscen.driving._motion.actions import Cruise
from oodscen.protocols import Control, Observation, State

_HARDEST = 8.0
"""Deceleration of the emergency braking, and the most of any other, m/s^2."""
_FORESIGHT_S = 1.0
"""Time ahead for which it foresees that a body steps into its path, s."""


class RuleBasedDriver(Brief):
    """Keeps its lane, follows the actor ahead, and brakes hard when it gets close.

    It drives by the intelligent driver model and knows the true positions of all actors within 60 m, as a
    stack with perfect perception would that has no plan but to follow.

    Args:
        headway_s: Time headway, s.
        standing_m: Gap at a standstill, m.
        comfortable: Comfortable acceleration and deceleration, m/s^2.
        emergency_ttc_s: Time to collision below which it brakes hard, s.
        corridor_m: Half the width of the region that counts as ahead, m.

    Raises:
        UsageError: If a number is out of its range.
    """

    def __init__(
        self,
        *,
        headway_s: float = 1.5,
        standing_m: float = 2.5,
        comfortable: float = 2.0,
        emergency_ttc_s: float = 1.6,
        corridor_m: float = 2.1,
    ) -> None:
        self.headway_s = finite_number("headway_s", headway_s, 0.0, 60.0)
        self.standing_m = finite_number("standing_m", standing_m, 0.0, 100.0)
        self.comfortable = finite_number("comfortable", comfortable, 0.1, 10.0)
        self.emergency_ttc_s = finite_number("emergency_ttc_s", emergency_ttc_s, 0.0, 60.0)
        self.corridor_m = finite_number("corridor_m", corridor_m, 0.0, 100.0)
        self._cruise = Cruise()
        self._perception = Perception()
        self._desired: float | None = None
        self._gap, self._closing = math.inf, 0.0

    def look(self, state: State) -> None:
        """Find the nearest body ahead, including one that will step into the path soon."""
        self._gap, self._closing = math.inf, 0.0
        gaps = dict(zip(state.ids, state.gaps.tolist(), strict=True))
        for body in self._perception.look(state):
            right, left = sorted((body.aside, body.aside + body.across * _FORESIGHT_S))
            is_ahead = right <= self.corridor_m and left >= -self.corridor_m
            if is_ahead and gaps[body.id] < self._gap:
                self._gap, self._closing = gaps[body.id], float(state.speeds[0]) - body.along

    def act(self, observation: Observation) -> Control:
        """Follow, brake, or keep the speed."""
        control = self._cruise.act(observation)
        if self._desired is None:
            self._desired = max(observation.speed, LEAST_DESIRED)
        if self._closing > 0 and self._gap / self._closing < self.emergency_ttc_s:
            return replace(control, acceleration=-_HARDEST)
        acceleration = following_acceleration(
            observation.speed,
            self._desired,
            self._gap,
            self._closing,
            headway_s=self.headway_s,
            standing_m=self.standing_m,
            comfortable=self.comfortable,
        )
        acceleration = max(-_HARDEST, min(control.acceleration, acceleration))
        return replace(control, acceleration=acceleration)
