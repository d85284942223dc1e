"""Parses whether a scene was called out of the ordinary, which aspect was named, and the confidence."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from oodscen._prose import fold, is_refusal
from oodscen.judging._parsing.reading import (
    ParsedAnswer,
    Question,
    is_placeholder,
    members,
    read,
    words_in,
)
from oodscen.judging._parsing.stating import is_against
from oodscen.judging._parsing.unusable import TWO_ANSWERS, UnusableError

LONGEST_ASPECT = 300
"""The longest prose that can be the name of an aspect, in characters."""


@dataclass(frozen=True)
class Detected:
    """The parsed answer to whether something is out of the ordinary."""

    is_ood: bool
    aspect: str = ""
    confidence: float | None = None
    """Confidence in `is_ood`, 0 to 1."""
    beside: str | None = field(default=None, compare=False)
    """The words of an aspect that does not go with `is_ood`: a thing beside false, "none" or nothing beside true."""


def read_aspect(text: str) -> ParsedAnswer[Detected]:
    """Return whether something was called out of the ordinary, the aspect and the confidence.

    `is_ood` counts where the aspect does not go with it; the note then says so.
    """
    answer = read(text, Question(_detection, _detected_in_prose, _DETECTION, _disowns))
    if answer.value is None or answer.value.beside is None:
        return answer
    said = "true" if answer.value.is_ood else "false"
    aspect = answer.value.beside
    beside = f"beside the aspect {aspect[:80]!r}" if aspect else "without an aspect"
    return replace(answer, note=f"{answer.note}, which says {said} {beside}")


def read_named_aspect(text: str) -> ParsedAnswer[str]:
    """Return the aspect named in answer to the paper's question; empty if the answer says that there is none."""
    return read(text, Question(_named_aspect, _named_in_prose, _NAMED, _disowns))


def _disowns(reasons: str, _: object) -> bool:
    return is_against(fold(reasons))


def names_nothing(aspect: str) -> bool:
    """Return whether an aspect is empty or says that there is none."""
    return not aspect.strip() or _NOTHING.search(aspect) is not None


_NOTHING = re.compile(
    r"^\W*(?:none|nothing|nil|no|n/?a|not applicable|unknown)\W*$|^\W*(?:there (?:is|are) )?(?:none|nothing|no)\b"
    r".{0,40}\b(?:unusual|ordinary|ood|distribution|aspects?|anomal\w+)\W*$",
    re.IGNORECASE,
)

# ------------------------------------------------------------------ in an object

_IS_OOD = re.compile(
    r"(?:is)?(?:ood|outofdistribution|outof(?:the)?ordinary|(?:anything|something)?unusual|anomal(?:y"
    r"|ous)|abnormal)|answer"
)
_ASPECT = re.compile(r"(?:the|one|main|named|ood|unusual)*aspect|what|label")
_NAMED = re.compile(rf"{_ASPECT.pattern}|answer")
_CONFIDENCE = re.compile(r"(?:confidence|certainty|probability)")
_DETECTION = re.compile(f"{_IS_OOD.pattern}|{_ASPECT.pattern}|{_CONFIDENCE.pattern}")


def _detection(value: Mapping[str, Any]) -> Detected | None:
    held = [member for member in members(value, _IS_OOD) if not is_placeholder(member)]
    if not held:
        return None
    truths = {_truth(one) for one in held}
    if len(truths) > 1:
        raise UnusableError(TWO_ANSWERS)
    is_ood = truths.pop()
    if is_ood is None:
        raise UnusableError(f"{str(held[0])[:80]!r} is neither true nor false")
    sure = members(value, _CONFIDENCE)
    said = _words_of_aspect(value)
    is_odd = names_nothing(said) if is_ood else not (names_nothing(said) or _says_usual(said))
    return Detected(
        is_ood,
        _aspect(said) if is_ood else "",
        probability(sure[0]) if sure else None,
        said if is_odd else None,
    )


def _words_of_aspect(value: Mapping[str, Any]) -> str:
    return next((words for member in members(value, _ASPECT) if (words := words_in(member))), "")


def _says_usual(said: str) -> bool:
    """Return whether words of an aspect name nothing, or call it ordinary."""
    return not re.search(r"\w", said) or bool(_USUAL.search(fold(said)))


def _aspect(said: str) -> str:
    if said and not re.search(r"\w", said):
        raise UnusableError("the aspect is not named")
    return said


def _named_aspect(value: Mapping[str, Any]) -> str | None:
    held = [member for member in members(value, _NAMED) if not is_placeholder(member)]
    said = {words_in(one) for one in held}
    if len(said) > 1:
        raise UnusableError(TWO_ANSWERS)
    return _name(said.pop()) if said else None


def _name(said: str) -> str:
    if said and not re.search(r"\w", said):
        raise UnusableError("no aspect is named")
    return "" if names_nothing(said) else said


def _truth(value: object) -> bool | None:
    if isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, (bool, int, float)):
        return bool(value) if value in (0, 1) else None
    return _TRUTHS.get(value.strip().rstrip(" .!").casefold()) if isinstance(value, str) else None


_TRUTHS = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}

# ------------------------------------------------------------------ confidence


def probability(value: object) -> float | None:
    """Return a stated probability in [0, 1]; accepts 0.8, "80 %", 80, "8/10", "50/50" and the words of `_DEGREES`."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    said = _BESIDE.sub("", str(value)).strip().casefold()
    degree = _DEGREES.get(re.sub(r"[\s_-]+", " ", said))
    if degree is not None:
        return degree
    match = _NUMBER.fullmatch(said)
    if not match:
        return None
    number = float(match[1].replace(",", "."))
    whole = match[3] or (100 if match[2] else None)
    if whole is None:
        whole = 100 if 10.0 < number <= 100.0 else 1
    share = number / float(whole) if float(whole) else -1.0
    return share if 0.0 <= share <= 1.0 else None


_DEGREES = {
    "50/50": 0.5, "50:50": 0.5, "50 50": 0.5, "fifty fifty": 0.5, "none": 0.5, "unsure": 0.5, "uncertain": 0.5, "not sure": 0.5,
    "very low": 0.55, "low": 0.6, "fairly low": 0.6, "medium": 0.75, "moderate": 0.75, "fair": 0.75,
    "fairly high": 0.85, "high": 0.9, "sure": 0.95, "very high": 0.97, "very sure": 0.97, "certain": 1.0,
}  # fmt: skip
"""Words for a confidence in a yes or no, as probabilities: only their order counts."""
_BESIDE = re.compile(
    r"^\s*(?:about|around|approximately|roughly|~)\s*|\s*\([^()]{1,60}\)\s*\.?$|\.\s*$",
    re.IGNORECASE,
)
"""Matches what may stand beside a number or a word."""
_NUMBER = re.compile(
    r"(\d{1,9}(?:\.\d{1,30}|,\d{1,2})?|\.\d{1,30})\s*(?:(%|percent)|(?:/|out of)\s*(\d{1,3}))?"
)
_SHARE = r"\d{1,3}(?:\.\d{1,30})? ?(?:%|percent|/ ?10{1,2}\b|out of 10\b)"
_CONFIDENT = re.compile(
    rf"(?:confidence|certainty)(?: (?:level|is|of|at|about))* ?[:=]? ?(?P<after>{_SHARE}|\d+(?:[.,]\d+)?(?!\w|[.,]\d))"
    rf"|\((?P<alone>0?\.\d+|1(?:\.0+)?|{_SHARE})\)|(?P<before>{_SHARE}) (?:sure|certain|confident)",
    re.IGNORECASE,
)


def _confidence_in(prose: str) -> float | None:
    """Return the probability that prose states; `None` if it states none, or two."""
    found = {
        probability(match["after"] or match["alone"] or match["before"])
        for match in _CONFIDENT.finditer(prose)
    }
    return found.pop() if len(found) == 1 else None


# ------------------------------------------------------------------ in prose


def _detected_in_prose(prose: str) -> Detected | None:
    """Parse a "yes" or "no" that is marked as the answer, or opens the text with words that agree with it."""
    plain = fold(prose)
    marked = {_TRUTHS[match[1]] for match in _MARKED.finditer(plain)}
    opening = _OPENING.match(plain)
    said = marked or ({_TRUTHS.get(opening[1], False)} if opening else set())
    if len(said) > 1:
        raise UnusableError(TWO_ANSWERS)
    if not said or _OPEN.search(plain) or (not marked and is_refusal(prose)):
        return None
    is_ood = said.pop()
    rest = "" if marked or not opening else plain[opening.end() :]
    says_usual = bool(_USUAL.search(rest))
    if (
        says_usual
        if is_ood
        else not says_usual and re.search(r"[^\W\d]{2}", _CONFIDENT.sub("", rest))
    ):
        raise UnusableError("what follows yes or no does not go with it")
    aspect = _aspect_in(prose, is_marked=bool(marked)) if is_ood else ""
    return Detected(is_ood, aspect, _confidence_in(prose))


def _aspect_in(prose: str, *, is_marked: bool) -> str:
    named = _labelled(prose)
    if named is None:
        named = _CONFIDENT.sub(
            "", prose if is_marked else re.sub(r"\A\W*\w+\W*", "", prose, count=1)
        )
        if len(named) > LONGEST_ASPECT or re.search(r"\w[.!?;] +\w", named):
            raise UnusableError("the aspect is not named")
        named = "" if is_marked else named.strip(" \n.,:;!()\u2014\u2013-")
    return "" if names_nothing(named) else named


def _named_in_prose(prose: str) -> str | None:
    named = _labelled(prose)
    if named is not None:
        return _name(named)
    plain = fold(prose)
    is_short = 0 < len(plain.split()) <= 20 and len(re.findall(r"[.!?](?:\s|$)", plain)) <= 1
    if not is_short or is_refusal(prose) or _OPEN.search(plain) or plain.endswith(("?", ":")):
        return None
    return _name(_LEAD.sub("", prose).strip(" \n.")) if re.search(r"\w", plain) else None


def _labelled(prose: str) -> str | None:
    found = {match[1].strip(" .'") for match in _LABELLED.finditer(prose)}
    if len(found) > 1:
        raise UnusableError(TWO_ANSWERS)
    return found.pop() if found else None


_LABELLED = re.compile(r"\baspect ?[:=] ?([^\n]*\w[^\n]*)", re.IGNORECASE)
_LEAD = re.compile(
    r"\A\W*(?:the (?:main |one )?(?:ood|unusual|most unusual) (?:aspect|thing) is:? |yes, )",
    re.IGNORECASE,
)
_ODD = r"(?:unusual|out of the ordinary|abnormal|anomalous|strange|out of distribution|ood)"
_MARKED = re.compile(
    rf"\b(?:(?:is )?(?:{_ODD}|anomaly)|answer|verdict) ?\??(?: is)? ?[:=?] ?(yes|no|true|false)\b"
    r"(?! ?(?:or\b|/|,? not\b|\w+ (?:is|are)\b))"
)
_OPENING = re.compile(
    rf"[\s(\u2022-]*(yes|no|true|false|(?:there is |i see )?nothing (?:is )?{_ODD}|everything (?:is|looks) (?:normal|ordinary))\b"
    r"(?: here)?(?=\s*(?:[,.:;!\u2014\u2013-]|$))"
)
_USUAL = re.compile(
    r"(?<!out of the )(?<!not )(?<!n't )(?<!not an )(?<!not a )"
    r"\b(?:normal|ordinary|usual|typical|routine|nothing|no|none|fine|clear)\b"
)
_OPEN = re.compile(
    r"\b(?:but|however|except|apart from|although|though|wait|actually|on second thought|unsure|not sure|unclear"
    r"|hard to|can(?:not|'t| not) (?:tell|say|judge)|yes and no|or not|unless|otherwise|correction|scratch|maybe"
    r"|(?:don't|not) know|no idea|either|would be|if)\b"
)
"""Matches words that retract an answer or leave it open."""
