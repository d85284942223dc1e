"""Checks of texts."""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

from oodscen._words.text import is_visible
from oodscen.data._base import Data
from oodscen.data._scenario import Scenario
from oodscen.errors import DataError, Issue

MAX_CHARACTERS = 1_000_000
"""The longest text that is measured, in characters; a longer one comes from a file without line ends."""

_MOST_ISSUES = 20
_NO_SEQUENCES = (str, bytes, bytearray, Data, Iterator, Mapping, Set)
"""Iterables that are one value, have no order, or are gone once they are read."""


def check_texts(texts: Sequence[str | Scenario], noun: str = "text set") -> tuple[str, ...]:
    """Return the texts as strings, after checking each with `fault_of`.

    Raises:
        DataError: If the texts are no sequence or there is none; otherwise with an issue for each text
            that is no string, is blank or too long, holds a NUL character, or is not valid Unicode.
    """
    if not is_ordered(texts) or getattr(texts, "ndim", 1) != 1:
        fault = f"is {type(texts).__name__}, not a sequence of texts"
        raise DataError(noun, [Issue("", fault)])
    strings = [item.text if isinstance(item, Scenario) else item for item in texts]
    faults = enumerate(map(fault_of, strings))
    refuse(noun, [Issue(f"[{index}]", fault) for index, fault in faults if fault])
    if not strings:
        raise DataError(noun, [Issue("", "holds no text")])
    return tuple(strings)


def is_ordered(values: object) -> bool:
    """Return whether a value holds elements in an order and can be read more than once."""
    return isinstance(values, Iterable) and not isinstance(values, _NO_SEQUENCES)


def fault_of(text: object) -> str:
    """Return the reason why a value is not a usable text; empty if it is one."""
    if not isinstance(text, str):
        return f"is {type(text).__name__}, not a text"
    if not is_visible(text):
        return "is blank"
    if len(text) > MAX_CHARACTERS:
        return f"has {len(text):,} characters, and a text has at most {MAX_CHARACTERS:,}"
    if "\0" in text:
        return "holds a NUL character, as UTF-16 does where it is read as UTF-8"
    try:
        text.encode()
    except UnicodeEncodeError:
        return "is not valid Unicode: it holds half of a surrogate pair"
    return ""


def refuse(noun: str, issues: Iterable[Issue], *, source: str = "") -> None:
    """Raise a `DataError` if there are issues; a long list is cut after the first ones."""
    issues = list(issues)
    if len(issues) > _MOST_ISSUES:
        rest = len(issues) - _MOST_ISSUES
        issues = [*issues[:_MOST_ISSUES], Issue("", f"and {rest} more like these")]
    if issues:
        raise DataError(noun, issues, source=source)
