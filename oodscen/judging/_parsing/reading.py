"""Finds the JSON objects in an answer, parses the answer from them or its prose, and detects refusals."""

import json
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from oodscen.judging._parsing.surroundings import (
    RETRACTED,
    is_doubtful,
    leads_to_an_answer,
    runs_on,
    split_reasons,
    takes_back,
)
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
class ParsedAnswer(Generic[Value]):
    """A parsed answer."""

    value: Value | None
    """`None` unless the outcome is `answered`."""
    outcome: Literal["answered", "refused", "unparsed"]
    note: str
    """The source of the value, or the reason for its absence: `JSON`, `prose`, `two answers`."""


@dataclass(frozen=True)
class Question(Generic[Value]):
    """The way to find the answer to one question."""

    pick: Callable[[Mapping[str, Any]], Value | None]
    """Returns the answer in one object; `None` if it lacks the requested member. Raises `UnusableError`."""
    prose: Callable[[str], Value | None]
    """Returns the answer in tidied prose; `None` if there is none. Raises `UnusableError`."""
    members: re.Pattern[str]
    """Matches the names of the members that hold the answer, as `spelt` spells them."""
    named: Callable[[str], Set[Value]] | None = None
    """For a choice from a list: returns the options that tidied prose names, in whatever way."""
    denies: Callable[[str, Value], bool] | None = None
    """For a choice from a list: returns whether tidied reasons rule an option out."""

    def answer_in(self, one: Found, said: str) -> tuple[Value | None, str]:
        """Return the answer in one object of a text, and the reason why one that it has cannot be used."""
        try:
            value = self.pick(one.value)
        except UnusableError as error:
            return None, str(error)
        if value is None:
            return None, ""
        fault = ""
        if one.is_mended and _lost_words(one, said):
            fault = "the JSON object has faults"
        elif _is_annulled(one.value, self.members):
            fault = "another member puts the answer in doubt"
        elif self.denies and self.denies(tidied(_reasons(one.value)), value):
            fault = "its reasons rule the answer out"
        return None if fault else value, fault


def read(text: str, question: Question[Value]) -> ParsedAnswer[Value]:
    """Parse an answer from its JSON, else from its prose."""
    if len(text) > LONGEST:
        return ParsedAnswer(
            None, "unparsed", f"it has {len(text):,} characters; {LONGEST:,} at most"
        )
    note = "no answer is named plainly"
    try:
        said = spoken_json(text)
        value = _in_objects(said, question)
        if value is not None:
            return ParsedAnswer(value, "answered", "JSON")
        value = question.prose(tidied("\n".join(_between(said, scan(said)[0]))))
        if value is not None:
            return ParsedAnswer(value, "answered", "prose")
    except UnusableError as error:
        note = str(error)
    if is_refusal(text):
        return ParsedAnswer(None, "refused", "a refusal")
    return ParsedAnswer(None, "unparsed", note)


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


def _in_objects(said: str, question: Question[Value]) -> Value | None:
    """Return the answer in the last object that is given as one; `None` if no object has the requested member."""
    found, broken_off = scan(said)
    if broken_off is not None:
        raise UnusableError("the answer is cut off before its end")
    if len(found) > _MOST_OBJECTS:
        raise UnusableError(f"it has {len(found)} JSON objects")
    between = _between(said, found)
    picked = [question.answer_in(one, said) for one in found]
    holding = [index for index, (value, fault) in enumerate(picked) if value is not None or fault]
    given = [
        index
        for index in holding
        if leads_to_an_answer(between[index], "".join(between[:index]))
        and not runs_on(between[index + 1])
    ]
    if not holding:
        return None
    if not given:
        raise UnusableError("the JSON object is not given as the answer")
    last = given[-1]
    value, fault = picked[last]
    if value is None:
        raise UnusableError(fault)
    for index in given[:-1]:
        is_other = not picked[index][1] and picked[index][0] != value
        if is_other and not RETRACTED.search("\n".join(between[index + 1 : last + 1])):
            raise UnusableError(TWO_ANSWERS)
    told, reasons = split_reasons("\n".join(between[last + 1 :]))
    if last < len(found) - 1 or takes_back(told) or RETRACTED.search(reasons):
        raise UnusableError("it is taken back after the JSON object")
    if question.named and question.named(told) - {value}:
        raise UnusableError(TWO_ANSWERS)
    if question.denies and question.denies(reasons, value):
        raise UnusableError("its reasons rule the answer out")
    return value


def _between(said: str, found: Sequence[Found]) -> list[str]:
    """Return the texts before, between and after the objects."""
    parts, end = [], 0
    for one in found:
        parts.append(said[end : one.start])
        end = one.start + one.width
    return [*parts, said[end:]]


def _is_annulled(value: Mapping[str, Any], asked: re.Pattern[str], depth: int = 6) -> bool:
    """Return whether a member beside the answer is a truth value, or a note that may deny the answer."""
    for name, held in value.items():
        if _REASON.fullmatch(spelt(name)):
            continue
        for one in held if isinstance(held, list) else [held]:
            if isinstance(one, dict):
                if not depth or _is_annulled(one, asked, depth - 1):
                    return True
            elif not asked.fullmatch(spelt(name)) and (
                isinstance(one, (bool, list))
                or (isinstance(one, str) and is_doubtful(one))
                or (isinstance(one, (int, float)) and _DENYING.search(spelt(name)))
            ):
                return True
    return False


_DENYING = re.compile(r"not|neg|wrong|invalid|reject|false|fake|cancel|revoke|retract|void")
"""Matches the names of members whose number may deny the answer."""


def _reasons(value: Mapping[str, Any], depth: int = 6) -> str:
    """Return the reasons in an object and in the objects that it wraps."""
    found = [words_in(one) for name, one in value.items() if _REASON.fullmatch(spelt(name))]
    inner = [one for one in value.values() if isinstance(one, dict) and depth]
    return "\n".join([*found, *(_reasons(one, depth - 1) for one in inner)])


_REASON = re.compile(
    r"(?:step\w*|chainof)?(?:reason(?:s|ing)?|rationale|thoughts?|thinking|analysis|explanation|justification"
    r"|descriptions?|observations?|details)"
)
"""Matches the members that give reasons, in which other options may be weighed."""

_MOST_OBJECTS = 50


def _lost_words(one: Found, said: str) -> bool:
    """Return whether repairing an object dropped some of its words, such as one of two values, or a fence."""
    source = _COMMENT.sub(" ", said[one.start : one.start + one.width])
    kept = json.dumps(one.value, ensure_ascii=False, default=str)
    return "```" in source or bool(_words(source) - _words(kept))


_COMMENT = re.compile(r"//[^\n]*|/\*[^*]*\*/")


def _words(text: str) -> Counter[str]:
    return Counter(re.findall(r"\w+|[!~]", text.casefold().replace("none", "null")))


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
