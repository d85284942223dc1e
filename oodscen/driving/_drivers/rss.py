"""Responsibility-Sensitive Safety: safe distances, proper response, and a driver that obeys them.

Source: Shalev-Shwartz, Shammah and Shashua, "On a formal model of safe and scalable self-driving
cars", arXiv:1708.06374, 2017. The paper fixes no parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

from oodscen._numbers import finite_number
from oodscen.driving._drivers.perception import Neighbour
from oodscen.driving._drivers.watching import WatchingDriver
from oodscen.errors import UnknownComponent
from oodscen.protocols import Observation

_ONCOMING = -0.5
"""Speed along the road below which a body counts as oncoming, m/s."""


@dataclass(frozen=True)
class RSSParameters:
    """The assumptions of RSS about a vehicle, in SI units.

    The defaults are those of the Joint Research Centre's comparison of models for UN Regulation No. 157
    (Mattas et al., "Driver models for the definition of safety requirements of automated vehicles in
    international regulations", 2022; code: ec-jrc/JRC-FSM), but for `correct_braking`, which is that of
    intel/ad-rss-lib.
    """

    response_s: float = 0.75
    """Response time, s."""
    acceleration: float = 3.0
    """Greatest acceleration during the response time, m/s^2."""
    least_braking: float = 6.0
    """Deceleration that a vehicle behind achieves at least after its response time, m/s^2."""
    most_braking: float = 6.0
    """Hardest braking of a vehicle in front, m/s^2."""
    correct_braking: float = 3.0
    """Deceleration that a vehicle in its own lane achieves at least against oncoming traffic, m/s^2."""
    lateral_acceleration: float = 1.0
    """Greatest sideways acceleration during the response time, m/s^2."""
    lateral_braking: float = 1.0
    """Sideways deceleration that a vehicle achieves at least afterwards, m/s^2."""
    margin_m: float = 0.3
    """Sideways fluctuation of both vehicles together, m."""

    def __post_init__(self) -> None:
        for field in fields(self):
            least = 1e-3 if field.name.endswith("braking") else 0.0
            finite_number(f"RSS: {field.name}", getattr(self, field.name), least, 1_000.0)


def longitudinal_distance(rear: float, front: float, parameters: RSSParameters) -> float:
    """Return the safe distance behind a vehicle in the same direction, m (definition 1).

    Args:
        rear: Speed of the vehicle behind, m/s.
        front: Speed of the vehicle in front, m/s.
        parameters: The assumptions about both.
    """
    behind = _stopping(rear, parameters.least_braking, parameters)
    return max(0.0, behind - front * front / (2.0 * parameters.most_braking))


def opposing_distance(own: float, oncoming: float, parameters: RSSParameters) -> float:
    """Return the safe distance to an oncoming vehicle, m (definition 2).

    Args:
        own: Speed of the vehicle in its own lane, m/s.
        oncoming: Speed of the vehicle in the wrong direction, m/s, positive.
        parameters: The assumptions about both.
    """
    return _stopping(own, parameters.correct_braking, parameters) + _stopping(
        oncoming, parameters.least_braking, parameters
    )


def lateral_distance(
    left: float, right: float, of_left: RSSParameters, of_right: RSSParameters
) -> float:
    """Return the safe distance between two vehicles side by side, m (definition 6).

    Args:
        left: Speed of the left vehicle to the right, m/s; negative if it moves away.
        right: Speed of the right vehicle to the right, m/s; positive if it moves away.
        of_left: The assumptions about the left vehicle.
        of_right: The assumptions about the right vehicle.
    """
    margin = 0.5 * (of_left.margin_m + of_right.margin_m)
    return margin + max(0.0, _sideways(left, of_left) + _sideways(-right, of_right))


def _stopping(speed: float, braking: float, parameters: RSSParameters) -> float:
    """Return the distance covered during the response time and while braking to a stop, m."""
    rho, acceleration = parameters.response_s, parameters.acceleration
    after = speed + rho * acceleration
    return rho * 0.5 * (speed + after) + after * after / (2.0 * braking)


def _sideways(speed: float, parameters: RSSParameters) -> float:
    """Return the distance covered towards the other vehicle in the response and while braking, m.

    A vehicle that still moves away after its response is not counted as braking.
    """
    rho = parameters.response_s
    after = speed + rho * parameters.lateral_acceleration
    braked = max(0.0, after)
    return rho * 0.5 * (speed + after) + braked * braked / (2.0 * parameters.lateral_braking)


class RSSDriver(WatchingDriver):
    """Follows in its lane, and gives the proper response of RSS to dangerous situations.

    A situation with a body ahead is dangerous while the distances along and across the road are both
    below their safe ones. The response begins after the response time: braking that rises to 0.774 g in
    0.6 s, scaled by the road's friction, and no steering away from the lane, until the situation is safe.
    This is the reaction in JRC-FSM, also to a body that cuts in. Otherwise the driver follows the
    intelligent driver model with a headway of 2.0 s and braking of at most 3 m/s^2. It knows the true
    positions within the visual range.

    Args:
        **assumptions: Fields of `RSSParameters`; of the ego it is known that it keeps its lane.

    Raises:
        UnknownComponent: If there is no such assumption.
        UsageError: If a number is out of its range.
    """

    def __init__(self, **assumptions: float) -> None:
        names = [field.name for field in fields(RSSParameters)]
        for name in assumptions:
            if name not in names:
                raise UnknownComponent("setting of rss", name, names)
        self.parameters = RSSParameters(**assumptions)
        self._of_ego = replace(self.parameters, lateral_acceleration=0.0)
        super().__init__(self.parameters.response_s)

    def _emergency(self, seen: Sequence[Neighbour], observation: Observation) -> float:
        return self._brake.deceleration(
            observation.time,
            demanded=any(self._is_dangerous(neighbour, observation.speed) for neighbour in seen),
            friction=observation.friction,
        )

    def _is_dangerous(self, neighbour: Neighbour, speed: float) -> bool:
        """Return whether both distances to a body ahead are below their safe ones."""
        if neighbour.along < _ONCOMING:
            safe = opposing_distance(speed, -neighbour.along, self.parameters)
        else:
            safe = longitudinal_distance(speed, max(0.0, neighbour.along), self.parameters)
        if neighbour.gap >= safe:
            return False
        ego_across = self._perception.across
        if neighbour.aside > 0.0:
            safe = lateral_distance(-neighbour.across, -ego_across, self.parameters, self._of_ego)
        else:
            safe = lateral_distance(-ego_across, -neighbour.across, self._of_ego, self.parameters)
        return neighbour.clearance < safe
