"""Read whether a model called a scene out of the ordinary, what, and how surely."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from oodscen.judging.confidence import STATED, probability, stated_confidence
from oodscen.judging.descriptions import joined
from oodscen.judging.patterns import compiled
from oodscen.judging.reading import (
    LONGEST,
    Reading,
    disputed,
    is_refusal,
    member,
    tail,
    told,
    too_long,
)
from oodscen.judging.wording import normalise
from oodscen.judging.yes_or_no import (
    FIRST_WORD,
    NEITHER,
    UNASSERTED,
    names_something,
    truth,
    uncorrected_verdict,
    verdict_in,
    worded,
)


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
        return disputed()
    if given.value:
        later = uncorrected_verdict(given.corrected)[0] if given.corrected else None
        if later in (None, given.value.is_ood):
            return Reading(given.value, "answered", "JSON")
        return Reading(_in_words(given.corrected, later), "answered", "prose: corrected")
    plain = normalise(tail(text))
    verdict, how = (None, NEITHER) if given.is_void else verdict_in(plain)
    if verdict is None:
        if is_refusal(text):
            return Reading(None, "refused", "a refusal")
        return Reading(None, "unparsed", how)
    return Reading(_in_words(plain, verdict), "answered", f"prose: {how}")


def _in_words(plain: str, verdict: bool) -> Detected:
    return Detected(verdict, _aspect_in(plain) if verdict else "", stated_confidence(plain))


# ------------------------------------------------------------------ in an object


def _from_object(value: Mapping[str, Any]) -> Detected | None:
    found = member(value, _OOD_KEYS)
    if found is None:
        found = _by_meaning(value)
    if isinstance(found, list) and len(found) == 1:
        found = found[0]
    if isinstance(found, dict):
        return _from_object(found)
    is_ood = truth(found)
    if is_ood is None:
        return None
    said = member(value, _ASPECT_KEYS) or next(
        (value[key] for key in value if "aspect" in key.casefold()), None
    )
    aspect = joined(said) if is_ood else ""
    if aspect and not re.search(r"\w", aspect):  # the dots of the question
        return None
    return Detected(is_ood, aspect, probability(member(value, _CONFIDENCE_KEYS)))


_OOD_KEYS = (
    "is_ood",
    "ood",
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
_CONFIDENCE_KEYS = ("confidence", "certainty", "probability", "score")


def _by_meaning(value: Mapping[str, Any]) -> object:
    """Return what a name of an object's own says, e.g. `something_unusual` or `is_normal`."""
    for name, said in value.items():
        says = truth(said)
        if says is None:
            continue
        if re.search(r"ood|unusual|anomal|abnormal|out.?of|extraordinary", name, re.IGNORECASE):
            return says
        if re.search(r"normal|ordinary|usual", name, re.IGNORECASE):
            return not says
    return None


# ------------------------------------------------------------------ what is unusual


def _aspect_in(plain: str) -> str:
    """Return the words that name what is unusual: marked as such, or the nearest to the verdict."""
    named = _NAMED.search(plain)
    if named:
        return named[1].strip(" ,:'{}")
    text = STATED.sub("", UNASSERTED.sub(" ", plain)).strip()
    if first := FIRST_WORD.match(text):
        text = text[first.end() :]
    sentences = [s for s in re.split(r"(?<=[.!?])\s+|\n", text) if re.search(r"[^\W\d]{2}", s)]
    telling = [n for n, s in enumerate(sentences) if worded(s) in (True, "both")]
    first_telling = telling[0] if telling else 0
    nearest = sorted(
        range(len(sentences)),
        key=lambda n: (n != first_telling, n < first_telling, abs(n - first_telling)),
    )
    naming = [sentences[n] for n in nearest if names_something(sentences[n])]
    return (naming or sentences or [""])[0].strip(" .,:;!")[:300]


_NAMED = compiled(
    r"\b(?:aspect|anomaly|unusual (?:thing|element|aspect))(?: (?:that|which) (?:\w+ ){1,4}?)?"
    r" *(?:is\b|:|=|\u2014) *([^\n.;]+)"
)
