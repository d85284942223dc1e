"""Ordinary twins: texts whose event is replaced by its ordinary counterpart.

Only the text itself is available. The phrases of the knowledge base separate road, weather and
traffic from the event, so a text in other words has no twin.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from oodscen._words.text import folded_words
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.ego_naming import Name, clause_with_ego_named
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._writing.agreement import Agreement, PlaceAndTime
from oodscen.author._writing.constructions import KEEPS_ON, nominal, standing
from oodscen.author._writing.headline import headline
from oodscen.author._writing.ordinary_road_user import ordinary_road_user
from oodscen.errors import LLMError

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
_NOWHERE = re.compile(rf"(?:(?<=^)|(?<=, )|(?<=\. )){_DRIVES}\s*$", re.IGNORECASE)
"""A clause in which the ego drives but whose location belongs to the event."""
_HAPPENS = "It happens "
_SENTENCES = re.compile(r"(?<=[.!?])\s+(?=[A-Z\d])")
_SLACK = 3
"""Number of words by which a twin may be shorter than its text before an ordinary clause is added."""
_NEAREST = 8
"""Number of clauses about ordinary driving, of the best-fitting length, from which one is drawn."""
_REPEATED = 1.0
"""Penalty for a repeated word, in words of wrong length."""
_ANY_ROAD = (
    "the lane ahead is clear and traffic moves along as usual",
    "the lane ahead is clear and nothing moves in it",
)
_EXCESS = 4
"""Number of words by which an addition may exceed the missing length."""
_TURNS = re.compile(
    r"\b(?:turn(?:s|ing)?|roundabout|u-turn|merg\w+|ramp|curves?|bends?)\b", re.IGNORECASE
)
_LINE_SEPARATOR = ": "
"""Separator of place and event in a line of a test catalogue."""
_QUIET = "quiet"
"""Key of the entry for absent traffic."""
_REPEATABLE = frozenset(
    "a an and as at by i in is it its me my of on the to with ego vehicle car up one that".split()
)
"""Words that may be repeated."""


@dataclass(frozen=True)
class _SentenceParts:
    """One sentence, split into its parts."""

    lead: str
    event: str
    trail: str


class OrdinaryAuthor:
    """Writes ordinary twins."""

    def __init__(self, knowledge: Knowledge, recogniser: Recogniser) -> None:
        self._recogniser = recogniser
        self._agreement = Agreement(knowledge)
        self._driving = knowledge.driving
        self._details = {
            folded_words(detail) for hazard in knowledge.hazards for detail in hazard.details
        }
        frame = _alternatives(_frames(knowledge))
        weather = (
            phrase
            for condition in knowledge.conditions
            for phrase in (*condition.phrases, *condition.statements)
        )
        self._weather = re.compile(_alternatives(weather), re.IGNORECASE)
        self._lead = re.compile(rf"(?:(?:{frame}|{_DRIVES}){_LINK})+", re.IGNORECASE)
        places = _alternatives(_places(knowledge))
        self._known_place = re.compile(rf"\b(?:{places})\b", re.IGNORECASE)
        self._trail = re.compile(
            rf"(?:,? while (?:{_DRIVES}|{_EGO})(?: (?:{frame}))*)\.?$", re.IGNORECASE
        )

    def twin(self, text: str, label: str, rng: np.random.Generator) -> str:
        """Return the ordinary twin of a text; a text that is not recognised is about the hazard of its leaf's label.

        Raises:
            LLMError: If the text contains no place in the words of the knowledge base.
        """
        hazard = self._recogniser.recognise(text).hazard
        if hazard is None and label:
            hazard = next(iter(self._recogniser.covered_by(label)), None)
        if self._known_place.search(text) is None:
            raise LLMError(
                "the built-in author finds none of its own phrases for a place in the text, and "
                "writes ordinary twins only of texts that have one"
            )
        parts = list(self._split(text))
        events = (
            index
            for index, part in enumerate(parts)
            if part.event and folded_words(part.event) not in self._details
        )
        event_index = next(events, None)
        if event_index is None:
            event_index = len(parts) - 1
            parts[event_index] = _SentenceParts("", _unchanged(parts[event_index]), "")
        event = parts[event_index]
        kept = [part for index, part in enumerate(parts) if index == event_index or not part.event]
        length = len(folded_words(text).split())
        if not event.lead and not event.trail and kept[-1] is not event:
            event, kept = _placed_first(event, kept)
        frame = " ".join(part.lead + part.trail for part in kept)
        room = 0 if event.trail else length - len(folded_words(frame).split())
        setting = self._setting(frame, text, hazard)
        clause = _not_twice(frame, self._counterpart(hazard, setting, text))
        name = _name(text)
        is_line = event.lead.endswith(_LINE_SEPARATOR)
        wording = headline(clause) if is_line else clause
        last = _with_clause(event, clause_with_ego_named(wording, name))
        missing = room - len(clause.split())
        if missing > _SLACK:
            more = clause_with_ego_named(
                self._more(clause, f"{frame} {clause}", missing, setting, rng), name
            )
            more = headline(more) if is_line else more
            if more and (_is_joined(event.lead, clause) or " and " in more):
                last = f"{last} {more[0].upper()}{more[1:]}."
            elif more:
                last = f"{last.rstrip('.')}, and {more}."
        return " ".join(last if part is event else _unchanged(part) for part in kept)

    def _split(self, text: str) -> Iterator[_SentenceParts]:
        """Split the text into sentences and their parts; the ego's location is recognised only once."""
        is_placed = False
        for sentence in _SENTENCES.split(text.strip()):
            part = self._apart(sentence, is_placed)
            lead = self._weather.sub("", part.lead)
            is_placed = is_placed or _ROAD.search(lead) is not None
            yield part

    def _apart(self, sentence: str, is_placed: bool) -> _SentenceParts:
        match = self._lead.match(sentence)
        if is_placed and (match is None or folded_words(sentence[match.end() :])):
            return _SentenceParts("", sentence.rstrip("."), "")
        cut = match.end() if match is not None else 0
        if cut and not folded_words(sentence[cut:]):
            return _SentenceParts(sentence, "", "")
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
        if cut and not folded_words(sentence[cut:]):
            return _SentenceParts(sentence, "", "")
        trail = self._trail.search(sentence, cut)
        end = trail.start() if trail is not None else len(sentence.rstrip("."))
        return _SentenceParts(sentence[:cut], sentence[cut:end], sentence[end:].rstrip("."))

    def _setting(self, frame: str, text: str, hazard: HazardKind | None) -> PlaceAndTime:
        """Return the place and time of the kept part of a text, as far as it states them."""
        recogniser = self._recogniser
        place = recogniser.place(frame) or recogniser.place(text, hazard.places if hazard else ())
        traffic = recogniser.traffic(frame)
        return PlaceAndTime(
            place=place.key if place else "",
            conditions=tuple(condition.key for condition in recogniser.conditions(frame)),
            traffic=traffic.key if traffic else "",
        )

    def _counterpart(self, hazard: HazardKind | None, setting: PlaceAndTime, text: str) -> str:
        """Return what the twin's scene shows in place of the hazard, or the first suitable counterpart.

        It mentions no other road users if there are none.
        """
        place = self._recogniser.place(text, hazard.places) if hazard else None
        road_user = ordinary_road_user(hazard, text, place)
        if road_user is not None and setting.traffic != _QUIET:
            return road_user.clause
        if hazard is not None and hazard.stage is not None and hazard.stage.removes_hazards:
            return _ANY_ROAD[1]
        options = (*hazard.ordinary, *_ANY_ROAD) if hazard is not None else _ANY_ROAD
        suiting = self._agreement.suiting(options, setting)
        return suiting[0] if suiting else _ANY_ROAD[0]

    def _more(
        self,
        clause: str,
        text: str,
        missing: int,
        setting: PlaceAndTime,
        rng: np.random.Generator,
    ) -> str:
        """Return an ordinary clause of about the missing length that adds to the existing text."""
        fitting = [
            phrase
            for driving in self._driving
            if driving.others == "none"
            and (not driving.places or setting.place in driving.places)
            and (not driving.conditions or set(setting.conditions) & set(driving.conditions))
            for phrase in driving.phrases
            if self._agreement.suits(phrase, setting) and len(phrase.split()) <= missing + _EXCESS
        ]
        if "traffic" in clause:
            fitting = [phrase for phrase in fitting if "traffic" not in phrase]
        if _TURNS.search(text):
            fitting = [phrase for phrase in fitting if "straight" not in phrase]
        used = set(folded_words(text).split()) - _REPEATABLE

        def penalty(phrase: str) -> float:
            words = folded_words(phrase).split()
            return abs(len(words) - missing) + _REPEATED * len(used & set(words))

        fitting.sort(key=penalty)
        return fitting[int(rng.integers(min(_NEAREST, len(fitting))))] if fitting else ""


def _not_twice(frame: str, clause: str) -> str:
    """Return a clause that avoids the word `clear` for a lane if the frame uses it for the weather."""
    if re.search(r"\bclear\b", frame, re.IGNORECASE) is None:
        return clause
    clause = re.sub(r"\b(air(?: over the road)?) is clear\b", r"\1 is clean", clause)
    named = r"\b((?:lane|road)(?: ahead)?(?: of the ego vehicle)?) is clear\b"
    return re.sub(named, r"\1 is free", clause)


def _placed_first(
    event: _SentenceParts, kept: list[_SentenceParts]
) -> tuple[_SentenceParts, list[_SentenceParts]]:
    """Move the event after the part that says where the ego is."""
    rest = [part for part in kept if part is not event]
    where = rest[-1].lead
    if where.startswith(_HAPPENS):
        bare = where.removeprefix(_HAPPENS).rstrip(".")
        event = _SentenceParts(f"{bare[0].upper()}{bare[1:]}, ", event.event, "")
        rest = rest[:-1]
    return event, [*rest, event]


def _is_joined(lead: str, clause: str) -> bool:
    """Return whether a further clause needs its own sentence because this one already joins several."""
    return (
        " and " in clause
        or ", " in clause
        or re.search(r"\b(?:and|while|when) $", lead) is not None
    )


def _with_clause(part: _SentenceParts, clause: str) -> str:
    lead = re.sub(r"\bwhen $", "while ", part.lead)
    lead = _NOWHERE.sub("", lead)
    if " and " in clause:
        lead = re.sub(r",? and $", ". ", lead)
    lead = re.sub(r"^Driving (\w)", lambda m: m[1].upper(), lead)
    is_start = not lead or lead.endswith((".", ". "))
    first = clause[0].upper() if is_start else clause[0]
    return f"{lead}{first}{clause[1:]}{part.trail}."


def _unchanged(part: _SentenceParts) -> str:
    return f"{part.lead}{part.event}{part.trail}".rstrip(".") + "."


def _name(text: str) -> Name:
    """Return the name of the ego vehicle in a text."""
    low = text.casefold()
    if "ego" not in low:
        return "I" if re.search(r"\b(?:my|i|me)\b", low) else "the ego vehicle"
    if "ego car" in low or "the ego lane" in low:
        return "the ego car"
    return "the ego vehicle" if "the ego" in low else "ego"


def _places(knowledge: Knowledge) -> Iterator[str]:
    for place in knowledge.places:
        for phrase in place.phrases:
            yield phrase
            yield standing(phrase)
            noun = nominal(phrase)
            if noun:
                yield noun
                yield re.sub(r"^an? ", "", noun)


def _frames(knowledge: Knowledge) -> Iterator[str]:
    yield from _places(knowledge)
    for condition in knowledge.conditions:
        yield from condition.phrases
        yield from condition.statements
    for traffic in knowledge.traffic:
        for phrase in traffic.phrases:
            yield phrase
            yield phrase.removeprefix("while ")
    yield from ("the scene is", "it happens", "driving")
    for subject in ("it", "ego", "the ego vehicle"):
        yield f"{subject} {KEEPS_ON}"


def _alternatives(phrases: Iterable[str]) -> str:
    longest = sorted(dict.fromkeys(phrases), key=lambda phrase: (-len(phrase), phrase))
    return "|".join(re.escape(phrase) for phrase in longest)
