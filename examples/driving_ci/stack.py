"""A toy driving stack: it keeps its lane and brakes when the gap to what is ahead becomes small."""

import numpy as np

from oodscen import make_driver
from oodscen.protocols import Control, Driver, Observation, State

BRAKES_AT_M = 15.0
"""A change of this number is what the tests of the repository are for: 5 m is too late."""
LANE_M = 1.8
"""Half the width of the region that counts as the lane."""


class Stack:
    """The stack under test; every drive gets a new one."""

    def __init__(self) -> None:
        self._driver: Driver = make_driver("keep_speed")
        self._brakes = False

    def look(self, state: State) -> None:
        """Perceive: the gap to the nearest actor ahead in the lane."""
        if self._brakes or state.places is None:
            return
        ahead, aside = (state.places[1:] - state.places[0]).T
        is_in_lane = (ahead > 0) & (np.abs(aside) < LANE_M)
        if state.gaps[1:][is_in_lane].min(initial=np.inf) < BRAKES_AT_M:
            self._driver, self._brakes = make_driver("emergency_brake"), True

    def act(self, observation: Observation) -> Control:
        """Return the control for the next step."""
        return self._driver.act(observation)
