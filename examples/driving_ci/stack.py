"""A toy driving stack: it keeps its lane and brakes when the gap ahead becomes small."""

from oodscen.driving import action_driver
from oodscen.protocols import Control, Driver, Observation, State

BRAKES_AT_M = 15.0
"""A change of this number is what the tests of the repository are for: 5 m is too late."""


class Stack:
    """The stack under test; every drive gets a new one."""

    def __init__(self) -> None:
        self._driver: Driver = action_driver("keep_speed")
        self._brakes = False

    def look(self, state: State) -> None:
        """Perceive: the gaps to all actors, in metres."""
        if not self._brakes and state.gaps[1:].min(initial=float("inf")) < BRAKES_AT_M:
            self._driver, self._brakes = action_driver("emergency_brake"), True

    def act(self, observation: Observation) -> Control:
        """Return the control for the next step."""
        return self._driver.act(observation)
