"""Answers that must not be read."""

LONGEST = 200_000
"""The longest answer that is parsed, in characters."""

TWO_ANSWERS = "two answers"


class UnusableError(ValueError):
    """An answer that must not be read, with the reason."""
