"""Parses whether a scene was called out of the ordinary, which aspect was named, and the confidence."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from oodscen._words.prose import fold, is_refusal, tidy
from oodscen.judging._parsing.confidence import (
    CONFIDENT,
    confidence_in,
    one_probability,
    without_confidence,
)
from oodscen.judging._parsing.denials import (
    ODD,
    calls_odd,
    denies,
    denies_what_is_odd,
    goes_with_no,
    goes_with_yes,
    plain_words,
    says_nothing,
)
from oodscen.judging._parsing.members import CONFIDENCE, is_placeholder, members, words_in
from oodscen.judging._parsing.reading import ParsedAnswer, Question, read
from oodscen.judging._parsing.reasons import is_against, is_open
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
_LEAD = re.compile(
    r"\A\W*(?:the (?:main |one )?(?:ood|unusual|most unusual) (?:aspect|thing) is:? "
    rf"|{ODD} ?[:?] ?(?=yes\b))",
    re.IGNORECASE,
)
"""Matches what may lead to the name of an aspect in prose."""
_LEADING_YES = re.compile(r"\A\W*yes[\s,.:;!\u2013\u2014-]+(?=\S)", re.IGNORECASE)
_ASKED = rf"(?:is[ _]?)?(?:{ODD.replace(' ', '[ _-]')}|anomaly)(?:[^.?!:\n]{{0,200}}\?)?"
_MARK = (
    rf"\b(?:{_ASKED}|(?:(?:my|the|final) ){{0,3}}(?:answer|verdict) ?\??)(?: is)? ?(?:[:=]|(?<=\?))"
)
_ANSWER = re.compile(
    rf"(?:\A[\s(\u2022-]*|{_MARK} ?)(yes|no|true|false)\b(?=\s*(?:[.,;:!()\n\u2013\u2014-]|\Z))(?!,? (?:or|not)\b)",
    re.IGNORECASE,
)
"""Matches a yes or no that opens prose, answers a question that is repeated, or is marked as the answer."""
_LAST_WORDS = re.compile(r"[^.;:!?\n]{0,200}\Z")
_SOUGHT = re.compile(rf"\b(?:{ODD}|anomal|abnormal|hazard|obstacle|object|problem|issue|behavio)")
"""Matches what a model says that it does not see, where it does see the picture."""


@dataclass(frozen=True)
class Detected:
    """The parsed answer to whether something is out of the ordinary."""

    is_ood: bool
    aspect: str = ""
    confidence: float | None = None
    """Confidence in `is_ood`, 0 to 1."""
    contradiction: str | None = field(default=None, compare=False)
    """The words of an aspect that does not go with `is_ood`: a thing beside false, "none" or nothing beside true."""


def read_aspect(text: str) -> ParsedAnswer[Detected]:
    """Return whether something was called out of the ordinary, the aspect and the confidence.

    `is_ood` counts where the aspect does not go with it; the note then says so.
    """
    answer = read(text, Question(_pick_detection, _detected_in_prose, _DETECTION, _disowns))
    if answer.value is None or answer.value.contradiction is None:
        return answer
    truth = "true" if answer.value.is_ood else "false"
    aspect = answer.value.contradiction
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
    found = [_detected_in_member(answer) for answer in answers]
    if len({one.is_ood for one in found}) > 1:
        raise UnusableError(TWO_ANSWERS)
    beside = (*(one.confidence for one in found), *map(confidence_in, _aspects(value)))
    confidence = one_probability((*members(value, CONFIDENCE), *beside))
    if found[0].is_ood:
        aspect = _words_of_aspect(value) or found[0].aspect
        contradiction = None if aspect and _name_or_nothing(aspect) else aspect
        return Detected(True, aspect, confidence, contradiction)
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
    words = _bare(names.pop()) if names else ""
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
    words = _bare(words)
    _check_name(words)
    is_nothing = says_nothing(plain_words(words))
    if is_nothing is None:
        raise UnusableError(
            f"{words[:80]!r} neither names an aspect nor says plainly that there is none"
        )
    return "" if is_nothing else words


def _bare(words: str) -> str:
    """Return the words that name an aspect without a "yes" before them and a confidence beside them."""
    return _LEADING_YES.sub("", without_confidence(words))


def _check_name(words: str) -> None:
    """Refuse words without a letter, and a mere yes."""
    if not re.search(r"[^\W\d_]", words) or _MERE_YES.match(words):
        raise UnusableError("the aspect is not named")


def _detected_in_member(value: object) -> Detected:
    """Parse what a member says: a truth value, its word, or "yes, a deer"."""
    if isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, (bool, int, float)) and value in (0, 1):
        return Detected(bool(value))
    if isinstance(value, str):
        is_ood = _TRUTHS.get(value.strip().rstrip(" .!").casefold())
        found = _detected_in_prose(tidy(value)) if is_ood is None else Detected(is_ood)
        if found is not None:
            return found
    raise UnusableError(f"{str(value)[:80]!r} is neither true nor false")


def _detected_in_prose(prose: str) -> Detected | None:
    """Parse one yes or no, with words that agree with it, or a plain denial of what is odd."""
    if is_open(plain_words(prose)) or _declines(prose):
        return None
    said = CONFIDENT.sub("", without_confidence(prose))
    answers = list(_ANSWER.finditer(said))
    if not answers:
        is_plain = "?" not in said and denies_what_is_odd(plain_words(said))
        return _detected(False, "", prose) if is_plain else None
    truths = {_TRUTHS[answer[1].casefold()] for answer in answers}
    if len(truths) > 1:
        raise UnusableError(TWO_ANSWERS)
    if any(_is_behind_a_denial(answer) for answer in answers):
        raise UnusableError("yes or no stands behind a denial")
    is_ood, start = truths.pop(), answers[0].start()
    before, rest = said[:start], _ANSWER.sub("", said[start:])
    if not _agrees(is_ood, plain_words(before), plain_words(rest)):
        raise UnusableError("what is said beside yes or no does not go with it")
    return _detected(is_ood, _aspect_beside_yes(prose, before, rest) if is_ood else "", prose)


def _is_behind_a_denial(answer: re.Match[str]) -> bool:
    """Return whether what is asked is denied: "nothing is unusual: yes", but not "nothing is odd, so the answer is: no"."""
    start = answer.start()
    words = _LAST_WORDS.search(answer.string, max(0, start - 200), start)
    before = words[0] if words else ""
    if not _TRUTHS[answer[1].casefold()]:
        before = before.rpartition(",")[2]
    return denies(plain_words(before))


def _agrees(is_ood: bool, before: str, rest: str) -> bool:
    """Return whether the rest adds to a yes or no, and the reasons before it are not plainly the contrary."""
    if is_ood:
        return goes_with_yes(rest) and (goes_with_yes(before) or not goes_with_no(before))
    return goes_with_no(rest) and ("?" in before or not calls_odd(before))


def _declines(prose: str) -> bool:
    """Return whether prose is a refusal; "I can't see anything unusual in the image" is none."""
    is_sought = _SOUGHT.search(fold(prose)) and names_nothing(prose)
    return is_refusal(prose) and not is_sought


def _detected(is_ood: bool, aspect: str, prose: str) -> Detected:
    return Detected(is_ood, aspect, confidence_in(prose), "" if is_ood and not aspect else None)


def _aspect_beside_yes(prose: str, before: str, rest: str) -> str:
    """Return the aspect that prose labels, or that all words after its "yes" name; empty if there is none."""
    aspect = _labelled(prose)
    if aspect is None:
        if _MERE_YES.match(rest):
            return ""
        if rest.rstrip().endswith((":", "=")):
            raise UnusableError("the aspect is not named")
        aspect = rest.strip(" \n.,:;!()\u2014\u2013-") if re.search(r"[^\W\d_]", rest) else ""
        _check_short(before + aspect)
        aspect += ")" * (aspect.count("(") > aspect.count(")"))
    return _name_or_nothing(aspect) if aspect else ""


def _check_short(prose: str) -> None:
    """Refuse prose that is too long to name an aspect, or has several sentences."""
    if len(prose) > LONGEST_ASPECT or re.search(r"(?:(?:\w{3}|\d)\.|\w[!?;]) +\w", prose):
        raise UnusableError("the aspect is not named")


def _named_in_prose(prose: str) -> str | None:
    prose = without_confidence(prose)
    labelled = _labelled(prose)
    if labelled is not None:
        return _name_or_nothing(labelled)
    plain = plain_words(prose)
    is_short = 0 < len(plain.split()) <= 20 and len(re.findall(r"[.!?](?:\s|$)", plain)) <= 1
    if not is_short or is_open(plain) or plain.endswith(("?", ":")):
        return None
    if not re.search(r"\w", plain) or _declines(prose):
        return None
    return _name_or_nothing(_LEAD.sub("", prose).strip(" \n."))


def _labelled(prose: str) -> str | None:
    """Return what follows the label "aspect"; `None` without the label."""
    aspects = {_bare(match[1]).strip(" .'") for match in _LABELLED.finditer(prose)}
    if len(aspects) > 1:
        raise UnusableError(TWO_ANSWERS)
    for aspect in aspects:
        _check_name(aspect)
    return aspects.pop() if aspects else None
