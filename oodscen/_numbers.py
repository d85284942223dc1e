"""Checks of numbers from the caller: type, finiteness and range."""

import math
from contextlib import suppress
from numbers import Integral, Real
from typing import Any

from oodscen._seeding import MAX_SEED
from oodscen.errors import UsageError

MOST = 1_000_000
"""Upper limit of counts: more would run for years or not fit in memory."""


def whole_number(name: str, value: Any, least: int = 0, most: int = MOST) -> int:
    """Return `value` as an integer if it is a whole number in the range, ends included.

    Raises:
        UsageError: If it is anything else.
    """
    number = plain_number(value)
    if isinstance(number, int) and not isinstance(number, bool) and least <= number <= most:
        return int(number)
    raise UsageError(f"{name} must be a whole number from {least:,} to {most:,}, not {said(value)}")


def plain_number(value: Any) -> Any:
    """Return a number of another library as Python's, whose integers cannot overflow; anything else as it is."""
    if type(value) in (int, float, bool) or isinstance(value, bool) or not isinstance(value, Real):
        return value
    try:
        return int(value) if isinstance(value, Integral) else float(value)
    except (OverflowError, TypeError, ValueError):
        return value


def seed_number(value: Any) -> int:
    """Return a seed as an integer.

    Raises:
        UsageError: If it is negative, too large or not a whole number.
    """
    return whole_number("seed", value, 0, MAX_SEED)


def finite_number(name: str, value: Any, least: float = -math.inf, most: float = math.inf) -> float:
    """Return `value` as a float if it is finite and in the range, ends included.

    Raises:
        UsageError: If it is anything else.
    """
    number = plain_number(value)
    if isinstance(number, int | float) and not isinstance(number, bool):
        with suppress(OverflowError):
            if math.isfinite(number) and least <= number <= most:
                return float(number)
    raise UsageError(f"{name} must be a finite number{_within(least, most)}, not {said(value)}")


def _within(least: float, most: float) -> str:
    """Return the words for a range, led by a space; empty for all numbers."""
    if math.isinf(most):
        return "" if math.isinf(least) else f" of at least {least:.10g}"
    return f" of at most {most:.10g}" if math.isinf(least) else f" from {least:.10g} to {most:.10g}"


def said(value: Any, most: int = 40) -> str:
    """Return a value as text, short enough for a message, or else its type: lists may be nested too deeply to print."""
    try:
        return f"{value!r:.{most}}"
    except Exception:
        if isinstance(value, Integral):  # Python refuses to print huge ones.
            return "a number of thousands of digits"
        return f"a value of type {type(value).__name__}"
