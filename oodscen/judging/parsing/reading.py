"""The JSON objects in an answer, what becomes of an answer, and refusals."""

import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from oodscen.extraction import Found, cleaned, scan
from oodscen.judging.parsing.text import LONGEST, folded, spoken, tidied

Value = TypeVar("Value")


@dataclass(frozen=True)
class Reading(Generic[Value]):
    """What an answer came to."""

    value: Value | None
    """`None` unless the outcome is `answered`."""
    outcome: Literal["answered", "refused", "unparsed"]
    note: str
    """How it was found, or why there is none: `JSON`, `prose`, `two answers`."""


class UnusableError(ValueError):
    """What was asked for has its place in an answer, and nothing usable, or two things, are in it."""


TWO_ANSWERS = "two answers"


def read(
    text: str,
    pick: Callable[[Mapping[str, Any]], Value | None],
    prose: Callable[[str], Value | None],
) -> Reading[Value]:
    """Read an answer from its JSON, else from its prose.

    Args:
        text: A model's words.
        pick: Returns what one object answers; `None` where it lacks the member that was asked for. Raises
            `UnusableError`.
        prose: Returns what tidied prose answers, `None` where nothing. Raises `UnusableError`.
    """
    if len(text) > LONGEST:
        return Reading(None, "unparsed", f"it has {len(text):,} characters; {LONGEST:,} at most")
    note = "no answer is named plainly"
    try:
        said = spoken_json(text)
        value = _in_objects(said, pick)
        if value is not None:
            return Reading(value, "answered", "JSON")
        value = prose(tidied(_without_objects(said)))
        if value is not None:
            return Reading(value, "answered", "prose")
    except UnusableError as error:
        note = str(error)
    if is_refusal(text):
        return Reading(None, "refused", "a refusal")
    return Reading(None, "unparsed", note)


# ------------------------------------------------------------------ objects


def spoken_json(text: str) -> str:
    """Return what is said outside the reasoning, taken out of the one JSON string that it may be."""
    said = cleaned(spoken(text))
    if said.startswith('"'):
        try:
            inner = json.loads(said, strict=False)
        except (ValueError, RecursionError):
            return said
        return spoken(inner) if isinstance(inner, str) else said
    return said if '"' in said else re.sub("[\u201c\u201d]", '"', said)


def _in_objects(said: str, pick: Callable[[Mapping[str, Any]], Value | None]) -> Value | None:
    """Return what the last object with the member that was asked for answers."""
    found, broken_off = scan(said)
    if broken_off is not None:
        raise UnusableError("the answer is cut off before its end")
    if len(found) > _MOST_OBJECTS:
        raise UnusableError(f"it has {len(found)} JSON objects")
    answer: Value | UnusableError | None = None
    end = 0
    for one, before, after in _with_surroundings(said, found):
        if _QUOTED_BEFORE.search(before[-60:]) or _QUOTED_AFTER.match(after):
            continue
        try:
            value: Value | UnusableError | None = pick(one.value)
            if value is not None and one.is_mended and _lost_words(one, said):
                value = UnusableError("the JSON object has faults")
        except UnusableError as error:
            value = error
        if value is None:
            continue
        is_open = answer is not None and not isinstance(answer, UnusableError) and answer != value
        if is_open and not _CORRECTED.search(said[end : one.start]):
            value = UnusableError(TWO_ANSWERS)
        answer, end = value, one.start + one.width
    if isinstance(answer, UnusableError):
        raise answer
    if answer is not None and _CORRECTED.search(said[end:]):
        raise UnusableError("it is taken back after the JSON object")
    return answer


_MOST_OBJECTS = 50


def _with_surroundings(said: str, found: list[Found]) -> Iterator[tuple[Found, str, str]]:
    """Yield each object with the text between it and its neighbours."""
    edges = [0, *(edge for one in found for edge in (one.start, one.start + one.width)), len(said)]
    for index, one in enumerate(found):
        before, after = edges[2 * index : 2 * index + 2], edges[2 * index + 2 : 2 * index + 4]
        yield one, said[slice(*before)], said[slice(*after)]


_QUOTED_BEFORE = re.compile(
    r"\b(?:not|n't|never|wrong|incorrect|bad|worst|unsafe|example|e\.g\.|format|template|schema|like"
    r"|instead of|rather than|opposite|if|unless|or|either|could|might|should i|would have)\b[^.!?\n]*$"
    r"|\"\s*:\s*$",
    re.IGNORECASE,
)
"""Stands before an object that is not given as the answer."""
_QUOTED_AFTER = re.compile(
    r"[\s`'\")]*(?:is|isn't|was|wasn't|would|wouldn't|could|might|may|if|unless|or)\b",
    re.IGNORECASE,
)
_CORRECTED = re.compile(
    r"(?:^|[.,;:!?\n(\u2014`-])\s*(?:oh,? )?(?:wait|actually|no|nope|hmm+|correct(?:ion|ed)|edit|sorry|oops|but|however"
    r"|instead|finally|final answer|final decision|on (?:second thou?ght|reflection)|scratch|strike|not|revis\w+|better)\b"
    r"|\b(?:wrong|incorrect|mistake\w*|take (?:that|it) back|change my (?:mind|answer)|disregard|ignore (?:that|this)"
    r"|reconsider\w*|just kidding|joking|opposite of)\b",
    re.IGNORECASE,
)
"""Takes back what was said before it, or announces what counts."""


def _lost_words(one: Found, said: str) -> bool:
    """Whether mending an object dropped words of it, such as one of two values."""
    source = _COMMENT.sub(" ", said[one.start : one.start + one.width])
    kept = json.dumps(one.value, ensure_ascii=False, default=str)
    return bool(_words(source) - _words(kept))


_COMMENT = re.compile(r"//[^\n]*|/\*[^*]*\*/")


def _words(text: str) -> Counter[str]:
    return Counter(re.findall(r"\w+|[!~]", text.casefold().replace("none", "null")))


def _without_objects(said: str) -> str:
    parts, end = [], 0
    for one in scan(said)[0]:
        parts.append(said[end : one.start])
        end = one.start + one.width
    return "\n".join([*parts, said[end:]])


def spelt(name: str) -> str:
    """Return the name of a member without regard to how it is spelt."""
    return re.sub(r"[\W_]+", "", name).casefold()


def members(value: Mapping[str, Any], names: re.Pattern[str]) -> list[Any]:
    """Return the values of the members of such a name.

    Raises:
        UnusableError: When one of them is there twice with different values.
    """
    repeated = getattr(value, "repeated", ())
    if any(names.fullmatch(spelt(name)) for name in repeated):
        raise UnusableError(TWO_ANSWERS)
    return [one for name, one in value.items() if names.fullmatch(spelt(name))]


def is_placeholder(value: object) -> bool:
    """Whether a value is that of the question's example: `"..."`."""
    return isinstance(value, str) and bool(re.fullmatch(r"\s*(?:\.\.\.|\u2026|<[^<>]*>)\s*", value))


def words_in(value: object, depth: int = 3) -> str:
    """Return the words in a value, whatever they are arranged in."""
    if isinstance(value, str):
        return value.strip()
    inner = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(inner, (list, tuple)) or not depth:
        return ""
    return "; ".join(filter(None, (words_in(one, depth - 1) for one in inner)))


def reasoning_in(text: str) -> str:
    """Return the reasons given with an answer: the member of its JSON, else all that is said."""
    if len(text) > LONGEST:
        return ""
    said = spoken_json(text)
    for one in reversed(scan(said)[0]):
        return "; ".join(
            words_in(one.value[name]) for name in one.value if spelt(name) == "reasoning"
        )
    return said


# ------------------------------------------------------------------ refusals


def is_refusal(text: str) -> bool:
    """Whether a model declines to answer, or cannot see what it is asked about."""
    return bool(_REFUSAL.search(folded(tidied(spoken(text[:20_000])))))


_CANNOT = (
    r"\bi(?:'m| am| have decided)? (?:\w+ )?(?:can ?not|can't|couldn't|won't|will not|do not|don't|unable to|not able to"
    r"|not (?:allowed|permitted|comfortable|going) to|not to|decline to|refuse to)"
)
_PICTURES = r"(?:images?|pictures?|frames?|photos?|videos?|attachments?)"
_REFUSAL = re.compile(
    rf"{_CANNOT} (?:(?!know |have |think )\w+ ){{0,2}}(?:assist|help|comply|answer|fulfil|engage|participate|respond|feel comfortable)\b(?! but\b)"
    rf"|{_CANNOT} (?:choose|pick|provide|offer|give|make|tell) (?:an?|any|you|one|guidance|driving|real)\b(?! (?:if|whether) it\b)"
    rf"|{_CANNOT} (?:\w+ )?(?:view|see|access|open|process|describe|analy[sz]e|interpret) (?:\w+ ){{0,2}}{_PICTURES}\b(?! (?:well|clearly)\b)"
    rf"|{_CANNOT} identify what is in (?:\w+ )?{_PICTURES}"
    rf"|\bi have no access to (?:\w+ )?{_PICTURES}|\bno {_PICTURES} (?:\w+ )?(?:provided|attached|uploaded|received|included)\b"
    r"|\bi (?:must|have to) (?:\w+ )?(?:decline|refuse)\b(?! to \w+\b)|\bi(?:'m| am| do| feel) not (?:feel )?comfortable (?:\w+ing|with)\b"
    r"|\bas an? (?:ai )?(?:large )?language model\b|\bagainst (?:my|our|the) (?:policy|policies|guidelines)\b"
)
