"""What every reader of a model's words shares: the part that counts, objects in it, refusals."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from oodscen.extraction import find_objects, is_cut_off
from oodscen.judging.languages import REFUSAL
from oodscen.judging.meaning import CORRECTIONS
from oodscen.judging.patterns import compiled, either, few
from oodscen.judging.wording import normalise

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
    """How it was found, or why there is none: `JSON`, `prose: chosen`, `two answers: ...`."""


def disputed() -> Reading[Any]:
    """Return the reading of an answer whose objects contradict each other (see `Told`)."""
    return Reading(None, "unparsed", f"{TWO_ANSWERS}, each in JSON")


def too_long(text: str) -> Reading[Any]:
    """Return what becomes of an answer that is too long to be read."""
    return Reading(None, "unparsed", f"{len(text):,} characters; {LONGEST:,} at most are read")


# ------------------------------------------------------------------ what counts as said


def spoken(text: str) -> str:
    """Return what follows the thinking; thinking that never ends counts only where it concludes."""
    closed = [match.end() for match in _THOUGHT_ENDS.finditer(text)]
    opened = _THOUGHT_BEGINS.search(text)
    if closed and text[closed[-1] :].strip():
        text = text[closed[-1] :]
    elif closed and opened and opened.start() < closed[-1]:
        return text[: opened.start()]
    opened = _THOUGHT_BEGINS.search(text)
    if opened:
        thought = text[opened.end() :]
        given = _ANSWER_IS.search(thought)
        text = text[: opened.start()] + (thought[given.start() :] if given else "")
    return text


_THINKING = r"(?:think|thinking|thought|reasoning|reflection|scratchpad|analysis)"
_THOUGHT_BEGINS = re.compile(rf"<\s?{_THINKING}\s?>|\[THINK\]|\u25c1think\u25b7", re.IGNORECASE)
_THOUGHT_ENDS = re.compile(
    rf"<\s?/\s?{_THINKING}\s?>|\[/THINK\]|\u25c1/think\u25b7"
    r"|<\|channel\|>\s?final\s?<\|message\|>",
    re.IGNORECASE,
)
_ANSWER_IS = re.compile(r"(?:final\s)?answer\s?(?:is|:)", re.IGNORECASE)


def tail(text: str) -> str:
    """Return the prose after the thinking, shortened in its middle."""
    text = spoken(text)
    if len(text) > PROSE:
        text = f"{text[:2_000]}\n{text[2_000 - PROSE :]}"
    return _CONTROL_TOKENS.sub(" ", text)


_CONTROL_TOKENS = re.compile(r"<\|[a-z_]+\|>|</?s>|\[/?INST\]")

# ------------------------------------------------------------------ objects


def objects(text: str) -> Iterator[Mapping[str, Any]]:
    """Yield the whole objects of JSON after the thinking, the likeliest answer first, or of XML."""
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
    """Whether an object before it tells something else, and no word in between takes it back."""
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
    gap = (_BETWEEN_OBJECTS.findall(said) or [""])[-1]
    differ = any(value != values[0] for value in values)
    after = normalise(said.rpartition("}")[2][:PROSE])
    return Told(
        values[0],
        is_disputed=differ and bool(_NO_WORDS.fullmatch(gap)),
        corrected=after if CORRECTIONS.search(after) else "",
    )


_BETWEEN_OBJECTS = re.compile(r"\}([^{}]*)\{")
_NO_WORDS = re.compile(r"(?:[\W_]|\b(?:json|or|and|oder|ou)\b)*", re.IGNORECASE)


def _is_void(value: Mapping[str, Any], keys: Sequence[str]) -> bool:
    """Whether an object has a place for what was asked for, with more than dots in it."""
    places = {_spelling(name) for name in keys}
    held = [one for key, one in _spelt(value).items() if key in places]
    return bool(held) and not (isinstance(held[0], str) and re.fullmatch(r"\W+", held[0]))


def _is_cut_before(said: str, keys: Sequence[str]) -> bool:
    """Whether an answer that should be an object ends before what was asked for."""
    start = re.search(r"\{\s*[\"']", said)
    if not start or not is_cut_off(said):
        return False
    names = "|".join(re.escape(key).replace("_", "_?") for key in keys)
    return not re.search(rf"\b(?:{names})[\"']?\s*[:=]", said[start.start() :], re.IGNORECASE)


# ------------------------------------------------------------------ refusals


def is_refusal(text: str) -> bool:
    """Whether a model declines to answer, or cannot see what it is asked about."""
    plain = normalise(tail(text[:20_000]))
    return bool(_REFUSAL.search(plain) or REFUSAL.search(plain))


_CANNOT = either(
    r"can *not|can't|could *n[o']t|won't|will not|do not|don't",
    r"unable to|not able to|not (?:allowed|permitted) to|decline to|refuse to",
)
_PICTURES = r"(?:image|picture|frame|photo|visual|video|attachment|attached)"
_REFUSAL = compiled(
    r"\b"
    + either(
        r"i *(?:'m|am) (?:\w+ )?(?:sorry|afraid)\b",
        r"i (?:must (?:\w+ )?|have to )?(?:decline|refuse)\b",
        r"as an? (?:ai|(?:large )?language|text based)",
        rf"{_CANNOT} {few(2)}"
        + either(
            r"assist|help|comply|provide|answer|fulfil+|engage|participate|support|respond|offer",
            r"process|analy[sz]e|interpret|determine|identify|recommend|tell|say",
            r"choose|select|pick|make (?:\w+ )?(?:decision|choice)s?",
            r"feel comfortable|give (?:driving )?advice",
        )
        # an answer that hesitates: "I cannot tell whether it is a deer"
        + r"\b(?! (?:which|whether|if|from)\b)",
        rf"{_CANNOT} (?:(?:actually|directly|currently|really) )?"
        r"(?:view|see|access|open|display|look at|receive|have access)\b"
        rf"(?: \w+){{0,3}}? {_PICTURES}",
        rf"no access to (?:\w+ )?{_PICTURES}",
        rf"(?:no|any) {_PICTURES}s? {few(2)}"
        r"(?:provided|attached|visible|uploaded|received|shown|included)",
        rf"(?:provide|upload|attach|share) (?:the|an?|your|some) {_PICTURES}",
        r"(?:unable|not able) to (?:view|see)\b",
        r"not comfortable (?:\w+ing|with)\b",
        r"against (?:my|our|the) (?:policy|policies|guidelines)|content policy",
    )
)
