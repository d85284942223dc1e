"""Numbers that a caller gives: neither text nor not-a-number nor out of range."""

import math
from numbers import Integral, Real
from typing import Any

from oodscen.errors import UsageError

MOST = 1_000_000
"""Most of what is counted: more would run for years, or not fit in memory."""


def whole_number(name: str, value: Any, least: int = 0, most: int = MOST) -> int:
    """Return a whole number in a range, ends included.

    Raises:
        UsageError: When it is something else.
    """
    if isinstance(value, Integral) and not isinstance(value, bool):
        number = int(value)
        if least <= number <= most:
            return number
    raise UsageError(
        f"{name} must be a whole number from {least:,} to {most:,}, not {_said(value)}"
    )


def finite_number(name: str, value: Any, least: float = -math.inf, most: float = math.inf) -> float:
    """Return a finite number in a range, ends included.

    Raises:
        UsageError: When it is something else.
    """
    is_number = isinstance(value, Real) and not isinstance(value, bool)
    try:
        if is_number and math.isfinite(value) and least <= value <= most:
            return float(value)
    except OverflowError:
        pass
    between = "" if math.isinf(least) and math.isinf(most) else f" from {least:g} to {most:g}"
    raise UsageError(f"{name} must be a finite number{between}, not {_said(value)}")


def _said(value: Any) -> str:
    """Return a value, short enough for a message; Python refuses to print some numbers."""
    try:
        return f"{value!r:.40}"
    except ValueError:
        return "a number of thousands of digits"
