"""Finds the JSON objects in an answer, parses the answer from them or its prose, and detects refusals."""

import json
import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from oodscen.judging._parsing.text import (
    LONGEST,
    TWO_ANSWERS,
    UnusableError,
    folded,
    spoken,
    tidied,
)
from oodscen.llm._json_objects import Found, cleaned, scan

Value = TypeVar("Value")


@dataclass(frozen=True)
class Reading(Generic[Value]):
    """A parsed answer."""

    value: Value | None
    """`None` unless the outcome is `answered`."""
    outcome: Literal["answered", "refused", "unparsed"]
    note: str
    """The source of the value, or the reason for its absence: `JSON`, `prose`, `two answers`."""


def read(
    text: str,
    pick: Callable[[Mapping[str, Any]], Value | None],
    prose: Callable[[str], Value | None],
    *,
    is_closed: bool = False,
) -> Reading[Value]:
    """Parse an answer from its JSON, else from its prose.

    Args:
        text: A model's answer.
        pick: Returns the answer in one object; `None` if it lacks the requested member. Raises
            `UnusableError`.
        prose: Returns the answer in tidied prose; `None` if there is none. Raises `UnusableError`.
        is_closed: Whether prose after an object that answers something else contradicts it.
    """
    if len(text) > LONGEST:
        return Reading(None, "unparsed", f"it has {len(text):,} characters; {LONGEST:,} at most")
    note = "no answer is named plainly"
    try:
        said = spoken_json(text)
        value, after = _in_objects(said, pick)
        if value is not None:
            if is_closed and prose(tidied(after)) not in (None, value):
                raise UnusableError(TWO_ANSWERS)
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
    """Return the text outside the reasoning, unwrapped if all of it is one JSON string."""
    said = cleaned(spoken(text))
    if said.startswith('"'):
        try:
            inner = json.loads(said, strict=False)
        except (ValueError, RecursionError):
            return said
        return spoken(inner) if isinstance(inner, str) else said
    return said if '"' in said else re.sub("[\u201c\u201d]", '"', said)


def _in_objects(
    said: str, pick: Callable[[Mapping[str, Any]], Value | None]
) -> tuple[Value | None, str]:
    """Return the answer in the last object with the requested member, and the text after that object."""
    found, broken_off = scan(said)
    if broken_off is not None:
        raise UnusableError("the answer is cut off before its end")
    if len(found) > _MOST_OBJECTS:
        raise UnusableError(f"it has {len(found)} JSON objects")
    answers: list[tuple[Value | UnusableError, int, int]] = []
    edges = [0, *(edge for one in found for edge in (one.start, one.start + one.width)), len(said)]
    for index, one in enumerate(found):
        before, start, end, after = edges[2 * index : 2 * index + 4]
        if _QUOTED_BEFORE.search(said[max(before, start - 60) : start]) or _QUOTED_AFTER.match(
            said[end:after]
        ):
            continue
        try:
            value: Value | UnusableError | None = pick(one.value)
            if value is not None and one.is_mended and _lost_words(one, said):
                value = UnusableError("the JSON object has faults")
        except UnusableError as error:
            value = error
        if value is not None:
            answers.append((value, start, end))
    if not answers:
        return None, ""
    last, start, end = answers[-1]
    if isinstance(last, UnusableError):
        raise last
    for value, _, stop in answers[:-1]:
        is_other = value != last and not isinstance(value, UnusableError)
        if is_other and not _CORRECTED.search(said[stop:start]):
            raise UnusableError(TWO_ANSWERS)
    if _CORRECTED.search(said[end:]):
        raise UnusableError("it is taken back after the JSON object")
    return last, said[end:]


_MOST_OBJECTS = 50

_QUOTED_BEFORE = re.compile(
    r"\b(?:not|n't|never|wrong|incorrect|bad|worst|unsafe|example|e\.g\.|format|template|schema|like"
    r"|instead of|rather than|opposite|if|unless|or|either|could|might|should i|would have)\b[^.!?\n]*$"
    r"|\"\s*:\s*$",
    re.IGNORECASE,
)
"""Matches words before an object that is not given as the answer."""
_QUOTED_AFTER = re.compile(
    r"[\s`'\")]*(?:is|isn't|was|wasn't|would|wouldn't|could|might|may|if|unless|or)\b",
    re.IGNORECASE,
)
_CORRECTED = re.compile(
    r"(?:^|[.,;:!?\n(\u2014`-])\s*(?:oh,? )?(?:wait|actually|no|nope|hmm+|correct(?:ion|ed)|edit|sorry|oops|but"
    r"|however|instead|finally|final (?:answer|decision)|on (?:second thou?ght|reflection)|scratch|strike|not"
    r"|revis\w+|better)\b|\b(?:wrong|incorrect|mistake\w*|take (?:that|it) back|change my (?:mind|answer)"
    r"|disregard|disagree|(?:do not|don't) do (?:this|that)|ignore (?:that|this)|reconsider\w*|just kidding|joking|opposite of)\b",
    re.IGNORECASE,
)
"""Matches words that retract the text before them, or announce the real answer."""


def _lost_words(one: Found, said: str) -> bool:
    """Return whether repairing an object dropped some of its words, such as one of two values."""
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
    """Return the name of a member in a canonical spelling."""
    return re.sub(r"[\W_]+", "", name).casefold()


def members(value: Mapping[str, Any], names: re.Pattern[str]) -> list[Any]:
    """Return the values of the members whose names match.

    Raises:
        UnusableError: If one of them occurs twice with different values.
    """
    repeated = getattr(value, "repeated", ())
    if any(names.fullmatch(spelt(name)) for name in repeated):
        raise UnusableError(TWO_ANSWERS)
    return [one for name, one in value.items() if names.fullmatch(spelt(name))]


def unwrapped(
    value: Mapping[str, Any], names: re.Pattern[str], depth: int = 4
) -> Mapping[str, Any]:
    """Return the object whose member names match: this one, or the one that it wraps."""
    held = members(value, names)
    inner = [one for one in members(value, _WRAPPERS) if isinstance(one, dict)]
    if depth and len(inner) == 1 and (not held or held == inner):
        found = unwrapped(inner[0], names, depth - 1)
        return found if members(found, names) else value
    return value


_WRAPPERS = re.compile(
    r"(?:final|json|data|arguments|parameters|properties)?(?:answer|response|result|output|assessment)?"
)


def is_placeholder(value: object) -> bool:
    """Return whether a value is a placeholder from the question's example, such as `"..."`."""
    return isinstance(value, str) and bool(re.fullmatch(r"\s*(?:\.\.\.|\u2026|<[^<>]*>)\s*", value))


def words_in(value: object, depth: int = 3) -> str:
    """Return the words in a value, whatever its structure."""
    if isinstance(value, str):
        return value.strip()
    inner = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(inner, (list, tuple)) or not depth:
        return ""
    return "; ".join(filter(None, (words_in(one, depth - 1) for one in inner)))


def reasoning_in(text: str) -> str:
    """Return the reasons given with an answer: that member of its JSON, else the whole text."""
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
    """Return whether a model declines to answer, or cannot see the picture."""
    return bool(_REFUSAL.search(folded(tidied(spoken(text[:20_000])))))


_CANNOT = (
    r"\bi(?:'m| am| have decided)? (?:\w+ )?(?:can ?not|can't|won't|will not|do not|don't|unable to|not able to"
    r"|not (?:allowed|permitted|comfortable) to|not to|decline to|refuse to)"
)
_PICTURES = r"(?:image|picture|frame|photo|video|attachment)s?"
_REFUSAL = re.compile(
    rf"{_CANNOT} (?:(?!know |have |think )\w+ ){{0,2}}(?:assist|help|comply|answer|respond|feel comfortable)\b(?! but\b)"
    rf"|{_CANNOT} (?:choose|provide|give|make|tell|offer) (?:an?|any|you|driving|guidance|real)\b"
    rf"|{_CANNOT} (?:\w+ )?(?:view|see|access|describe|analy[sz]e|identify) (?:\w+ ){{0,4}}{_PICTURES}\b(?! (?:well|clearly)\b)"
    rf"|\bi have no access to (?:\w+ )?{_PICTURES}|\bi (?:must|have to) decline\b|\bas an? (?:ai )?language model\b"
)
