"""Decimal numbers, shares, times and speeds as text."""

from decimal import ROUND_HALF_UP, Decimal


def exact(value: float) -> str:
    """Return a number as the shortest text that reads back as the same number."""
    return repr(float(value)).removesuffix(".0")


def fine_percent(share: float) -> str:
    """Return a share in whole per cent; a small one, as rare kinds have, is not called none, nor the rest all."""
    nearest = min(share, 1.0 - share)
    if 0.0 < nearest < 0.001:
        return "<0.1%" if share < 0.5 else ">99.9%"
    return f"{share:.1%}" if 0.0 < nearest < 0.01 else f"{share:.0%}"


def tenths(value: float) -> str:
    """Return a number with one decimal; halves go away from zero, also where the binary number lies just below.

    The steps of a simulation end in five hundredths, so halves are common: 6.35 is "6.4", as people round.
    """
    if not abs(value) < 1e15:
        return f"{value:.1f}"
    decimal = Decimal(repr(round(value, 9) + 0.0))
    return str(decimal.quantize(Decimal("0.1"), ROUND_HALF_UP) + 0)


def seconds(value: float) -> str:
    """Return a time in s as text."""
    return f"{tenths(value)} s"


def speed(value: float) -> str:
    """Return a speed in m/s as text, with km/h beside it."""
    return f"{tenths(value)} m/s ({3.6 * value:z.0f} km/h)"
