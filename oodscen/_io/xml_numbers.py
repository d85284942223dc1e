"""Numbers as XML Schema writes them, which allows fewer than Python does: no `1_000`, no `inf`, only ASCII digits."""

import math
import re

UNSIGNED = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
"""Pattern of a finite number without its sign."""
_DOUBLE = re.compile(rf"[+-]?{UNSIGNED}")
BLANKS = " \t\r\n"
"""The characters that XML Schema strips from a number."""


def double(text: str) -> float:
    """Return the number that a text is.

    Raises:
        ValueError: If it is none, or not finite.
    """
    plain = text.strip(BLANKS)
    if not _DOUBLE.fullmatch(plain) or not math.isfinite(value := float(plain)):
        raise ValueError(f"{text[:40]!r} is not a finite number")
    return value
