"""Keep credentials out of everything that is shown or written."""

import os
import re
from collections.abc import Iterable

HIDDEN = "[redacted]"

_SECRET_VARIABLE = re.compile(r"(KEY|TOKEN|SECRET|PASSWORD|CREDENTIALS?)$", re.IGNORECASE)
_SHAPES = re.compile(
    r"""
      (?<![A-Za-z0-9]) (?: sk | pk | rk | gsk | xai | hf | r8 | pplx | nvapi ) [-_] [\w-]{8,}
    | (?<![A-Za-z0-9]) AIza [\w-]{20,}
    | (?<![A-Za-z0-9]) (?: AKIA | ASIA ) [A-Z0-9]{12,}
    | (?<![A-Za-z0-9]) eyJ [\w-]{8,} \. [\w-]{8,} \. [\w-]*
    | (?<= :// ) [^/\s@]+ (?= @ )
    | (?i: (?<= bearer\s ) [^\s"',;]{6,} )
    | (?i: (?<= [?&]key= ) [^\s&"']+ )
    """,
    re.VERBOSE,
)

_SHORTEST = 8
"""A value shorter than this is no credential, and replacing it would garble ordinary text."""


def redact(text: str, known: Iterable[str] = ()) -> str:
    """Replace credentials in a text.

    Hidden are the given values, the values of environment variables whose names end in KEY, TOKEN,
    SECRET, PASSWORD or CREDENTIALS, and what is shaped like a provider's key or a bearer token.
    """
    return _SHAPES.sub(HIDDEN, _without({*_secrets(), *known}, text, _SHORTEST))


def redact_keys(text: str, known: Iterable[str] = ()) -> str:
    """Replace only credentials that are known, and long: for what a model says, which is content."""
    return _without({*_secrets(), *known}, text, 2 * _SHORTEST)


def _secrets() -> list[str]:
    return [value for name, value in os.environ.items() if _SECRET_VARIABLE.search(name)]


def _without(values: Iterable[str], text: str, shortest: int) -> str:
    for value in sorted(values, key=len, reverse=True):
        if len(value) >= shortest:
            text = text.replace(value, HIDDEN)
    return text
