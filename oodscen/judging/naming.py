"""Read which aspect a model names where it is not asked whether there is one: the paper's task one."""

import re
from collections.abc import Mapping
from typing import Any

from oodscen.judging.descriptions import joined
from oodscen.judging.detection import read_aspect
from oodscen.judging.patterns import compiled
from oodscen.judging.reading import LONGEST, Reading, disputed, member, told, too_long

_KEYS = ("aspect", "ood_aspect", "unusual_aspect", "answer", "label")
_MOST_WORDS = 20
"""An answer without any mark is taken as a name up to this length."""


def names_nothing(aspect: str) -> bool:
    """Whether an aspect is empty, or says that there is none."""
    return not aspect.strip() or _NOTHING.search(aspect) is not None


_NOTHING = compiled(
    r"^\W*(?:none|nothing|nil|no|n/?a|not applicable|unknown)\W*$",
    r"^\W*(?:there (?:is|are) )?(?:none|nothing|no)\b.{0,40}\b(?:unusual|ordinary|ood|distribution|aspects?|anomal\w+)\W*$",
    flags=re.IGNORECASE,
)


def read_named_aspect(text: str) -> Reading[str]:
    """Read the aspect that was named; empty where the answer says that there is none."""
    if len(text) > LONGEST:
        return too_long(text)
    given = told(text, _from_object, _KEYS)
    if given.is_disputed:
        return disputed()
    if given.value is not None:
        return _named(given.value, "JSON")
    if given.is_void:
        return Reading(None, "unparsed", "no aspect")
    marked = _MARKED.findall(text)
    if marked:
        return _named(marked[-1], "prose: marked")
    found = read_aspect(text)
    if found.outcome == "refused":
        return Reading(None, "refused", found.note)
    if found.value is not None:
        return Reading(found.value.aspect, "answered", found.note)
    words = re.findall(r"\w+", text)
    if words and len(words) <= _MOST_WORDS and "{" not in text:
        return _named(text, "prose: short")
    return Reading(None, "unparsed", "no aspect is named")


_MARKED = re.compile(r"\baspect\b[^:\n{}\"]{0,30}[:=]\W*([^\n]*\w[^\n]*)", re.IGNORECASE)


def _named(said: str, how: str) -> Reading[str]:
    aspect = said.strip(" \t\r\n\"'*_.`")
    return Reading("" if names_nothing(aspect) else aspect, "answered", how)


def _from_object(value: Mapping[str, Any]) -> str | None:
    found = member(value, _KEYS)
    if isinstance(found, dict):
        return _from_object(found)
    said = "" if found is None else joined(found)
    return said if re.search(r"\w", said) else None
