"""Car following by the intelligent driver model, which reference drivers share."""

LEAST_DESIRED = 0.1
"""Least speed that a driver desires, m/s: the model divides by it."""


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
    wanted = standing_m + max(0.0, speed * headway_s + speed * closing / (2.0 * comfortable))
    ratio = wanted / max(gap, 0.1)
    free = (speed / desired) ** 4
    return comfortable * (1.0 - free - ratio * ratio)
