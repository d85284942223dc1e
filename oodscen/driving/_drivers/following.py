"""Car following by the intelligent driver model, which reference drivers share."""

LEAST_DESIRED = 0.1
"""Least desired speed that the model divides by, m/s."""
_LEAST_GAP_M = 0.1
"""Least gap that the model divides by, m."""


def following_acceleration(
    speed: float,
    desired: float,
    gap: float,
    closing: float,
    *,
    headway_s: float,
    standing_m: float,
    comfortable: float,
) -> float:
    """Return the acceleration of the intelligent driver model, m/s^2.

    Source: Treiber, Hennecke and Helbing, "Congested traffic states in empirical observations and
    microscopic simulations", 2000.

    Args:
        speed: The ego's speed, m/s.
        desired: The speed that it would drive alone, m/s.
        gap: Gap to the body ahead, m.
        closing: Speed at which the gap closes, m/s.
        headway_s: Desired time headway, s.
        standing_m: Gap at a standstill, m.
        comfortable: Comfortable acceleration and deceleration, m/s^2.
    """
    moving_m = max(0.0, speed * headway_s + speed * closing / (2.0 * comfortable))
    gap_ratio = (standing_m + moving_m) / max(gap, _LEAST_GAP_M)
    free_ratio = (speed / desired) ** 4
    return comfortable * (1.0 - free_ratio - gap_ratio * gap_ratio)
