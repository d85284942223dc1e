"""Read whether a scene was called out of the ordinary, what it is that is, and how surely."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from oodscen.judging.parsing.reading import (
    TWO_ANSWERS,
    Reading,
    UnusableError,
    is_placeholder,
    is_refusal,
    members,
    read,
    words_in,
)
from oodscen.judging.parsing.text import folded

LONGEST_ASPECT = 300
"""Prose longer than this is no name of an aspect, in characters."""


@dataclass(frozen=True)
class Detected:
    """An answer to whether something is out of the ordinary."""

    is_ood: bool
    aspect: str = ""
    confidence: float | None = None
    """In `is_ood`, 0 to 1."""


def read_aspect(text: str) -> Reading[Detected]:
    """Read whether something was called out of the ordinary, what, and how surely."""
    return read(text, _detected, _detected_in_prose)


def read_named_aspect(text: str) -> Reading[str]:
    """Read the aspect that was named, as the paper asks for it; empty where the answer says that there is none."""
    return read(text, _named, _named_in_prose)


def names_nothing(aspect: str) -> bool:
    """Whether an aspect is empty, or says that there is none."""
    return not aspect.strip() or _NOTHING.search(aspect) is not None


_NOTHING = re.compile(
    r"^\W*(?:none|nothing|nil|no|n/?a|not applicable|unknown)\W*$"
    r"|^\W*(?:there (?:is|are) )?(?:none|nothing|no)\b.{0,40}\b(?:unusual|ordinary|ood|distribution|aspects?|anomal\w+)\W*$",
    re.IGNORECASE,
)

# ------------------------------------------------------------------ in an object

_IS_OOD = re.compile(
    r"(?:is)?(?:ood|outofdistribution|outof(?:the)?ordinary|(?:anything|something)?unusual|anomal(?:y|ous)|abnormal)|answer"
)
_ASPECT = re.compile(r"(?:\w*aspect|what|label)")
_CONFIDENCE = re.compile(r"(?:confidence|certainty|probability)")
_WRAPPERS = re.compile(
    r"(?:final|json|data|arguments|parameters)?(?:answer|response|result|output|assessment)?"
)


def _detected(value: Mapping[str, Any], depth: int = 4) -> Detected | None:
    held = [
        one
        for one in members(value, _IS_OOD)
        if not isinstance(one, dict) and not is_placeholder(one)
    ]
    if not held:
        inner = [one for one in members(value, _WRAPPERS) if isinstance(one, dict)]
        return _detected(inner[0], depth - 1) if len(inner) == 1 and depth else None
    truths = {_truth(one) for one in held}
    if len(truths) > 1:
        raise UnusableError(TWO_ANSWERS)
    is_ood = truths.pop()
    if is_ood is None:
        raise UnusableError(f"{str(held[0])[:80]!r} is neither true nor false")
    sure = members(value, _CONFIDENCE)
    return Detected(
        is_ood, _aspect(value) if is_ood else "", probability(sure[0]) if sure else None
    )


def _aspect(value: Mapping[str, Any]) -> str:
    said = next((words for one in members(value, _ASPECT) if (words := words_in(one))), "")
    if said and not re.search(r"\w", said):
        raise UnusableError("the aspect is not named")
    return said


def _named(value: Mapping[str, Any], depth: int = 4) -> str | None:
    names = re.compile(rf"{_ASPECT.pattern}|answer")
    held = [one for one in members(value, names) if not is_placeholder(one)]
    if (
        len(held) == 1
        and isinstance(held[0], dict)
        and depth
        and (inner := _named(held[0], depth - 1)) is not None
    ):
        return inner
    said = {words_in(one) for one in held} - {""}
    if len(said) > 1:
        raise UnusableError(TWO_ANSWERS)
    if held and not said:
        raise UnusableError("no aspect is named")
    return _name(said.pop()) if said else None


def _name(said: str) -> str:
    if not re.search(r"\w", said):
        raise UnusableError("no aspect is named")
    return "" if names_nothing(said) else said


def _truth(value: object) -> bool | None:
    if isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, (bool, int, float)):
        return bool(value) if value in (0, 1) else None
    return _TRUTHS.get(value.strip(" .!").casefold()) if isinstance(value, str) else None


_TRUTHS = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}

# ------------------------------------------------------------------ confidence


def probability(value: object) -> float | None:
    """Return a stated probability, 0 to 1: 0.8, "80 %", 80 and "8/10" are understood."""
    if isinstance(value, bool):
        return None
    found = _NUMBER.fullmatch(str(value)) if isinstance(value, (int, float, str)) else None
    if not found:
        return None
    number, whole = float(found[1]), found[3] or (100 if found[2] else None)
    if whole is None:
        whole = 100 if 10.0 < number <= 100.0 else 1
    share = number / float(whole) if float(whole) else -1.0
    return share if 0.0 <= share <= 1.0 else None


_NUMBER = re.compile(r"\s*(\d{1,9}(?:\.\d{1,30})?)\s*(?:(%|percent)|(?:/|out of)\s*(\d{1,3}))?\s*")
_CONFIDENT = re.compile(
    r"(?:confidence|certainty)(?: (?:level|is|of|at|about))* ?[:=]? ?(?P<after>\d+(?:\.\d+)?(?: ?(?:%|percent|/ ?10|/ ?100|out of 10))?)"
    r"|\((?P<alone>0?\.\d+|1(?:\.0+)?|\d{1,3} ?%)\)|(?P<before>\d+(?:\.\d+)? ?(?:%|percent)) (?:sure|certain|confident)",
    re.IGNORECASE,
)


def _confidence_in(prose: str) -> float | None:
    """Return the probability that prose states; `None` where it states none, or two."""
    found = {
        probability(one["after"] or one["alone"] or one["before"])
        for one in _CONFIDENT.finditer(prose)
    }
    return found.pop() if len(found) == 1 else None


# ------------------------------------------------------------------ in prose


def _detected_in_prose(prose: str) -> Detected | None:
    """Read a "yes" or "no" that is marked as the answer or opens it, or a sentence that says as much."""
    plain = folded(prose)
    marked = {_TRUTHS[one[1]] for one in _MARKED.finditer(plain)}
    first = _FIRST.match(plain)
    said = marked or ({_TRUTHS[first[1]]} if first else set())
    said |= {False for _ in _ORDINARY.finditer(plain)} | {True for _ in _UNUSUAL.finditer(plain)}
    if len(said) != 1 or _OPEN.search(plain) or (not marked and is_refusal(prose)):
        if len(said) > 1:
            raise UnusableError(TWO_ANSWERS)
        return None
    is_ood = said.pop()
    if first and not marked and not _fits(is_ood, plain[first.end() :]):
        raise UnusableError("what follows yes or no does not fit it")
    confidence = _confidence_in(prose)
    if not is_ood:
        return Detected(False, "", confidence)
    named = _labelled(prose)
    if named is None:
        rest = _CONFIDENT.sub(
            "", prose if marked else re.sub(r"\A\W*\w+\W*", "", prose, count=1) if first else prose
        )
        named = "" if marked else rest.strip(" \n.,:;!()\u2014\u2013-")
        if named and names_nothing(named):
            raise UnusableError("the aspect is not named")
        if len(named) > LONGEST_ASPECT or (marked and len(rest) > LONGEST_ASPECT):
            raise UnusableError("the aspect is not named")
    return Detected(True, "" if names_nothing(named) else named, confidence)


def _fits(is_ood: bool, rest: str) -> bool:
    """Whether the words after a "yes" or "no" go with it."""
    says_usual = bool(_USUAL_WORDS.search(rest))
    return (
        not says_usual
        if is_ood
        else says_usual or not re.search(r"[^\W\d]{2}", _CONFIDENT.sub("", rest))
    )


def _named_in_prose(prose: str) -> str | None:
    named = _labelled(prose)
    if named is not None:
        return _name(named)
    plain = folded(prose)
    is_short = 0 < len(plain.split()) <= 20 and len(re.findall(r"[.!?](?:\s|$)", plain)) <= 1
    if not is_short or is_refusal(prose) or _OPEN.search(plain) or plain.endswith("?"):
        return None
    return _name(_LEAD.sub("", prose).strip(" \n.")) if re.search(r"\w", plain) else None


def _labelled(prose: str) -> str | None:
    found = {one[1].strip(" .'") for one in _LABELLED.finditer(prose)}
    if len(found) > 1:
        raise UnusableError(TWO_ANSWERS)
    return found.pop() if found else None


_LABELLED = re.compile(r"\baspect ?[:=] ?([^\n]*\w[^\n]*)", re.IGNORECASE)
_LEAD = re.compile(
    r"\A\W*(?:the (?:main |one )?(?:ood|unusual|most unusual) (?:aspect|thing) is:? |yes, )",
    re.IGNORECASE,
)
_MARKED = re.compile(
    r"\b(?:(?:is )?(?:ood|out of distribution|out of the ordinary|unusual|anomal(?:y|ous))|answer|verdict) ?\??(?: is)? ?[:=?] ?"
    r"(yes|no|true|false)\b(?! ?(?:or\b|/|,? not\b|\w+ ?(?:is|are)\b))"
)
_FIRST = re.compile(r"\W*(yes|no|true|false)\b(?=\s*(?:[,.:;!\u2014\u2013-]|$))")
_ODD = r"(?:unusual|out of the ordinary|abnormal|anomalous|strange|out of distribution|ood)"
_USUAL = r"(?:normal|ordinary|typical|routine)"
_USUAL_WORDS = re.compile(
    r"(?<!out of the )(?<!not )(?<!n't )(?<!not an )(?<!not a )\b(?:normal|ordinary|usual|typical|routine|nothing|no|none|fine|clear)\b"
)
_ORDINARY = re.compile(
    rf"\bnothing (?:(?:here|that|there|is|looks|seems|appears) ){{0,3}}{_ODD}\b"
    rf"|\b(?:not|isn't|aren't|no|(?:not|n't|cannot) (?:see|identify|notice|find) anything) (?:an? |any |anything )?{_ODD}\b|\bno anomal\w+"
    rf"|\beverything (?:here )?(?:looks|is|seems|appears) (?:\w+ )?{_USUAL}\b"
    rf"|(?:^|[.,\n] ?)(?:this|it|the (?:scene|drive|situation|road)) (?:is|looks|seems|appears) (?:an? )?(?:perfectly |completely |quite )?{_USUAL}\b"
)
_UNUSUAL = re.compile(
    rf"(?:^|[.,\n] ?)(?:so )?(?:there (?:is|are) )?something (?:is )?(?:(?!not\b)\w+ )?{_ODD}\b|(?:^|[.,\n] ?)(?:this|it|which|that) is (?:\w+ )?(?:an? )?(?<!not )(?<!not an )(?<!not a ){_ODD}\b"
    rf"|\bthe (?:most )?unusual aspect is\b"
)
_OPEN = re.compile(
    r"\b(?:but|however|except|apart from|aside from|although|though|wait|actually|on second thought|unsure|not sure|unclear|hard to"
    r"|can(?:not|'t| not) (?:tell|say|judge)|yes and no|or not|unless|otherwise|correction|scratch|maybe|don't know|no idea|either"
    r"|would be|if)\b"
)
"""Takes an answer back, or leaves it open."""
