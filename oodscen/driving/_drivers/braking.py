"""Emergency braking after a delay, with a ramp, which reference drivers share."""

from oodscen.driving._motion.bodies import GRAVITY
from oodscen.driving._motion.triggers import ROUNDING_S

DELAY_S = 0.75
"""Time from the recognised risk to the begin of braking, s."""
DECELERATION = 0.774 * GRAVITY
"""Full braking on dry asphalt, m/s^2."""
RAMP_S = 0.6
"""Time from the begin of braking to full braking, s: a jerk of 12.65 m/s^3."""


class DelayedBrake:
    """Begins to brake some time after the first call that demands it, and ramps up to a limit.

    Args:
        delay_s: Time from the first demand to the begin of braking, s.
    """

    def __init__(self, delay_s: float = DELAY_S) -> None:
        self.delay_s = delay_s
        self._demanded_at: float | None = None
        self._braked_at: float | None = None

    @property
    def is_demanded(self) -> bool:
        """Return whether the last call demanded braking."""
        return self._demanded_at is not None

    def deceleration(
        self, time: float, *, demanded: bool, limit: float = DECELERATION, friction: float = 1.0
    ) -> float:
        """Return the deceleration from now to the next step, m/s^2; 0 while it does not brake.

        Args:
            time: Seconds since the start of the drive.
            demanded: True while there is a risk; the brake is released when it ends.
            limit: Full braking on dry asphalt, m/s^2.
            friction: Friction scale of the road.
        """
        if not demanded:
            self._demanded_at = self._braked_at = None
            return 0.0
        if self._demanded_at is None:
            self._demanded_at = time
        if time < self._demanded_at + self.delay_s - ROUNDING_S:
            return 0.0
        if self._braked_at is None:
            self._braked_at = time
        share = (time - self._braked_at) / RAMP_S
        return min(1.0, share) * limit * min(1.0, friction)
