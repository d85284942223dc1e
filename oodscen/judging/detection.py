"""Read whether a model called a scene out of the ordinary, what, and how surely."""

import re
from dataclasses import dataclass

from oodscen.judging.reading import LONGEST, Reading, is_refusal, member, objects, tail, too_long
from oodscen.judging.wording import CORRECTIONS, normalise


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
    for value in objects(text):
        found = member(value, _OOD_KEYS)
        is_ood = _truth(found)
        if is_ood is not None:
            aspect = member(value, _ASPECT_KEYS)
            sure = _share(member(value, ("confidence", "certainty", "probability", "score")))
            words = aspect if isinstance(aspect, str) else ""
            return Reading(
                Detected(is_ood, words.strip() if is_ood else "", sure), "answered", "JSON"
            )
    plain = normalise(tail(text))
    verdict, how = _detected(plain)
    if verdict is None:
        if is_refusal(text):
            return Reading(None, "refused", "a refusal")
        return Reading(None, "unparsed", how)
    aspect = _aspect_in(plain) if verdict else ""
    return Reading(Detected(verdict, aspect, _stated(plain)), "answered", f"prose: {how}")


def read_description(text: str) -> Reading[str]:
    """Read a description of a frame: any prose will do, a refusal or nothing will not."""
    if len(text) > LONGEST:
        return too_long(text)
    for value in objects(text):
        found = member(value, ("description", "answer", "text", "summary", "caption"))
        if isinstance(found, str) and found.strip():
            return Reading(found.strip(), "answered", "JSON")
    said = tail(text).strip()
    if is_refusal(said):
        return Reading(None, "refused", "a refusal")
    if sum(char.isalpha() for char in said) < 8 or said.startswith("{"):
        return Reading(None, "unparsed", "no description")
    return Reading(said, "answered", "prose")


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

_YES_MARK = re.compile(
    r"(?:\bis ?ood|\bood|\bout of distribution|\bunusual|\banomal(?:y|ous)|\banswer|\bverdict)\s*\??\s*(?::|=|\u2014|is)\s*(yes|no|true|false|ja|nein|s\u00ed|si|oui|non|none|nothing)\b"
)
_NO = re.compile(
    r"\b(?:nothing\s+(?:\w+\s+){0,4}?(?:out\s+of|unusual|abnormal|wrong|strange|remarkable|ood|unexpected|odd|anomal\w+|special|noteworthy|notable)|(?:(?:no|not|without)|\w+n't)\s+(?:\w+\s+){0,4}?(?:unusual|anomal\w+|abnormal\w*|ood|out\s+of\s+(?:the\s+ordinary|distribution)|unexpected|odd|hazards?|strange)"
    r"|(?<!not )(?<!n't )(?:completely|entirely|perfectly|quite|all|looks?|seems?|appears?|is|are|an?|just)\s+(?!not\b)(?:\w+\s+)?(?:normal|ordinary|typical|routine|usual|in\s+distribution|unremarkable)(?!\s*(?:for|,?\s*but|,?\s*except|hazard))|everything\s+(?:\w+\s+){0,2}(?:fine|normal|ordinary|in\s+order)|in\s+distribution|business\s+as\s+usual)\b"
)
_YES = re.compile(
    r"\b(?:unusual|anomal\w+|abnormal|out\s+of\s+(?:the\s+ordinary|distribution)|ood|unexpected(?:ly)?|strange|odd|rare|hazardous|not\s+(?:normal|ordinary|typical|usual))\b"
)
_STATED = re.compile(
    r"(?:confiden(?:ce|t)|certain(?:ty)?|sure|probability|likel(?:y|ihood))\W{0,3}(?:is|of|level|at|:|=|\s)*\s*(\d+(?:[.,]\d+)?)\s*(%|percent|/\s*100?)?"
    r"|(\d+(?:[.,]\d+)?)\s*(%|percent)\s*(?:confident|certain|sure|confidence|certainty|likely|probability)"
)


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
    first = re.match(
        r"\W*(yes|no|nope|yeah|yep|true|false|none|nothing)\b(?!\s+(?:matter|wonder|doubt|vehicles?|cars?|traffic|one|pedestrians?|lanes?)\b)",
        plain,
    )
    if first:
        return _truth(first[1]), "yes or no"
    last = re.search(r"(?:^|\n)\W*(yes|no)\W*$", plain)
    if last:
        return _truth(last[1]), "yes or no"
    rest = _NO.sub(" ", plain)
    says_no, says_yes = rest != plain, bool(_YES.search(rest))
    if says_no and says_yes:
        return (
            (True, "but")
            if re.search(r"\b(?:but|however|except|although|yet|though)\b", plain)
            else (None, "both yes and no")
        )
    if says_no or says_yes:
        return says_yes, "worded"
    return None, "neither yes nor no"


def _aspect_in(plain: str) -> str:
    named = re.search(
        r"\b(?:aspect|anomaly|unusual\s+(?:thing|element|aspect))\s*(?:is|:|=|\u2014)\s*([^\n.;]+)",
        plain,
    )
    if named:
        return named[1].strip(" ,:'{}")
    text = re.sub(r"^\W*(?:yes|yeah|yep|true)\b\W*", "", plain)
    text = _STATED.sub("", text)
    for sentence in re.split(r"(?<=[.!?])\s+|\n", text):
        if re.search(r"[a-z]{3}", sentence):
            return sentence.strip(" .,:;!")[:300]
    return ""


def _stated(plain: str) -> float | None:
    stated = list(_STATED.finditer(plain))
    if not stated:
        return None
    found = stated[-1]
    number = float((found[1] or found[3]).replace(",", "."))
    unit = (found[2] or found[4] or "").replace(" ", "")
    if unit == "/10":
        number /= 10.0
    elif unit:
        number /= 100.0
    return _share(number)


def _share(value: object) -> float | None:
    """Return a stated probability: 0.8, "80 %", 80 and "high" are all understood."""
    if isinstance(value, bool) or value is None:
        return None
    if isinstance(value, str):
        word = value.strip().casefold()
        if word in _WORDED:
            return _WORDED[word]
        number = re.search(r"\d+(?:[.,]\d+)?", word)
        if not number:
            return None
        share = float(number.group().replace(",", "."))
        value = share / 100.0 if "%" in word or "percent" in word else share
        if "/10" in word.replace(" ", "") and "/100" not in word.replace(" ", ""):
            value = share / 10.0
    if not isinstance(value, (int, float)) or value != value or value < 0:
        return None
    if 1.0 < value <= 100.0:
        value = value / 100.0
    return float(value) if value <= 1.0 else None


_WORDED = {
    "very high": 0.95,
    "high": 0.9,
    "medium": 0.7,
    "moderate": 0.7,
    "low": 0.55,
    "very low": 0.5,
    "certain": 1.0,
}


def _truth(value: object) -> bool | None:
    if isinstance(value, bool):
        return value
    if isinstance(value, (int, float)):
        return bool(value) if value in (0, 1) else None
    word = value.strip(" .!'\"").casefold() if isinstance(value, str) else ""
    if word in ("yes", "true", "yeah", "yep", "ja", "oui", "si", "s\u00ed", "1", "ood", "unusual"):
        return True
    if word in ("no", "false", "nope", "none", "nothing", "nein", "non", "0", "normal", "ordinary"):
        return False
    return None
