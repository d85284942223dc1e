"""Read whether a model called a scene out of the ordinary, what, and how surely."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from oodscen.judging.languages import ANSWER, IS, NO_WORD, SURENESS, UNUSUAL, USUAL, YES_WORD
from oodscen.judging.reading import (
    LONGEST,
    TWO_ANSWERS,
    Reading,
    is_refusal,
    member,
    objects,
    tail,
    told,
    too_long,
)
from oodscen.judging.wording import CONCLUSION, CORRECTIONS, normalise


@dataclass(frozen=True)
class Detected:
    """An answer to whether something is out of the ordinary."""

    is_ood: bool
    aspect: str = ""
    confidence: float | None = None
    """In `is_ood`, 0 to 1."""


def read_aspect(text: str) -> Reading[Detected]:
    """Read whether something was called out of the ordinary, what, and how surely."""
    if len(text) > LONGEST:
        return too_long(text)
    given = told(text, _from_object, _OOD_KEYS)
    if given.is_disputed:
        return Reading(None, "unparsed", f"{TWO_ANSWERS}, each in JSON")
    if given.value:
        later = _detected_in(given.corrected)[0] if given.corrected else None
        if later in (None, given.value.is_ood):
            return Reading(given.value, "answered", "JSON")
        return Reading(_in_words(given.corrected, later), "answered", "prose: corrected")
    plain = normalise(tail(text))
    verdict, how = (None, "neither yes nor no") if given.is_void else _detected(plain)
    if verdict is None:
        if is_refusal(text):
            return Reading(None, "refused", "a refusal")
        return Reading(None, "unparsed", how)
    return Reading(_in_words(plain, verdict), "answered", f"prose: {how}")


def read_usual(plain: str) -> bool:
    """Whether a normalised text says that nothing is out of the ordinary."""
    return _detected(plain)[0] is False


def read_description(text: str) -> Reading[str]:
    """Read a description of a frame: any prose will do, a refusal or nothing will not."""
    if len(text) > LONGEST:
        return too_long(text)
    for value in objects(text):
        found = _joined(member(value, _DESCRIPTION_KEYS) or value)
        if sum(char.isalpha() for char in found) >= LEAST_LETTERS:
            return Reading(found, "answered", "JSON")
    said = tail(text).strip()
    begun = _BEGUN.match(said)
    said = said[begun.end() :] if begun else said
    if is_refusal(said) and len(said) < LONGEST_REFUSAL:
        return Reading(None, "refused", "a refusal")
    if sum(char.isalpha() for char in said) < LEAST_LETTERS or said.startswith("{"):
        return Reading(None, "unparsed", "no description")
    return Reading(said, "answered", "prose")


LEAST_LETTERS = 4
"""A description has at least so many letters."""

LONGEST_REFUSAL = 600
"""Whoever writes more than so many characters about a frame has seen it."""

_DESCRIPTION_KEYS = ("description", "answer", "text", "summary", "caption")
_BEGUN = re.compile(r"""\{\s*["']?description["']?\s*:\s*["']?""", re.IGNORECASE)
"""An object that breaks off in its description."""


def _joined(value: object, depth: int = 3) -> str:
    """Return the words in a value, whatever they are arranged in."""
    if isinstance(value, str):
        return value.strip()
    inner = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(inner, (list, tuple)) or not depth:
        return ""
    return "; ".join(filter(None, (_joined(one, depth - 1) for one in inner)))


def _from_object(value: Mapping[str, Any]) -> Detected | None:
    found = member(value, _OOD_KEYS)
    if found is None:
        found = _by_meaning(value)
    if isinstance(found, list) and len(found) == 1:
        found = found[0]
    if isinstance(found, dict):
        return _from_object(found)
    is_ood = _truth(found)
    if is_ood is None:
        return None
    said = member(value, _ASPECT_KEYS) or next(
        (value[key] for key in value if "aspect" in key.casefold()), None
    )
    words = _joined(said) if is_ood else ""
    if is_ood and words and not re.search(r"\w", words):
        return None
    sure = _share(member(value, ("confidence", "certainty", "probability", "score")))
    return Detected(is_ood, words, sure)


def _by_meaning(value: Mapping[str, Any]) -> object:
    """Return what an object says under a name of its own, e.g. `something_unusual` or `is_normal`."""
    for name, said in value.items():
        truth = _truth(said)
        if truth is None:
            continue
        if re.search(r"ood|unusual|anomal|abnormal|out.?of|extraordinary", name, re.IGNORECASE):
            return truth
        if re.search(r"normal|ordinary|usual", name, re.IGNORECASE):
            return not truth
    return None


def _in_words(plain: str, verdict: bool) -> Detected:
    return Detected(verdict, _aspect_in(plain) if verdict else "", _stated(plain))


_OOD_KEYS = (
    "is_ood",
    "ood",
    "isood",
    "out_of_distribution",
    "out_of_the_ordinary",
    "is_out_of_the_ordinary",
    "is_unusual",
    "unusual",
    "anomaly",
    "is_anomaly",
    "answer",
)
_ASPECT_KEYS = ("aspect", "ood_aspect", "unusual_aspect", "what", "reason", "description", "label")

_ALONE = (
    r"(?=\s*(?:$|[^\w\s])|\s+(?:nothing|it|this|that|there|the|these|i|we|everything|all|not|no)\b)"
)
"""Follows a "no" that is not said of a noun, as it is in "no markings are visible"."""
_CALLED = r"(?:(?:an?|perfectly|quite|completely)\s+)?(?:ordinary|normal|usual|unusual|abnormal|anomalous|ood)(?![^.\n]*\b(?:but|except|apart|although)\b)"
_WORD = rf"yes|true|false|none|nothing|{YES_WORD}|(?:no|{NO_WORD}){_ALONE}"
_YES_MARK = re.compile(
    rf"(?:\bis ?ood|\bood|\bout of distribution|\bunusual|\banomal(?:y|ous)|\banswer|\bverdict|\bboxed|\bfinal|(?<![a-z])(?:{ANSWER}))"
    rf"\s*\??\s*(?::|=|\u2014|\{{|\bis\b|\s{IS}\b)\s*({_WORD}|{_CALLED})\b(?!\s*(?:or\b|/|\||and\s+no\b|(?:vehicles?|cars?|traffic|lanes?|pedestrians?|idea|way)\b))"
)
_FIRST = re.compile(
    rf"\W*({_WORD}|nope|yeah|yep|\u662f\u7684)(?:\b|(?=\W|$))(?!\s+(?:matter|wonder|doubt|idea|way|vehicles?|cars?|traffic|one|pedestrians?|lanes?|and\s+no|or\s+no)\b)"
)
_USUAL = r"(?:normal|ordinary|typical|routine|usual|in\s+distribution|unremarkable)"
_ODD = r"(?:unusual|anomal\w+|abnormal\w*|ood|out\s+of\s+(?:the\s+ordinary|distribution)|unexpected|odd|strange)"
_NOT_YES = re.compile(
    rf"(?:^|[.!\n])[^\w\n]*(?:an?\s+)?(?:\w+\s+)?{_USUAL}(?:\s+(?:drive|driving|scene|scenario|traffic|situation|day|road|conditions))*\s*(?:[.!,(\n]|$)"
    rf"|(?:\b(?:no|not|nothing|without)\b|\w+n't)[^.\n]{{0,40}}\b(?:surpris\w+|stands?\s+out|standing\s+out|of\s+concern)\b"
    rf"|\b(?:nothing|none)\s+(?:(?!whether\b|but\b|{_USUAL})\w+\s+){{0,5}}?(?:out\s+of\s+(?:the\s+ordinary|distribution|place)|wrong|remarkable|special|noteworthy|notable|{_ODD})"
    rf"|(?:\b(?:no|not|without|cannot|never|neither)|\w+n't)\s+(?:(?!whether\b|if\b|only\b|just\b|tell\b|say\b|sure\b|certain\b|because\b)\w+\s+){{0,5}}?(?:{_ODD}|hazards?)"
    rf"|(?<!not )(?<!n't )(?:completely|entirely|perfectly|quite|all|looks?|seems?|appears?|is|are|be|an?|just)\s+(?!not\b)(?:\w+\s+)?{_USUAL}(?!\s*(?:for|,?\s*but|,?\s*except|hazard))"
    rf"|\beverything\s+(?:\w+\s+){{0,2}}(?:fine|normal|ordinary|in\s+order)|\bin\s+distribution|\bbusiness\s+as\s+usual|{USUAL}"
)
_NOT_NO = re.compile(
    rf"\b(?:not|n't|nothing|never|hardly|far\s+from|anything\s+but|isn't|aren't|doesn't|don't)\s+(?:(?!only\b|of\b)\w+\s+){{0,3}}?{_USUAL}\b"
    rf"|\b(?:n't|nothing|not)\s+(?:anything\s+)?(?:that\s+)?(?:i|one|you)\s+(?:\w+\s+){{0,3}}?{_USUAL}\b|n't\s+anything\s+that\s+(?:\w+\s+){{0,4}}?{_USUAL}\b"
)
_YES = re.compile(
    rf"\b(?:{_ODD}|unexpectedly|rare|hazardous|something\s+(?:is|looks|seems)\s+(?:off|wrong|amiss))\b|{UNUSUAL}"
)
_UNSAID = re.compile(
    r"\b(?:whether|if)\s+[^.;,\n]*|\b(?:probability|confidence|likelihood|chance)\s+(?:that|of)\b[^.;,\n]*|\babout\s+half\s+of\s+such[^.\n]*|[^.!?\n]*\?|\bexactly\s+one\s+is\s+right"
)
"""What says neither yes nor no: questions, what hangs on a condition, sentences of the question."""
_OPEN = re.compile(
    r"\b(?:might|may|could|maybe|perhaps|not\s+sure|unsure|unclear|uncertain|hard\s+to\s+(?:say|tell)|yes\s+and\s+no|either)\b"
)
_STATED = re.compile(
    rf"(?:(?<![a-z])(?:{SURENESS})\w*)\W{{0,4}}(?:(?:is|of|level|at|as|around|about|roughly|approximately|ist|est|es)\W{{1,2}})*[:=(~]*\s*(?P<after>\d+(?:[.,]\d+)?)\s*(?P<unit>%|percent|/\s*\d+|out\s+of\s+\d+)?"
    rf"|(?P<before>\d+(?:[.,]\d+)?)\s*(?P<share>%|percent)\s*(?:{SURENESS})"
    r"|\(\s*(?:around|about|~)?\s*(?P<alone>[01][.,]\d+|\d{1,3}(?=\s*%))\s*(?P<percent>%)?\s*\)"
    r"|\A\W*(?:yes|no|true|false)\W{1,4}(?P<listed>[01][.,]\d+|\d{1,3}(?=\s*%))\s*(?P<of>%)?"
)
"""A probability that is stated as a number."""


def _detected(plain: str) -> tuple[bool | None, str]:
    for place in [m.end() for m in CORRECTIONS.finditer(plain)][:-20:-1]:
        later, how = _detected_in(plain[place:].strip(" .,;:!"))
        if later is not None:
            return later, f"corrected, {how}"
    return _detected_in(plain)


def _detected_in(plain: str) -> tuple[bool | None, str]:
    marks = [m[1] for m in _YES_MARK.finditer(plain)]
    if marks:
        return _truth(marks[-1]), "given"
    asked = _UNSAID.sub(" ", plain)
    first = _FIRST.match(asked)
    if first and not (first[1] in ("nothing", "none") and re.match(r"\s*\w", asked[first.end() :])):
        return _truth(first[1]), "yes or no"
    last = re.search(r"(?:^|\n)\W*(yes|no|true|false)\W*$", asked)
    if last:
        return _truth(last[1]), "yes or no"
    if _UNDECIDED.search(asked):
        return None, "undecided"
    concluded = [m.end() for m in CONCLUSION.finditer(asked)]
    if concluded and (closing := _worded(asked[concluded[-1] :])) in (True, False):
        return bool(closing), "concluded"
    clauses = _BUT.split(asked)
    worded = [_worded(clause) for clause in clauses]
    said = [one for one in worded if one is not None]
    if len(set(said)) > 1 or any(one == "both" for one in said):
        if _OPEN.search(asked) or said[-1] is not True:
            return None, "both yes and no"
        return True, "but"
    return (bool(said[0]), "worded") if said else (None, "neither yes nor no")


_UNDECIDED = re.compile(
    r"\b(?:not\s+sure\s+(?:if|whether)|unsure|unclear|uncertain|undecided|hard\s+to\s+(?:say|tell)|or\s+not|yes\s+and\s+no|(?:can't|cannot|can\s+not)\s+(?:tell|say|judge)(?=\s+(?:if|whether|from)\b|\s*(?:[.!,]|$)))\b"
)
_BUT = re.compile(r"\b(?:but|however|except|although|yet|though|while|apart\s+from|aber)\b")


def _worded(plain: str) -> bool | str | None:
    """Say whether a clause calls something out of the ordinary, or says both."""
    rest, odd = _NOT_NO.subn(" ", plain)
    rest, usual = _NOT_YES.subn(" ", rest)
    says_yes = bool(odd or _YES.search(rest))
    if usual and says_yes:
        return "both"
    return says_yes if usual or says_yes else None


def _aspect_in(plain: str) -> str:
    named = re.search(
        r"\b(?:aspect|anomaly|unusual\s+(?:thing|element|aspect))(?:\s+(?:that|which)\s+(?:\w+\s+){1,4}?)?\s*(?:is\b|:|=|\u2014)\s*([^\n.;]+)",
        plain,
    )
    if named:
        return named[1].strip(" ,:'{}")
    text = _STATED.sub("", _UNSAID.sub(" ", plain)).strip()
    text = _FIRST.sub("", text, count=1) if _FIRST.match(text) else text
    sentences = [s for s in re.split(r"(?<=[.!?])\s+|\n", text) if re.search(r"[^\W\d]{2}", s)]
    telling = [n for n, s in enumerate(sentences) if _worded(s) in (True, "both")]
    first = telling[0] if telling else 0
    nearest = sorted(range(len(sentences)), key=lambda n: (n != first, n < first, abs(n - first)))
    naming = [sentences[n] for n in nearest if _names_something(sentences[n])]
    return (naming or sentences or [""])[0].strip(" .,:;!")[:300]


def _names_something(sentence: str) -> bool:
    """Whether a sentence says more than that something is out of the ordinary, or how surely."""
    rest = _VERDICT_WORDS.sub(" ", sentence)
    return bool(re.search(r"[^\W\d]{3}", rest))


_VERDICT_WORDS = re.compile(
    rf"{_ODD}|{_USUAL}|\b(?:yes|no|true|i|i'm|i'd|am|is|are|was|be|it|its|it's|this|that|that's|there|there's|something|thing|scene|situation|not|very|quite|highly|fairly|definitely|certainly|clearly|really|absolutely|confidence|confident|sure|certain|high|medium|low|say|so|here|the|an?|of|in|call|would|for|me|to)\b"
)


def _stated(plain: str) -> float | None:
    stated = list(_STATED.finditer(plain))
    if not stated:
        worded = _SURE.search(plain)
        return _share(worded[1]) if worded else None
    found = {key: said for key, said in stated[-1].groupdict().items() if said}
    number, *unit = found.values()
    return _share(" ".join([number.replace(",", "."), *unit]))


_SURE = re.compile(
    r"(?:\bconfidence\s*(?:level\s*)?(?:is|:|=|\u2014)\s*|\bi(?:'m|\s+am)\s+)"
    r"((?:(?:not|very|so|extremely|highly|fairly|quite|reasonably|pretty|rather|absolutely|completely|fully)\s+)*(?:sure|certain|confident|unsure|uncertain|high|medium|moderate|low)\b)"
)
"""How sure somebody says to be in words."""


def _share(value: object) -> float | None:
    """Return a stated probability: 0.8, "80 %", 80, "8/10" and "high" are all understood."""
    if isinstance(value, bool) or value is None:
        return None
    if isinstance(value, str):
        word = value.strip().casefold()
        number = re.search(r"(-?\d+(?:[.,]\d+)?)\s*(?:(%|percent)|(?:/|out\s+of)\s*(\d+))?", word)
        if not number:
            return next((share for words, share in _WORDED if re.search(words, word)), None)
        value = float(number[1].replace(",", "."))
        if number[2] or number[3]:
            value /= float(number[3] or 100.0) or 1.0
            return value if 0.0 <= value <= 1.0 else None
    if not isinstance(value, (int, float)) or not 0.0 <= value <= 100.0:
        return None
    if 1.0 < value <= 10.0:
        return None
    return float(value) if value <= 1.0 else value / 100.0


_WORDED = (
    (
        r"\b(?:not\s+(?:very\s+|so\s+|at\s+all\s+)?(?:sure|certain|confident)|unsure|uncertain|low|guess)\b",
        0.55,
    ),
    (r"\b(?:absolutely|completely|100|fully)\s+(?:sure|certain|confident)\b|^certain$", 1.0),
    (r"\b(?:very|extremely|highly)\s+(?:high|sure|certain|confident|likely)\b", 0.95),
    (
        r"\b(?:fairly|quite|reasonably|pretty|rather)\s+(?:high|sure|certain|confident|likely)\b",
        0.8,
    ),
    (r"\b(?:medium|moderate\w*|somewhat|probabl[ey])\b", 0.7),
    (r"\b(?:high|sure|certain|confident)\b", 0.9),
)
"""Words for how sure somebody is, and the probability that they are taken for."""


def _truth(value: object) -> bool | None:
    if isinstance(value, bool):
        return value
    if isinstance(value, (int, float)):
        return bool(value) if value in (0, 1) else None
    word = value.strip(" .!'\"").casefold() if isinstance(value, str) else ""
    if re.fullmatch(rf"yes|true|yeah|yep|si|1|ood|unusual|{YES_WORD}", word):
        return True
    if re.fullmatch(rf"no|false|nope|none|nothing|0|normal|ordinary|{NO_WORD}", word):
        return False
    return None
