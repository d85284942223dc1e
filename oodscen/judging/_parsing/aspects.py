"""Parses whether a scene was called out of the ordinary, which aspect was named, and the confidence."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from oodscen._prose import fold, is_refusal
from oodscen.judging._parsing.confidence import CONFIDENT, confidence_in, one_probability
from oodscen.judging._parsing.denials import (
    ODD,
    denies_what_is_odd,
    goes_with_no,
    goes_with_yes,
    plain_words,
    says_nothing,
)
from oodscen.judging._parsing.members import CONFIDENCE, is_placeholder, members, words_in
from oodscen.judging._parsing.reading import ParsedAnswer, Question, read
from oodscen.judging._parsing.reasons import is_against
from oodscen.judging._parsing.unusable import TWO_ANSWERS, UnusableError

LONGEST_ASPECT = 300
"""The longest prose that can be the name of an aspect, in characters."""
_TRUTHS = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}

_IS_OOD = re.compile(
    r"(?:is)?(?:ood|outofdistribution|outof(?:the)?ordinary|(?:anything|something)?unusual|anomal(?:y"
    r"|ous)|abnormal)|answer"
)
"""Matches the names of members, as `spelt` spells them, that say whether something is out of the ordinary."""
_ASPECT = re.compile(r"(?:the|one|main|named|ood|unusual)*aspect|what|label")
"""Matches those that name the aspect beside a yes or no."""
_NAMED = re.compile(rf"{_ASPECT.pattern}|answer")
"""Matches those that name the aspect in answer to the paper's question."""
_DETECTION = re.compile(f"{_IS_OOD.pattern}|{_ASPECT.pattern}|{CONFIDENCE.pattern}")

_LABELLED = re.compile(r"\baspect ?[:=] ?([^\n]*\w[^\n]*)", re.IGNORECASE)
"""Matches the label "aspect" in prose, and what follows it in its line."""
_SURELY = "(?:definite|certain|clear|sure|absolute|obvious|undoubted|probab|tru)ly"
_AFFIRMATION = (
    rf"(?:yes|yeah|yep|true|1|indeed|correct|sure|of course|(?:most |very )?{_SURELY}"
    rf"|(?:it|this|that|there) (?:{_SURELY} )?(?:is|are|does)|i (?:do )?(?:think|believe|would say) so)"
)
_MERE_YES = re.compile(
    rf"\W*(?:{_AFFIRMATION}(?:[\s,.!]+{_AFFIRMATION})*[\s.!]*\Z|true ?[,.:;!])", re.IGNORECASE
)
"""Matches what names no aspect, though it may stand in the place of one."""
_LAST_CONFIDENCE = re.compile(
    rf"[\s.,;:(\u2013\u2014-]{{0,4}}(?:{CONFIDENT.pattern})[\s.)]{{0,4}}\Z", re.IGNORECASE
)
"""Matches a confidence that ends prose, with the marks around it."""
_LEAD = re.compile(
    r"\A\W*(?:the (?:main |one )?(?:ood|unusual|most unusual) (?:aspect|thing) is:? "
    rf"|{ODD} ?[:?] ?(?=yes\b))",
    re.IGNORECASE,
)
"""Matches what may lead to the name of an aspect in prose."""
_LEADING_YES = re.compile(r"\A\W*yes[\s,.:;!\u2013\u2014-]+(?=\S)", re.IGNORECASE)
_MARKED = re.compile(
    rf"\b(?<!not )(?:(?:is )?(?:{ODD}|anomaly)|answer|verdict) ?\??(?: is)? ?[:=?] ?(yes|no|true|false)\b"
    r"(?= ?(?:[.,;:!()\n\u2013\u2014-]|$))(?!,? (?:or|not)\b)"
)
"""Matches a yes or no that is marked as the answer, in folded prose."""
_QUESTION = re.compile(
    rf"\A(?![^?]*(?:\bnot?\b|n't\b))[^?.!\n]{{0,200}}\b(?:{ODD.replace(' ', '[ _-]')}|anomaly)[^?.!\n]{{0,200}}\? ?(?=(?:yes|no|true|false)\b)",
    re.IGNORECASE,
)
"""Matches the question in one line of prose that repeats it before the answer."""
_OPENING = re.compile(r"[\s(\u2022-]*(yes|no|true|false)(?=\s*(?:[,.:;!\u2014\u2013-]|$))")
"""Matches a yes or no with which plain prose opens."""
_SOUGHT = re.compile(rf"\b(?:{ODD}|anomal|abnormal|hazard|obstacle|object|problem|issue|behavio)")
"""Matches what a model says that it does not see, where it does see the picture."""
_OPEN = re.compile(
    r"\b(?:but|however|except|apart from|although|though|wait|actually|on second thought|unsure|not sure|unclear"
    r"|hard to|can not (?:tell|say|judge)|yes and no|or not|unless|otherwise|correction|scratch|maybe"
    r"|not know|no idea|either|would be|if)\b"
)
"""Matches words that retract an answer or leave it open."""


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
    answer = read(text, Question(_pick_detection, _detected_in_prose, _DETECTION, _disowns))
    if answer.value is None or answer.value.beside is None:
        return answer
    truth = "true" if answer.value.is_ood else "false"
    aspect = answer.value.beside
    beside = f"beside the aspect {aspect[:80]!r}" if aspect else "without an aspect"
    return replace(answer, note=f"{answer.note}, which says {truth} {beside}")


def read_named_aspect(text: str) -> ParsedAnswer[str]:
    """Return the aspect named in answer to the paper's question; empty if the answer says that there is none."""
    return read(text, Question(_pick_name, _named_in_prose, _NAMED, _disowns))


def names_nothing(aspect: str) -> bool:
    """Return whether an aspect is empty or says that there is none."""
    return says_nothing(plain_words(aspect)) is True


def _disowns(reasons: str, _: object) -> bool:
    return is_against(fold(reasons))


def _pick_detection(value: Mapping[str, Any]) -> Detected | None:
    answers = [member for member in members(value, _IS_OOD) if not is_placeholder(member)]
    if not answers:
        return None
    truths = {_truth(answer) for answer in answers}
    if len(truths) > 1:
        raise UnusableError(TWO_ANSWERS)
    is_ood = truths.pop()
    if is_ood is None:
        raise UnusableError(f"{str(answers[0])[:80]!r} is neither true nor false")
    confidence = one_probability(members(value, CONFIDENCE))
    if is_ood:
        aspect = _words_of_aspect(value)
        beside = None if aspect and _name_or_nothing(aspect) else aspect
        return Detected(True, aspect, confidence, beside)
    named = (words for words in _aspects(value) if not is_placeholder(words))
    thing = next((words for words in named if not goes_with_no(plain_words(words))), None)
    return Detected(False, "", confidence, thing)


def _words_of_aspect(value: Mapping[str, Any]) -> str:
    """Return the words of the one aspect that is named; empty if none is."""
    aspects = _aspects(value)
    names = {words for words in aspects if not is_placeholder(words)}
    if len(names) > 1:
        raise UnusableError(TWO_ANSWERS)
    if not aspects:
        return ""
    words = _without_yes(names.pop()) if names else ""
    _check_name(words)
    return words


def _aspects(value: Mapping[str, Any]) -> list[str]:
    return [words for member in members(value, _ASPECT) if (words := words_in(member))]


def _pick_name(value: Mapping[str, Any]) -> str | None:
    names = {words_in(name) for name in members(value, _NAMED) if not is_placeholder(name)}
    if len(names) > 1:
        raise UnusableError(TWO_ANSWERS)
    if not names:
        return None
    name = names.pop()
    return _name_or_nothing(name) if name else ""


def _name_or_nothing(words: str) -> str:
    """Return the name of an aspect; empty if the words say that there is none."""
    words = _without_yes(words)
    _check_name(words)
    is_nothing = says_nothing(plain_words(words))
    if is_nothing is None:
        raise UnusableError(
            f"{words[:80]!r} neither names an aspect nor says plainly that there is none"
        )
    return "" if is_nothing else words


def _without_yes(words: str) -> str:
    """Return words without the "yes" that leads to the name of an aspect."""
    return _LEADING_YES.sub("", words)


def _check_name(words: str) -> None:
    """Refuse words without a letter, and a mere yes."""
    if not re.search(r"[^\W\d_]", words) or _MERE_YES.match(words):
        raise UnusableError("the aspect is not named")


def _truth(value: object) -> bool | None:
    if isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, (bool, int, float)):
        return bool(value) if value in (0, 1) else None
    return _TRUTHS.get(value.strip().rstrip(" .!").casefold()) if isinstance(value, str) else None


def _detected_in_prose(prose: str) -> Detected | None:
    """Parse a "yes" or "no" that is marked as the answer, or opens the text with words that agree with it."""
    plain = plain_words(prose)
    marked = {_TRUTHS[match[1]] for match in _MARKED.finditer(plain)}
    if len(marked) > 1:
        raise UnusableError(TWO_ANSWERS)
    if _OPEN.search(plain):
        return None
    answer = _QUESTION.sub("", prose)
    plain = plain_words(CONFIDENT.sub("", answer))
    opening = _OPENING.match(plain)
    if marked and (opening is None or _MARKED.search(plain)):
        is_ood = marked.pop()
        aspect = _aspect_after_mark(prose) if is_ood else ""
        return _detected(is_ood, aspect, prose)
    if _declines(prose):
        return None
    if opening is None:
        is_plain = "?" not in plain and denies_what_is_odd(plain)
        return _detected(False, "", prose) if is_plain else None
    is_ood = _TRUTHS[opening[1]]
    if not (goes_with_yes if is_ood else goes_with_no)(plain[opening.end() :]):
        raise UnusableError("what follows yes or no does not go with it")
    aspect = _aspect_after_yes(answer) if is_ood else ""
    return _detected(is_ood, aspect, prose)


def _declines(prose: str) -> bool:
    """Return whether prose is a refusal; "I can't see anything unusual in the image" is none."""
    is_sought = _SOUGHT.search(fold(prose)) and names_nothing(prose)
    return is_refusal(prose) and not is_sought


def _detected(is_ood: bool, aspect: str, prose: str) -> Detected:
    return Detected(is_ood, aspect, confidence_in(prose), "" if is_ood and not aspect else None)


def _aspect_after_mark(prose: str) -> str:
    """Return the labelled aspect beside a marked answer; empty if there is none."""
    aspect = _labelled(prose)
    if aspect is None:
        _check_short(_MARKED.sub("", fold(CONFIDENT.sub("", prose))))
        return ""
    return _name_or_nothing(aspect) if aspect else ""


def _aspect_after_yes(prose: str) -> str:
    """Return the aspect that is labelled, or that all words after an opening "yes" name."""
    aspect = _labelled(prose)
    if aspect is None:
        rest = CONFIDENT.sub("", re.sub(r"\A\W*\w+\W*", "", prose, count=1))
        if _MERE_YES.match(rest):
            return ""
        _check_short(rest)
        aspect = rest.strip(" \n.,:;!()\u2014\u2013-") if re.search(r"[^\W\d_]", rest) else ""
        aspect += ")" * (aspect.count("(") > aspect.count(")"))
    return _name_or_nothing(aspect) if aspect else ""


def _check_short(prose: str) -> None:
    """Refuse prose that is too long to name an aspect, or has several sentences."""
    if len(prose) > LONGEST_ASPECT or re.search(r"\w[.!?;] +\w", prose):
        raise UnusableError("the aspect is not named")


def _named_in_prose(prose: str) -> str | None:
    labelled = _labelled(prose)
    if labelled is not None:
        return _name_or_nothing(labelled)
    plain = plain_words(prose)
    is_short = 0 < len(plain.split()) <= 20 and len(re.findall(r"[.!?](?:\s|$)", plain)) <= 1
    if not is_short or _OPEN.search(plain) or plain.endswith(("?", ":")):
        return None
    if not re.search(r"\w", plain) or _declines(prose):
        return None
    return _name_or_nothing(_without_confidence(_LEAD.sub("", prose)))


def _labelled(prose: str) -> str | None:
    """Return what follows the label "aspect", without a confidence; `None` without the label."""
    aspects = {_without_confidence(match[1]).strip(" '") for match in _LABELLED.finditer(prose)}
    if len(aspects) > 1:
        raise UnusableError(TWO_ANSWERS)
    for aspect in aspects:
        _check_name(aspect)
    return aspects.pop() if aspects else None


def _without_confidence(words: str) -> str:
    """Return the words of an aspect without the confidence that ends them."""
    return _LAST_CONFIDENCE.sub("", words).strip(" \n.")
