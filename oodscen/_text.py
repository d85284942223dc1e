"""Makes text from outside safe for files, pages and terminals."""

import re
import unicodedata

_HALVES = re.compile("[\ud800-\udfff]")

_UNSEEN = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Control characters except tabs and line breaks, and characters that change the writing direction."""

BLANK = "\u115f\u1160\u2800\u3164\uffa0"
"""Letters and symbols without a visible glyph."""


def whole(text: str) -> str:
    """Replace lone surrogates, which UTF-8 cannot encode; valid pairs are joined."""
    if not _HALVES.search(text):
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")


def plain(text: str) -> str:
    r"""Escape characters that could control a terminal, e.g. as `\u001b`; tabs and line breaks stay."""
    return _UNSEEN.sub(lambda found: f"\\u{ord(found[0]):04x}", whole(text))


def one_line(text: str) -> str:
    """Return the text on one line: runs of white space become single spaces, and the ends are stripped."""
    return " ".join(text.split())


def is_visible(text: str) -> bool:
    """Return whether the text has at least one visible character."""
    return any(unicodedata.category(char)[0] in "LNPS" and char not in BLANK for char in text)
