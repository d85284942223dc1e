"""What every reader of a model's words shares: the part that counts, objects in it, refusals."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from oodscen.extraction import find_objects
from oodscen.judging.wording import normalise

Value = TypeVar("Value")

LONGEST = 200_000
"""Longer answers are not read, in characters."""

PROSE = 16_000
"""Of longer prose its beginning and its end are read, in characters."""


@dataclass(frozen=True)
class Reading(Generic[Value]):
    """What an answer came to."""

    value: Value | None
    """`None` unless the outcome is `answered`."""
    outcome: Literal["answered", "refused", "unparsed"]
    note: str
    """How the answer was found, or why there is none: `JSON`, `prose: chosen`, `two answers: ...`."""


def is_refusal(text: str) -> bool:
    """Whether a model declines to answer."""
    return bool(_REFUSAL.search(normalise(tail(text[:20_000]))))


_TAGS = r"(?:think|thinking|thought|reasoning|reflection|scratchpad|analysis)"
_OPEN = re.compile(rf"<\s?{_TAGS}\s?>|\[THINK\]|\u25c1think\u25b7", re.IGNORECASE)
_CLOSED = re.compile(
    rf"<\s?/\s?{_TAGS}\s?>|\[/THINK\]|\u25c1/think\u25b7|<\|channel\|>\s?final\s?<\|message\|>",
    re.IGNORECASE,
)
_GIVEN = re.compile(r"(?:final\s)?answer\s?(?:is|:)", re.IGNORECASE)


def spoken(text: str) -> str:
    """Return what follows the thinking; thinking that never ends counts only where it concludes."""
    closed = [match.end() for match in _CLOSED.finditer(text)]
    opened = _OPEN.search(text)
    if closed and text[closed[-1] :].strip():
        text = text[closed[-1] :]
    elif closed and opened and opened.start() < closed[-1]:
        return text[: opened.start()]
    opened = _OPEN.search(text)
    if opened:
        thought = text[opened.end() :]
        given = _GIVEN.search(thought)
        text = text[: opened.start()] + (thought[given.start() :] if given else "")
    return text


def tail(text: str) -> str:
    """Return the prose after the thinking, shortened in its middle."""
    text = spoken(text)
    if len(text) > PROSE:
        text = f"{text[:2_000]}\n{text[2_000 - PROSE :]}"
    return re.sub(r"<\|[a-z_]+\|>|</?s>|\[/?INST\]", " ", text)


def objects(text: str) -> Iterator[Mapping[str, Any]]:
    """Yield the whole JSON objects in what follows the thinking, the likeliest answer first."""
    for found in find_objects(spoken(text)):
        if found.is_complete:
            yield found.value


def member(value: Mapping[str, Any], names: Sequence[str]) -> Any:
    """Return the first member of one of these names, however they are spelt."""
    spelt = {re.sub(r"[\W_]+", "", str(key)).casefold(): member for key, member in value.items()}
    for name in names:
        if (key := re.sub(r"[\W_]+", "", name).casefold()) in spelt:
            return spelt[key]
    return None


def too_long(text: str) -> Reading[Any]:
    """Return what becomes of an answer that is too long to be read."""
    return Reading(None, "unparsed", f"{len(text):,} characters; {LONGEST:,} at most are read")


_REFUSAL = re.compile(
    r"\b(?:i\s*(?:'m|am)\s+(?:sorry|unable|not\s+able|afraid)|i\s+(?:can\s*not|can't|cannot|won't|will\s+not|must\s+decline|decline|refuse|do\s+not\s+feel|don't\s+feel|am\s+not\s+(?:allowed|permitted))"
    r"|as\s+an?\s+(?:ai|language\s+model|large\s+language)|(?:unable|not\s+able)\s+to\s+(?:assist|help|comply|provide|answer|process|view|see|analy[sz]e|determine)"
    r"|against\s+(?:my|our|the)\s+(?:policy|policies|guidelines)|cannot\s+(?:assist|help|comply|fulfil+|provide|process)|can't\s+(?:assist|help|comply|provide)|no\s+(?:image|picture|frame)s?\s+(?:was|were|is|are)\s+(?:provided|attached|visible))\b"
)
