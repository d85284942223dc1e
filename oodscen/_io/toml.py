"""TOML parsing for outside data, with one-line errors."""

import tomllib
from typing import Any


def parse_toml(text: str) -> dict[str, Any]:
    """Parse a TOML document.

    Raises:
        ValueError: With a one-line message, also for what nests too deep and for numbers with too many digits.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise ValueError("is nested too deep") from None
    except ValueError:  # Python's own limit for whole numbers.
        raise ValueError("a number has too many digits") from None
