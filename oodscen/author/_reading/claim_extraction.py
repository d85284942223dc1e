"""Extraction of claims: the statements of a text about a scene, from its words alone."""

import re
import unicodedata

from oodscen._words.text import one_line
from oodscen.author._reading import phrases
from oodscen.author._reading.claim_selection import CLEARING_PLACES, SIDES, consistent
from oodscen.author._reading.clauses import Noun, Subject
from oodscen.author._reading.numbers import number_at
from oodscen.author._reading.phrases import Pattern
from oodscen.author._reading.stationarity import usual_motion
from oodscen.author._reading.text_structure import TextStructure
from oodscen.author._reading.unreal import is_unreal
from oodscen.claims._things import mentions
from oodscen.data._claim import Claim, Kind

_WILFUL = frozenset(
    {"oncoming", "moving", "slow", "reversing", "crossing", "from_left", "from_right"}
)
"""Motions that inert things do not have."""
_PLAIN = str.maketrans({"\u2019": "'", "\u2010": "-", "\u2011": "-"})
"""Typographic apostrophes and hyphens, also those at which no line breaks, and the plain ones."""
_LONGEST_QUOTE = 200
"""Length of the longest quote, in characters."""
_SMALL_WORD = re.compile(r"\b(?:the|an?|of|in|on|by|with|from|and|to|its)\b", re.IGNORECASE)
_NEAR = 40
"""Number of characters before a word in which the words that go with it are looked for."""
_BLOCKED_WITHIN = 30
"""Largest distance from `blocked by` to the noun that blocks, in characters."""


def read_claims(text: str) -> tuple[Claim, ...]:
    """Return the claims of a text: settings first, then thing by thing."""
    plain = unicodedata.normalize("NFC", text).translate(_PLAIN)
    return _ClaimReader(one_line(plain)).claims()


class _ClaimReader:
    def __init__(self, text: str) -> None:
        self._text = text
        self._structure = TextStructure(text)
        self._claims: dict[tuple[Kind, str, str], Claim] = {}
        """Claims by kind, value and subject."""

    def claims(self) -> tuple[Claim, ...]:
        """Read all claims, and return those that do not give way to others."""
        self._read_settings()
        for subject in self._structure.subjects:
            if not subject.is_faint:
                self._add_presence(subject)
        for pattern in phrases.statements("predicate"):
            for match in pattern.regex.finditer(self._text):
                self._read_predicate(pattern, match)
        for noun in self._structure.nouns:
            if noun.subject is not None:
                self._read_adjectives(noun, noun.subject)
        self._read_blocking()
        self._read_signals()
        self._add_usual_motions()
        return tuple(consistent(self._claims))

    def _add(self, kind: Kind, value: str, subject: str, start: int, end: int) -> None:
        """Add a claim, unless it is there, with the words between two positions as its quote."""
        key = (kind, value, subject)
        if key in self._claims:
            return
        quote = self._text[start:end]
        if len(quote) > _LONGEST_QUOTE:
            quote = quote[: _LONGEST_QUOTE + 1].rpartition(" ")[0]
        self._claims[key] = Claim(kind=kind, value=value, subject=subject, quote=quote)

    def _add_presence(self, subject: Subject) -> None:
        start, end, thing = subject.mention.start, subject.mention.end, subject.mention.thing
        self._add("thing", "present", subject.name, start, end)
        if subject.count > 1 and not (thing.many or thing.map or thing.vague):
            self._add("count", str(subject.count), subject.name, start, end)

    def _add_usual_motions(self) -> None:
        """Claim the motions that things have by their nature, where the text tells none."""
        structure = self._structure
        claimed: dict[str, set[str]] = {}
        for kind, value, name in self._claims:
            if kind in ("motion", "place"):
                claimed.setdefault(name, set()).add(f"{kind} {value}")
        for subject in structure.subjects:
            motion = usual_motion(
                self._text, subject, structure.nouns, claimed.get(subject.name, set())
            )
            if motion is not None:
                self._add_presence(subject)
                mention = subject.mention
                self._add("motion", motion, subject.name, mention.start, mention.end)

    def _read_blocking(self) -> None:
        """Claim that what blocks the way is in the lane."""
        for match in phrases.context("blocked_by").finditer(self._text):
            following = (
                noun
                for noun in self._structure.nouns
                if 0 <= noun.start - match.end() <= _BLOCKED_WITHIN
            )
            noun = next(following, None)
            if noun is not None and noun.subject is not None:
                self._add("place", "in_lane", noun.subject.name, *match.span())

    def _read_signals(self) -> None:
        """Claim states of the traffic light, which need not stand beside its name."""
        lights = [
            subject
            for subject in self._structure.subjects
            if subject.mention.thing.name == "traffic light"
        ]
        if not lights:
            return
        for pattern in phrases.statements("signal"):
            for match in pattern.regex.finditer(self._text):
                self._add(pattern.kind, pattern.value, lights[0].name, *match.span())

    def _read_settings(self) -> None:
        """Claim weather, time, road, lanes, traffic and ego."""
        unreal: list[tuple[Kind, int, int]] = []
        mentioned = list(mentions(self._text))
        for pattern in phrases.statements("setting"):
            for match in pattern.regex.finditer(self._text):
                kind, start, end = pattern.kind, *match.span()
                is_within = any(
                    kind == other and first <= start and end <= last
                    for other, first, last in unreal
                )
                if is_within or is_unreal(kind, match, mentioned):
                    unreal.append((kind, start, end))
                    continue
                value = self._value(pattern, match)
                if value is None:
                    continue
                self._add(kind, value, "", start, end)
                if kind == "own_lanes" and re.search(
                    "each|either|per", match.group(0), re.IGNORECASE
                ):
                    self._add("road", "two_way", "", start, end)

    def _read_adjectives(self, noun: Noun, subject: Subject) -> None:
        """Claim what the adjectives right before a noun say."""
        lead = self._text[max(0, noun.start - _NEAR) : noun.start]
        if re.match(r"[\w-]", self._text[noun.start - len(lead) - 1 : noun.start - len(lead)]):
            lead = re.sub(r"^[\w-]+", "", lead)
        words = re.search(r"(?:[\w-]+,?\s+){1,4}$", lead)
        phrase = f"{words.group(0) if words else ''}{self._text[noun.start : noun.end]}"
        shift = noun.end - len(phrase)
        for pattern in phrases.statements("lead"):
            for match in pattern.regex.finditer(phrase):
                if match.end() > noun.start - shift:
                    continue
                between = phrase[match.end() : len(phrase) - (noun.end - noun.start)]
                if _SMALL_WORD.search(between):
                    continue
                if subject.is_faint and (subject.mention.thing.vague or "," in between):
                    continue
                self._add_presence(subject)
                start, end = match.start() + shift, match.end() + shift
                self._add(pattern.kind, pattern.value, subject.name, start, end)

    def _read_predicate(self, pattern: Pattern, match: re.Match[str]) -> None:
        """Claim what a predicate says of the thing that it describes."""
        start = match.end() - len(match.group(0).lstrip(" "))
        end = match.end()
        is_verb = pattern.kind == "motion"
        value = self._value(pattern, match)
        if value is None or self._is_denied(pattern, start, end):
            return
        if pattern.value in SIDES:
            subject = self._structure.comer(start, end)
        else:
            subject = self._structure.owner(start, end, is_verb=is_verb)
        is_of_it = pattern.kind == "distance" and self._text.startswith(" of it", end)
        if subject is None or (subject.is_faint and not is_verb and not _adjoins(subject, start)):
            if not is_of_it:
                self._add_unowned(pattern, value, *match.span())
            return
        if is_of_it and self._structure.names_others(start, subject, whole=True):
            return
        if not self._may_hold(pattern, match.group(0), start, subject):
            return
        doer = self._on_foot(subject, start) if is_verb else subject
        if doer is not None:
            if doer.is_faint:
                self._add_presence(doer)
            self._add(pattern.kind, value, doer.name, start, end)

    def _value(self, pattern: Pattern, match: re.Match[str]) -> str | None:
        """Return what a match claims; `None` if its number cannot be read."""
        if pattern.value:
            return pattern.value
        number = number_at(self._text, *match.span(1))
        return None if number is None else str(number)

    def _is_denied(self, pattern: Pattern, start: int, end: int) -> bool:
        """Return whether the words around a predicate take it back, or make it a modifier."""
        lead, value = self._text[:start][-_NEAR:], pattern.value
        if pattern.kind == "motion":
            is_over = value not in ("stationary", "slow") and phrases.context("perfect").search(
                lead
            )
            is_weather = value not in SIDES and phrases.context("weather_does").search(lead)
            if phrases.context("forbidden").search(lead) or is_weather or is_over:
                return True
            word_end = start + len("left")
            if phrases.context("heads_left").search(self._text[:word_end][-_NEAR:]):
                return True
            return self._structure.modifies_noun(end) or self._structure.is_within_noun(start)
        if value == "off":
            return False
        if pattern.kind == "state" and phrases.context("unshown").search(lead):
            return True
        is_left = value == "clear_of_lane" and phrases.context("left").search(lead)
        return bool(phrases.context("negated").search(lead) or is_left)

    def _may_hold(self, pattern: Pattern, words: str, start: int, subject: Subject) -> bool:
        """Return whether a predicate can be about a thing at all."""
        thing, value = subject.mention.thing, pattern.value
        if pattern.kind == "state":
            return thing.group in ("vehicle", "signal")
        if value == "behind":
            is_clear = thing.group == "vehicle" and not self._structure.names_others(start, subject)
            return is_clear or phrases.context("ego").search(words) is not None
        if pattern.kind != "motion":
            return True
        if value == "stationary":
            return not subject.is_agent
        if value == "reversing" and thing.group != "vehicle" and not subject.is_faint:
            return False
        if thing.name == "car door" and value == "into_lane":
            return False
        return not (thing.name in phrases.things("inert") and value in _WILFUL)

    def _on_foot(self, subject: Subject, start: int) -> Subject | None:
        """Return the subject who walks, if a verb is for people on foot; `None` if no subject can walk.

        The subject of a vehicle that "walks" is its driver; an unnamed subject is a pedestrian.
        """
        thing = subject.mention.thing
        is_vehicle = thing.group == "vehicle" and thing.name not in phrases.things("cycles")
        if is_vehicle and phrases.context("strides").match(self._text, start):
            drivers = [
                other for other in self._structure.subjects if other.mention.thing.name == "driver"
            ]
            if not drivers:
                return None
            subject = self._pedestrian(drivers[-1])
        is_walker = subject.is_faint and phrases.context("on_foot").match(self._text, start)
        return self._pedestrian(subject) if is_walker else subject

    def _pedestrian(self, subject: Subject) -> Subject:
        """Return a subject for an unnamed pedestrian, unless the text names people."""
        subjects = self._structure.subjects
        if any(other.mention.thing.group == "person" for other in subjects):
            return subject
        mention = next(mentions("person"))
        start, end = subject.mention.start, subject.mention.end
        pedestrian = Subject("person", mention._replace(start=start, end=end))
        subjects.append(pedestrian)
        self._add_presence(pedestrian)
        return pedestrian

    def _add_unowned(self, pattern: Pattern, value: str, start: int, end: int) -> None:
        """Claim a place or distance of the only thing that its sentence names, or else of something."""
        is_from_side = pattern.value in ("reversing", *SIDES)
        may_be_unowned = pattern.kind == "distance" or pattern.value in ("ahead", "in_lane")
        if not may_be_unowned and not is_from_side:
            return
        if self._structure.is_about_absent(start):
            return
        clauses = self._structure.clauses
        index = self._structure.clause_at(start)
        clause = clauses[index]
        words = self._text[clause.start : clause.end]
        if is_from_side and clause.nouns:
            return
        if pattern.value == "in_lane" and self._is_about_ego(index, start):
            return
        named = [
            noun.subject
            for other in clauses
            if other.sentence == clause.sentence
            for noun in other.nouns
            if noun.subject is not None
        ]
        lies = pattern.kind == "place" and phrases.context("lies").search(words)
        if phrases.context("roadway").search(words) or not (lies or named):
            return
        certain = {subject.name: subject for subject in named if not subject.is_faint}
        if len(certain) == 1:
            (subject,) = certain.values()
            if not self._is_elsewhere(subject):
                self._add(pattern.kind, value, subject.name, start, end)
                return
        if is_from_side:
            return
        self._add("thing", "present", "something", start, end)
        self._add(pattern.kind, value, "something", start, end)

    def _is_about_ego(self, index: int, start: int) -> bool:
        """Return whether the ego is the subject before a position in a clause, or else of the clause before."""
        clauses = self._structure.clauses
        heads = [noun for noun in clauses[index].nouns if noun.start < start]
        if not heads and index and clauses[index - 1].sentence == clauses[index].sentence:
            heads = clauses[index - 1].nouns
        return any(noun.subject is None and not noun.is_oblique for noun in heads)

    def _is_elsewhere(self, subject: Subject) -> bool:
        """Return whether the text puts a thing somewhere other than the ego's lane ahead."""
        return any(("place", value, subject.name) in self._claims for value in CLEARING_PLACES)


def _adjoins(subject: Subject, start: int) -> bool:
    return subject.mention.thing.name == "driver" and 0 <= start - subject.mention.end <= 1
