"""Text from outside: what no file, page or terminal can take is made harmless."""

import re
import unicodedata

_HALVES = re.compile("[\ud800-\udfff]")

_UNSEEN = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Control characters but tabs and line breaks, and those that turn the direction of writing."""

BLANK = "\u115f\u1160\u2800\u3164\uffa0"
"""Letters and symbols that show nothing."""


def whole(text: str) -> str:
    """Replace halves of surrogate pairs, which UTF-8 cannot hold; two that belong together are joined."""
    if not _HALVES.search(text):
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")


def plain(text: str) -> str:
    r"""Write what could steer a terminal as escapes such as `\u001b`; tabs and line breaks stay."""
    return _UNSEEN.sub(lambda found: f"\\u{ord(found[0]):04x}", whole(text))


def one_line(text: str) -> str:
    """Return a text with single spaces for line breaks and runs of spaces, and none around it."""
    return " ".join(text.split())


def is_visible(text: str) -> bool:
    """Whether a text has at least one character that shows."""
    return any(unicodedata.category(char)[0] in "LNPS" and char not in BLANK for char in text)
