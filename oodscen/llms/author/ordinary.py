"""Ordinary twins: a text again, with the event replaced by the event's ordinary counterpart.

The text alone is there to work from. What it says of road, weather and traffic is told from the event by the phrases
of the knowledge base, and where a text has none of these, by its grammar.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from oodscen.llms.author.constructions import nominal
from oodscen.llms.author.knowledge import Hazard, Knowledge
from oodscen.llms.author.naming import Name, named
from oodscen.llms.author.recognise import Recogniser
from oodscen.prompts.describe_path import plain

_EGO = r"(?:the ego vehicle|the ego car|my car|ego|i|it)"
_DRIVES = (
    rf"{_EGO} (?:(?:is |am )?(?:travel|driv|mov|head|proceed|cruis|roll|go)(?:l?ing|ing|es|s|e)?\b"
    r"|(?:is|am)(?= (?:on|in|inside) ))"
)
_MORE_OF_PLACE = re.compile(
    r"(?:on|along|in|through|across|over|into|down|up|towards) (?:an?|the) [^,.:]+?(?=[,.:]|$| when | while | and )",
    re.I,
)
_ROAD = re.compile(
    r"\b(?:road|street|lane|highway|motorway|freeway|avenue|boulevard|carriageway|tunnel|bridge|"
    r"junction|intersection|roundabout|crossing|city|town|village)\b",
    re.IGNORECASE,
)
_LINK = r"(?:\s*[,:;]\s*(?:and |when |while )?|\s+(?:and|when|while) |\s+|(?=\.?$))"
_SENTENCES = re.compile(r"(?<=[.!?])\s+(?=[A-Z\d])")
_SLACK = 3
"""Words by which a twin may be shorter than its text before something ordinary is added."""
_ANY_ROAD = "the lane ahead is clear and traffic moves along as usual"
_TAILS = (
    "and traffic flows freely",
    "and the ego vehicle drives on",
    "and traffic moves at a steady speed",
    "and the ego vehicle continues in its lane",
    "and the ego vehicle keeps its lane and its speed",
    "and the ego vehicle follows the car in front at a steady speed",
    "and the ego vehicle drives straight on with the traffic at an even speed",
    "and the ego vehicle goes straight on behind a white car that moves at the same speed",
    "and the ego vehicle continues in its lane behind a car while others pass on the other side of the road",
    "and the ego vehicle drives straight on behind a grey car and a bus, all of them at an even speed in their own lanes",
)
"""What ordinary traffic does, to give a twin its text's length; by number of words."""


@dataclass(frozen=True)
class _Part:
    """One sentence, told apart."""

    lead: str
    event: str
    trail: str


class OrdinaryAuthor:
    """Writes ordinary twins."""

    def __init__(self, knowledge: Knowledge, recogniser: Recogniser) -> None:
        """Know the phrases for road, weather and traffic, and what is ordinary instead of what."""
        self._recogniser = recogniser
        self._details = {plain(detail) for hazard in knowledge.hazards for detail in hazard.details}
        frame = _alternatives(_frames(knowledge))
        self._lead = re.compile(rf"(?:(?:{frame}|{_DRIVES}){_LINK})+", re.IGNORECASE)
        self._trail = re.compile(
            rf"(?:,? while (?:{_DRIVES}|{_EGO})(?: (?:{frame}))*)\.?$", re.IGNORECASE
        )

    def twin(self, text: str, label: str, rng: np.random.Generator) -> str:
        """Write the twin of a text.

        Args:
            text: With the unusual event.
            label: Of the leaf, for a text that is not recognised itself.
            rng: Chooses among ordinary things of equal length.
        """
        hazard = self._recogniser.recognise(text).hazard
        if hazard is None and label:
            hazard = next(iter(self._recogniser.covered_by(label)), None)
        parts = list(self._told_apart(text))
        place = next((n for n, part in enumerate(parts) if self._is_event(part)), None)
        if place is None:
            place = len(parts) - 1
            parts[place] = _Part("", _whole(parts[place]), "")
        length = len(plain(text).split())
        kept = [part for n, part in enumerate(parts) if n == place or not part.event]
        room = length - sum(len(plain(part.lead + part.trail).split()) for part in kept)
        if parts[place].trail:
            room = 0
        clause = named(self._ordinary(hazard, room, rng), _name(text))
        return " ".join(_worded(part, clause) if part.event else _whole(part) for part in kept)

    def _is_event(self, part: _Part) -> bool:
        return bool(part.event) and plain(part.event) not in self._details

    def _told_apart(self, text: str) -> Iterator[_Part]:
        """Tell the sentences apart; where the ego is, is said once."""
        is_placed = False
        for sentence in _SENTENCES.split(text.strip()):
            part = self._apart(sentence, is_placed)
            is_placed = is_placed or _ROAD.search(part.lead) is not None
            yield part

    def _apart(self, sentence: str, is_placed: bool) -> _Part:
        found = self._lead.match(sentence)
        if is_placed and (found is None or plain(sentence[found.end() :])):
            return _Part("", sentence.rstrip("."), "")
        cut = found.end() if found is not None else 0
        if cut and not plain(sentence[cut:]):
            return _Part(sentence, "", "")
        if cut and re.match(_DRIVES, sentence, re.IGNORECASE):
            more = _MORE_OF_PLACE.match(sentence, cut)
            if more is not None:
                rest = re.compile(_LINK).match(sentence, more.end())
                cut = rest.end() if rest is not None else more.end()
        elif not cut:
            more = _MORE_OF_PLACE.match(sentence)
            is_ended = more is not None and sentence[more.end() : more.end() + 2] == ", "
            if more is not None and is_ended and _ROAD.search(more[0]):
                cut = more.end() + 2
        if cut and not plain(sentence[cut:]):
            return _Part(sentence, "", "")
        trail = self._trail.search(sentence, cut)
        end = trail.start() if trail is not None else len(sentence.rstrip("."))
        return _Part(sentence[:cut], sentence[cut:end], sentence[end:].rstrip("."))

    def _ordinary(self, hazard: Hazard | None, room: int, rng: np.random.Generator) -> str:
        """Return an ordinary clause of about so many words."""
        clause = hazard.ordinary if hazard is not None else _ANY_ROAD
        missing = room - len(clause.split())
        if missing <= _SLACK:
            return clause
        fitting = [tail for tail in _TAILS if "traffic" not in tail or "traffic" not in clause]
        fitting.sort(key=lambda tail: abs(len(tail.split()) - missing))
        tail = fitting[int(rng.integers(3))]
        return f"{clause}, {tail}"


def _worded(part: _Part, clause: str) -> str:
    lead = re.sub(r"\bwhen $", "while ", part.lead)
    lead = re.sub(r"^Driving (\w)", lambda m: m[1].upper(), lead)
    is_start = not lead or lead.rstrip().endswith(".")
    first = clause[0].upper() if is_start else clause[0]
    return f"{lead}{first}{clause[1:]}{part.trail}."


def _whole(part: _Part) -> str:
    return f"{part.lead}{part.event}{part.trail}".rstrip(".") + "."


def _name(text: str) -> Name:
    """Return what a text calls the ego vehicle."""
    low = text.casefold()
    if "ego" not in low:
        return "I" if re.search(r"\b(?:my|i|me)\b", low) else "the ego vehicle"
    if "ego car" in low or "the ego lane" in low:
        return "the ego car"
    return "the ego vehicle" if "the ego" in low else "ego"


def _frames(knowledge: Knowledge) -> Iterator[str]:
    for place in knowledge.places:
        for phrase in place.phrases:
            yield phrase
            noun = nominal(phrase)
            if noun:
                yield noun
                yield re.sub(r"^an? ", "", noun)
    for condition in knowledge.conditions:
        yield from condition.phrases
        yield from condition.statements
    for traffic in knowledge.traffic:
        for phrase in traffic.phrases:
            yield phrase
            yield phrase.removeprefix("while ")
    yield from ("the scene is", "it happens", "driving")


def _alternatives(phrases: Iterable[str]) -> str:
    longest = sorted(dict.fromkeys(phrases), key=lambda phrase: (-len(phrase), phrase))
    return "|".join(re.escape(phrase) for phrase in longest)
