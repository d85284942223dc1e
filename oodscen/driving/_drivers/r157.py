"""The competent and careful human driver of UN Regulation No. 157, as a reference driver."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from oodscen.driving._drivers.braking import DECELERATION, DELAY_S
from oodscen.driving._drivers.perception import Neighbour
from oodscen.driving._drivers.watching import HEADWAY_S, WatchingDriver
from oodscen.driving._motion.bodies import GRAVITY
from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.protocols import Observation

WANDER_M = 0.375
"""Sideways move from its usual place beyond which a body is perceived to leave its lane, m."""
EVALUATION_S = 0.4
"""Time from the perceived move to the end of the risk's evaluation, s."""
CRITICAL_TTC_S = 2.0
"""Time to collision below which a perceived body is a risk, s."""
HARD_BRAKING = 5.0
"""Deceleration of a leader that is a risk within the headway, m/s^2."""
WRAPPED_DECELERATION = 0.85 * GRAVITY
"""Full braking once the body is in front of the whole width of the ego, m/s^2."""
RELEASE_TTC_S = 4.0
"""Time to collision above which the driver releases the brake, s."""
_STILL = 0.1
"""Speed across the road below which a body keeps its place in its lane, m/s."""
_PASSED_M = 10.0
"""Way beyond a body's rear after which the ego has passed it, m."""
_SETTLED_S = 1.0
"""Time after which such a place becomes the body's usual place, s."""


@dataclass
class _Memory:
    """The driver's memory of one body."""

    home: float
    """Its usual offset on the road, m."""
    still_since: float
    """Time since which it has kept its offset, s."""
    noticed_at: float | None = None
    """Time at which it was perceived to leave its lane or found in the way, s."""
    braked_at: float | None = None
    """Time since which it has been braking hard, s."""


class R157Driver(WatchingDriver):
    """The careful and competent human driver of UN Regulation No. 157, with perfect eyesight.

    The performance model of Annex 4, Appendix 3 (ECE/TRANS/WP.29/2020/81): a move of more than 0.375 m
    out of its lane is perceived, evaluated for 0.4 s, and answered 0.75 s later by braking that rises to
    0.774 g in 0.6 s (0.85 g once the other vehicle is wholly in front), scaled by the road's friction. A
    risk is a time to collision below 2.0 s (as in esmini and in JRC-FSM, its published implementations), or
    a leader within 2.0 s of headway that brakes harder than 5 m/s^2.

    The Regulation leaves ordinary driving open. Here it is the intelligent driver model with a headway of
    2.0 s and braking of at most 3 m/s^2, which follows a body only after the same times of evaluation and
    delay. The driver knows the true positions within the visual range and never steers around a body.
    """

    def __init__(self) -> None:
        super().__init__()
        self._memories: dict[str, _Memory] = {}

    def _emergency(self, seen: Sequence[Neighbour], observation: Observation) -> float:
        time, speed = observation.time, observation.speed
        self._remember(seen, time)
        risks = [neighbour for neighbour in seen if self._is_risk(neighbour, time, speed)]
        is_wrapped = any(abs(risk.aside) <= WANDER_M for risk in risks)
        return self._brake.deceleration(
            time,
            demanded=bool(risks),
            limit=WRAPPED_DECELERATION if is_wrapped else DECELERATION,
            friction=observation.friction,
        )

    def _minded(self, seen: Sequence[Neighbour], time: float) -> Iterable[Neighbour]:
        evaluated = EVALUATION_S + DELAY_S
        return (
            neighbour
            for neighbour in super()._minded(seen, time)
            if _is_past(self._memories[neighbour.id].noticed_at, evaluated, time)
        )

    def _remember(self, seen: Sequence[Neighbour], time: float) -> None:
        """Note which bodies have left their places, stand in the way or brake hard."""
        for neighbour in seen:
            memory = self._memories.get(neighbour.id)
            if memory is None:
                memory = _Memory(neighbour.place, time)
                if neighbour.is_in_the_way:
                    memory.noticed_at = -math.inf
                self._memories[neighbour.id] = memory
            if abs(neighbour.across) > _STILL:
                memory.still_since = time
            elif time - memory.still_since >= _SETTLED_S:
                memory.home = neighbour.place
            if not neighbour.is_in_the_way and not _approaches(neighbour, memory):
                memory.noticed_at = None
            elif memory.noticed_at is None:
                memory.noticed_at = time
            if neighbour.acceleration > -HARD_BRAKING:
                memory.braked_at = None
            elif memory.braked_at is None:
                memory.braked_at = time

    def _is_risk(self, neighbour: Neighbour, time: float, speed: float) -> bool:
        """Return whether a body has been evaluated as a risk."""
        memory = self._memories[neighbour.id]
        if not _is_past(memory.noticed_at, EVALUATION_S, time):
            return False
        if neighbour.is_in_the_way and _is_past(memory.braked_at, EVALUATION_S, time):
            if neighbour.gap < HEADWAY_S * speed and neighbour.along < speed:
                return True
        elif not neighbour.is_in_the_way and not _arrives(neighbour, speed):
            return False
        limit = RELEASE_TTC_S if self._brake.is_demanded else CRITICAL_TTC_S
        return neighbour.time_to_collision(speed) < limit


def _approaches(neighbour: Neighbour, memory: _Memory) -> bool:
    """Return whether a body beside the ego's way has left its place towards it."""
    if neighbour.aside * neighbour.across >= 0.0:
        return False
    return abs(neighbour.place - memory.home) > WANDER_M


def _arrives(neighbour: Neighbour, speed: float) -> bool:
    """Return whether a body that moves sideways is in the way before the ego has passed it."""
    closing = speed - neighbour.along
    passing_s = (neighbour.gap + _PASSED_M) / closing if closing > 0.0 else math.inf
    return neighbour.clearance <= abs(neighbour.across) * passing_s


def _is_past(since: float | None, seconds: float, time: float) -> bool:
    return since is not None and time >= since + seconds - ROUNDING_S
