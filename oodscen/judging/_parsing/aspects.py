"""Parses whether a scene was called out of the ordinary, which aspect was named, and the confidence."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from oodscen._prose import fold, is_refusal
from oodscen.judging._parsing.confidence import CONFIDENT, confidence_in, probability
from oodscen.judging._parsing.members import is_placeholder, members, words_in
from oodscen.judging._parsing.reading import ParsedAnswer, Question, read
from oodscen.judging._parsing.reasons import is_against
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
    truth = "true" if answer.value.is_ood else "false"
    aspect = answer.value.beside
    beside = f"beside the aspect {aspect[:80]!r}" if aspect else "without an aspect"
    return replace(answer, note=f"{answer.note}, which says {truth} {beside}")


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

_IS_OOD = re.compile(
    r"(?:is)?(?:ood|outofdistribution|outof(?:the)?ordinary|(?:anything|something)?unusual|anomal(?:y"
    r"|ous)|abnormal)|answer"
)
_ASPECT = re.compile(r"(?:the|one|main|named|ood|unusual)*aspect|what|label")
_NAMED = re.compile(rf"{_ASPECT.pattern}|answer")
_CONFIDENCE = re.compile(r"(?:confidence|certainty|probability)")
_DETECTION = re.compile(f"{_IS_OOD.pattern}|{_ASPECT.pattern}|{_CONFIDENCE.pattern}")


def _detection(value: Mapping[str, Any]) -> Detected | None:
    answers = [member for member in members(value, _IS_OOD) if not is_placeholder(member)]
    if not answers:
        return None
    truths = {_truth(answer) for answer in answers}
    if len(truths) > 1:
        raise UnusableError(TWO_ANSWERS)
    is_ood = truths.pop()
    if is_ood is None:
        raise UnusableError(f"{str(answers[0])[:80]!r} is neither true nor false")
    words = _words_of_aspect(value)
    if is_ood and words and not re.search(r"\w", words):
        raise UnusableError("the aspect is not named")
    is_beside = names_nothing(words) if is_ood else not _says_usual(words)
    confidences = members(value, _CONFIDENCE)
    return Detected(
        is_ood,
        aspect=words if is_ood else "",
        confidence=probability(confidences[0]) if confidences else None,
        beside=words if is_beside else None,
    )


def _words_of_aspect(value: Mapping[str, Any]) -> str:
    return next((words for member in members(value, _ASPECT) if (words := words_in(member))), "")


def _says_usual(aspect: str) -> bool:
    """Return whether words of an aspect name nothing, or call it ordinary."""
    if names_nothing(aspect) or not re.search(r"\w", aspect):
        return True
    return _USUAL.search(fold(aspect)) is not None


def _named_aspect(value: Mapping[str, Any]) -> str | None:
    names = {words_in(name) for name in members(value, _NAMED) if not is_placeholder(name)}
    if len(names) > 1:
        raise UnusableError(TWO_ANSWERS)
    return _name_or_nothing(names.pop()) if names else None


def _name_or_nothing(words: str) -> str:
    """Return the name of an aspect; empty if the words say that there is none."""
    if words and not re.search(r"\w", words):
        raise UnusableError("no aspect is named")
    return "" if names_nothing(words) else words


def _truth(value: object) -> bool | None:
    if isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, (bool, int, float)):
        return bool(value) if value in (0, 1) else None
    return _TRUTHS.get(value.strip().rstrip(" .!").casefold()) if isinstance(value, str) else None


_TRUTHS = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}


def _detected_in_prose(prose: str) -> Detected | None:
    """Parse a "yes" or "no" that is marked as the answer, or opens the text with words that agree with it."""
    plain = fold(prose)
    marked = {_TRUTHS[match[1]] for match in _MARKED.finditer(plain)}
    opening = _OPENING.match(plain)
    if len(marked) > 1:
        raise UnusableError(TWO_ANSWERS)
    if _OPEN.search(plain):
        return None
    if marked:
        is_ood = marked.pop()
        aspect = _aspect_after_mark(prose) if is_ood else ""
        return Detected(is_ood, aspect, confidence_in(prose))
    opening = _OPENING.match(plain)
    if opening is None or is_refusal(prose):
        return None
    is_ood = _TRUTHS.get(opening[1], False)
    if not _goes_with(plain[opening.end() :], is_ood=is_ood):
        raise UnusableError("what follows yes or no does not go with it")
    aspect = _aspect_after_yes(prose) if is_ood else ""
    return Detected(is_ood, aspect, confidence_in(prose))


def _goes_with(rest: str, *, is_ood: bool) -> bool:
    """Return whether the words after an opening "yes" or "no" go with it."""
    says_usual = _USUAL.search(rest) is not None
    if is_ood:
        return not says_usual
    return says_usual or not re.search(r"[^\W\d]{2}", CONFIDENT.sub("", rest))


def _aspect_after_mark(prose: str) -> str:
    """Return the labelled aspect beside a marked answer; empty if there is none."""
    aspect = _labelled(prose)
    if aspect is None:
        _check_short(CONFIDENT.sub("", prose))
        return ""
    return "" if names_nothing(aspect) else aspect


def _aspect_after_yes(prose: str) -> str:
    """Return the aspect that is labelled, or that all words after an opening "yes" name."""
    aspect = _labelled(prose)
    if aspect is None:
        rest = CONFIDENT.sub("", re.sub(r"\A\W*\w+\W*", "", prose, count=1))
        _check_short(rest)
        aspect = rest.strip(" \n.,:;!()\u2014\u2013-")
    return "" if names_nothing(aspect) else aspect


def _check_short(prose: str) -> None:
    """Refuse prose that is too long to name an aspect, or has several sentences."""
    if len(prose) > LONGEST_ASPECT or re.search(r"\w[.!?;] +\w", prose):
        raise UnusableError("the aspect is not named")


def _named_in_prose(prose: str) -> str | None:
    labelled = _labelled(prose)
    if labelled is not None:
        return _name_or_nothing(labelled)
    plain = fold(prose)
    is_short = 0 < len(plain.split()) <= 20 and len(re.findall(r"[.!?](?:\s|$)", plain)) <= 1
    if not is_short or is_refusal(prose) or _OPEN.search(plain) or plain.endswith(("?", ":")):
        return None
    return _name_or_nothing(_LEAD.sub("", prose).strip(" \n.")) if re.search(r"\w", plain) else None


def _labelled(prose: str) -> str | None:
    """Return what follows the label "aspect"; `None` without the label."""
    aspects = {match[1].strip(" .'") for match in _LABELLED.finditer(prose)}
    if len(aspects) > 1:
        raise UnusableError(TWO_ANSWERS)
    return aspects.pop() if aspects else None


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
