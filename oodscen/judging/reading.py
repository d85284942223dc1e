"""What every reader of a model's words shares: the part that counts, objects in it, refusals."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from oodscen.extraction import find_objects, is_cut_off
from oodscen.judging.languages import REFUSAL
from oodscen.judging.wording import CORRECTIONS, normalise

Value = TypeVar("Value")

LONGEST = 200_000
"""Longer answers are not read, in characters."""

PROSE = 8_000
"""Of longer prose its beginning and its end are read, in characters."""


TWO_ANSWERS = "two answers"
"""How the note begins where a text gives more than one."""


@dataclass(frozen=True)
class Reading(Generic[Value]):
    """What an answer came to."""

    value: Value | None
    """`None` unless the outcome is `answered`."""
    outcome: Literal["answered", "refused", "unparsed"]
    note: str
    """How the answer was found, or why there is none: `JSON`, `prose: chosen`, `two answers: ...`."""


def is_refusal(text: str) -> bool:
    """Whether a model declines to answer, or cannot see what it is asked about."""
    plain = normalise(tail(text[:20_000]))
    return bool(_REFUSAL.search(plain) or re.search(REFUSAL, plain))


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
    """Yield what follows the thinking as objects: whole ones of JSON, the likeliest answer first, or XML."""
    said = spoken(text)
    is_found = False
    for found in find_objects(said):
        is_found = True
        if found.is_complete:
            yield found.value
    if not is_found and (tags := dict(_ELEMENT.findall(said))):
        yield tags


_ELEMENT = re.compile(r"<(\w+)>\s*([^<]+?)\s*</\1>")
"""An XML element without elements in it."""


def member(value: Mapping[str, Any], names: Sequence[str]) -> Any:
    """Return the first member of one of these names, however they are spelt."""
    spelt = _spelt(value)
    return next((spelt[key] for name in names if (key := _spelling(name)) in spelt), None)


def _spelling(name: str) -> str:
    return re.sub(r"[\W_]+", "", name).casefold()


def _spelt(value: Mapping[str, Any]) -> dict[str, Any]:
    return {_spelling(str(key)): one for key, one in value.items()}


@dataclass(frozen=True)
class Told(Generic[Value]):
    """What the objects in an answer tell."""

    value: Value | None = None
    """Of the last object that tells one."""
    is_disputed: bool = False
    """Whether another object before it tells something else, and no word in between takes it back."""
    is_void: bool = False
    """Whether what was asked for has its place there, and nothing usable in it."""
    corrected: str = ""
    """What is said after the last object, where it takes something back; normalised."""


def told(
    text: str, pick: Callable[[Mapping[str, Any]], Value | None], keys: Sequence[str]
) -> Told[Value]:
    """Read the objects in an answer.

    Args:
        text: A model's words.
        pick: Says what one object tells, if anything.
        keys: Where what was asked for has its place.
    """
    said = spoken(text)
    values = []
    is_void = False
    for value in objects(text):
        picked = pick(value)
        if picked is not None:
            values.append(picked)
        else:
            is_void = is_void or _is_void(value, keys)
    if not values:
        return Told(is_void=is_void or _is_cut_before(said, keys))
    gap = (_GAP.findall(said) or [""])[-1]
    is_disputed = any(value != values[0] for value in values) and bool(_NO_WORDS.fullmatch(gap))
    after = normalise(said.rpartition("}")[2][:PROSE])
    return Told(values[0], is_disputed, corrected=after if CORRECTIONS.search(after) else "")


_GAP = re.compile(r"\}([^{}]*)\{")
_NO_WORDS = re.compile(r"(?:[\W_]|\b(?:json|or|and|oder|ou)\b)*", re.IGNORECASE)


def _is_void(value: Mapping[str, Any], keys: Sequence[str]) -> bool:
    """Whether an object has a place for what was asked for, and not just the dots of the question there."""
    told = [one for key, one in _spelt(value).items() if key in {_spelling(name) for name in keys}]
    return bool(told) and not (isinstance(told[0], str) and re.fullmatch(r"\W+", told[0]))


def _is_cut_before(said: str, keys: Sequence[str]) -> bool:
    """Whether an answer that should be an object ends before what was asked for."""
    start = re.search(r"\{\s*[\"']", said)
    if not start or not is_cut_off(said):
        return False
    names = "|".join(re.escape(key) for key in keys)
    return not re.search(rf"\b(?:{names})[\"']?\s*[:=]", said[start.start() :], re.IGNORECASE)


def too_long(text: str) -> Reading[Any]:
    """Return what becomes of an answer that is too long to be read."""
    return Reading(None, "unparsed", f"{len(text):,} characters; {LONGEST:,} at most are read")


_CANNOT = r"(?:can\s*not|can't|could\s*n[o']t|won't|will\s+not|unable\s+to|not\s+able\s+to|do\s+not|don't|not\s+(?:allowed|permitted)\s+to|decline\s+to|refuse\s+to)"
_PICTURES = r"(?:image|picture|frame|photo|visual|video|attachment|attached)"
_REFUSAL = re.compile(
    rf"\b(?:i\s*(?:'m|am)\s+(?:\w+\s+)?(?:sorry|afraid)\b|i\s+(?:must\s+(?:\w+\s+)?|have\s+to\s+)?(?:decline|refuse)\b"
    rf"|as\s+an?\s+(?:ai|(?:large\s+)?language|text\s+based)"
    rf"|{_CANNOT}\s+(?:\w+\s+){{0,2}}?(?:assist|help|comply|provide|answer|process|analy[sz]e|fulfil+|engage|participate|support|respond|offer|feel\s+comfortable|give\s+(?:driving\s+)?advice|make\s+(?:\w+\s+)?(?:decision|choice)s?|choose|select|pick|determine|identify|tell|say|interpret|recommend)\b(?!\s+(?:which|whether|if|from)\b)"
    rf"|{_CANNOT}\s+(?:(?:actually|directly|currently|really)\s+)?(?:view|see|access|open|display|look\s+at|receive|have\s+access)\b(?:\s+\w+){{0,3}}?\s+{_PICTURES}"
    rf"|no\s+access\s+to\s+(?:\w+\s+)?{_PICTURES}|(?:no|any)\s+{_PICTURES}s?\s+(?:\w+\s+){{0,2}}?(?:provided|attached|visible|uploaded|received|shown|included)"
    rf"|(?:provide|upload|attach|share)\s+(?:the|an?|your|some)\s+{_PICTURES}"
    rf"|(?:unable|not\s+able)\s+to\s+(?:view|see)\b|not\s+comfortable\s+(?:\w+ing|with)\b|against\s+(?:my|our|the)\s+(?:policy|policies|guidelines)|content\s+policy)"
)
