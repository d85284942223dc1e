"""Shares, their intervals and their differences as text."""

from typing import Protocol

from oodscen.statistics._intervals import Interval

GAP = "\N{NO-BREAK SPACE}"
_TO = "\N{WORD JOINER}–\N{WORD JOINER}"
"""A dash without a line break around it."""


class WithInterval(Protocol):
    """A figure that may have an interval."""

    @property
    def interval(self) -> Interval | None:
        """Its interval."""


def percent(value: float | None) -> str:
    """Return a share in whole per cent."""
    return "–" if value is None else f"{100 * value:.0f}{GAP}%"


def bracketed(share: WithInterval) -> str:
    """Return the interval of a share in brackets; empty without one."""
    if share.interval is None:
        return ""
    low, high = 100 * share.interval.low, 100 * share.interval.high
    return f" [{low:.0f}{_TO}{high:.0f}{GAP}%]"


def bracketed_points(difference: WithInterval) -> str:
    """Return the interval of a difference of two shares in brackets, in percentage points; empty without one."""
    if difference.interval is None:
        return ""
    low, high = map(_points, (difference.interval.low, difference.interval.high))
    return f" [{low}{_TO}{high}]"


def _points(difference: float) -> str:
    """Return a difference of two shares as whole percentage points with a sign."""
    points = round(100 * difference)
    return f"{points:+d}".replace("-", "\N{MINUS SIGN}") if points else "0"


def lead(difference: float, other: str) -> str:
    """Return the lead over another answerer or driver in words, in percentage points."""
    points = round(100 * difference)
    if not points:
        return f"as many as {other}"
    size = number_of(abs(points), "percentage point")
    return f"{size} {'more' if points > 0 else 'fewer'} than {other}"


def number_of(count: int, noun: str) -> str:
    """Return a count with its noun: `1 scene`, `2 scenes`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
