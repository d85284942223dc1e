"""Interpretation, thing by thing, of labels that the author did not write itself."""

import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import lru_cache

from oodscen._words.text import stem
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.alternatives import NamedThing, alternatives, conjuncts, subject
from oodscen.author._reading.lexicon import NEUTRAL, Lexicon, Meaning
from oodscen.author._reading.readings import Alternative, LabelReading, RequiredThing
from oodscen.author._reading.stemming import stems
from oodscen.author._reading.weather_words import (
    WEATHER_WORDS,
    circumstances,
    weather_kinds,
    weather_stems,
    without_circumstances,
)
from oodscen.data._category import Category

_MOST_MEMBERS = 12
"""Largest number of hazards for one word that names a whole category."""
_PRESENT = frozenset({"animal", "pedestrian", "object", "vegetation", "work_zone"})
"""Categories whose members are unusual by their mere presence on the road."""
_NEGATION = re.compile(r"\b(?:no|not|without|missing|never|absent|lack)\b", re.IGNORECASE)
_STRENGTHS = frozenset(
    map(stem, "heavy dense thick strong intense extreme severe sudden falling pouring".split())
)
_EMPTY_HEADS = frozenset(map(stem, "incident event situation scenario encounter presence".split()))
"""Stems of nouns that say only that something happens."""


class LabelReader:
    """Splits labels and finds the hazards that their parts name.

    Args:
        knowledge: The knowledge base to search.
        recognise: Returns the hazard that a text resembles most.
        known: Returns the hazard of a label that the author wrote itself.
    """

    def __init__(
        self,
        knowledge: Knowledge,
        recognise: Callable[[str], HazardKind | None],
        known: Callable[[str], HazardKind | None],
    ) -> None:
        self.knowledge = knowledge
        self._recognise = recognise
        self._known = known
        self._lexicon = Lexicon(knowledge)
        self.read = lru_cache(maxsize=4096)(self._read)
        self.hazard = lru_cache(maxsize=8192)(self._hazard)

    def _read(self, label: str) -> LabelReading:
        text = " ".join(re.sub(r"<[^<>]*>", " ", label).split())
        split = alternatives(text)
        if len(split.shares) == 1:
            return self._single(text)
        whole = self.hazard(text)
        shares = tuple(self._share(share, whole) for share in split.shares)
        if all(alternative.parts[0].why for alternative in shares):
            return self._single(text)
        return LabelReading(shares, split)

    def _single(self, text: str) -> LabelReading:
        options = self._options(text)
        if len(options) > 1:
            alternatives_of_category = (
                Alternative(part.hazard.label, (part,))
                for part in options
                if part.hazard is not None
            )
            return LabelReading(tuple(alternatives_of_category), is_any=True)
        return LabelReading((Alternative(text, self._together(text)),))

    def _share(self, share: NamedThing, whole: HazardKind | None) -> Alternative:
        """Return the meaning of one of several things, or else that of the whole label if it covers the thing."""
        first: Alternative | None = None
        for reading in share.readings:
            alternative = Alternative(reading, self._together(reading, share))
            if not any(part.why for part in alternative.parts):
                return alternative
            first = first or alternative
        if whole is not None and self._lexicon.covers(whole, share.name):
            return Alternative(share.readings[0], (RequiredThing(whole),))
        assert first is not None
        return first

    def _together(self, text: str, share: NamedThing | None = None) -> tuple[RequiredThing, ...]:
        """Return all parts that a text without alternatives needs."""
        split = conjuncts(text)
        if len(split.shares) > 1 and self._known(text) is None:
            whole = self.hazard(text)
            if whole is None or not all(
                self._lexicon.covers(whole, thing.name) for thing in split.shares
            ):
                parts = _without_repeats(self._first(thing) for thing in split.shares)
                if whole is None or not all(part.why for part in parts):
                    return parts
        part = self._options(text)[0]
        if share is not None and part.hazard is not None and not share.is_act:
            own = set(stems(share.name)) - NEUTRAL
            if (
                own
                and not own & self._lexicon.vocabulary(part.hazard).every
                and not self._is_of(part, own)
            ):
                return (RequiredThing(why=f"the author has no knowledge of {text!r}"),)
        return (part,)

    def _first(self, share: NamedThing) -> RequiredThing:
        """Return the meaning of one conjunct: its most likely reading with a known meaning."""
        things = [self._options(reading)[0] for reading in share.readings]
        return next((part for part in things if not part.why), things[0])

    def _is_of(self, part: RequiredThing, own: set[str]) -> bool:
        """Return whether a hazard was found through the weather or the thing that its words name."""
        assert part.hazard is not None
        needs, things = part.hazard.needs, self._lexicon.things_named_by(own)
        return bool(things & set(needs.assets) or set(weather_kinds(own)) & set(needs.weather))

    def _options(self, text: str) -> tuple[RequiredThing, ...]:
        """Return the parts, any of which a text may mean; usually a single one."""
        hazard_kind = self._known(text)
        if hazard_kind is not None:
            return (RequiredThing(hazard_kind),)
        affirmed = self._lexicon.affirmed(text)
        if affirmed != text:
            hazard = self._recognise(text)
            if hazard is not None and _is_about_absence(hazard):
                return (RequiredThing(hazard),)
            if not set(stems(affirmed)) - NEUTRAL:
                return (RequiredThing(why=f"{text!r} says what is not there, and nothing that is"),)
            return self._options(affirmed)
        weather_hazard = self._weather(text)
        if weather_hazard is not None:
            return (RequiredThing(weather_hazard),)
        weather = circumstances(text)
        hazard = self._lexicon.compound_hazard(text) or self.hazard(text)
        if hazard is not None:
            weather = tuple(kind for kind in weather if kind not in hazard.needs.weather)
            return (replace(self._with_things(text, hazard), weather=weather),)
        plainer = without_circumstances(text) if weather else text
        return tuple(replace(part, weather=weather) for part in self._by_category(plainer))

    def _hazard(self, text: str) -> HazardKind | None:
        """Return the hazard that a text resembles most, if it concerns the same thing."""
        written = self._known(text)
        if written is not None:
            return written
        hazard = self._recognise(text)
        if hazard is None:
            return None
        if self._lexicon.affirmed(text) != text:
            return hazard if _is_about_absence(hazard) else None
        words = _subject_stems(text)
        if not words:
            return hazard
        vocabulary = self._lexicon.vocabulary(hazard)
        if words[-1] in vocabulary.every or set(words) & vocabulary.naming:
            return hazard
        meaning = self._lexicon.named_at_end(words)
        if meaning is None or meaning.thing:
            return None
        return hazard if meaning.category in self._lexicon.categories(hazard) else None

    def _with_things(self, text: str, hazard: HazardKind) -> RequiredThing:
        """Add the other things that a text names, and the words that the hazard only approximates."""
        every = self._lexicon.vocabulary(hazard).every
        things: dict[str, None] = {}
        approximate: dict[str, None] = {}
        for words, meaning, after in self._lexicon.other_names(text, hazard):
            phrase = _phrase(text, words, after)
            if not (phrase and after in every and after not in NEUTRAL):
                things[meaning.thing] = None
            elif meaning.category == "animal":
                approximate[phrase] = None
        return RequiredThing(hazard, things=tuple(things), approximate=tuple(approximate))

    def _by_category(self, text: str) -> tuple[RequiredThing, ...]:
        """Return the hazards with the thing at the end of a text, or of its category."""
        words = _subject_stems(text)
        named = self._lexicon.named_at_end(words)
        if named is None:
            return (RequiredThing(why=f"the author has no knowledge of {text!r}"),)
        rest = set(stems(text)) - NEUTRAL - self._lexicon.naming_words(words)
        if named.thing:
            return (self._with_thing(text, named, rest),)
        is_mere = named.category in _PRESENT and not rest
        if is_mere and (members := self._mere_members(named.category)):
            return tuple(map(RequiredThing, members[:_MOST_MEMBERS]))
        why = f"the author knows no scenario for {text!r}"
        return (RequiredThing(category=named.category, why=why),)

    def _with_thing(self, text: str, named: Meaning, rest: set[str]) -> RequiredThing:
        """Return the first hazard with a thing that covers the rest of a text's words."""
        thing, category = named.thing, named.category
        users = [hazard for hazard in self.knowledge.hazards if thing in hazard.needs.assets]
        users.sort(key=lambda hazard: (hazard.needs.assets.index(thing), hazard.stage is None))
        for hazard in users if rest or category in _PRESENT else ():
            if rest <= self._lexicon.vocabulary(hazard).every:
                return RequiredThing(hazard)
        why = f"the author knows no scenario with {thing.replace('_', ' ')} for {text!r}"
        return RequiredThing(things=(thing,), category=category, why=why)

    def _mere_members(self, category: Category) -> list[HazardKind]:
        """Return the hazards that need nothing but things of a category."""
        return [
            hazard
            for hazard in self.knowledge.hazards
            if hazard.stage is not None
            and not hazard.needs.weather
            and not hazard.needs.traits
            and self._lexicon.categories(hazard) == {category}
        ]

    def _weather(self, text: str) -> HazardKind | None:
        """Return the hazard that consists of weather alone, if the text names nothing else."""
        left = set(stems(text)) - _STRENGTHS - NEUTRAL
        for kind in WEATHER_WORDS:
            if left and left <= weather_stems(kind):
                return next(
                    (
                        hazard
                        for hazard in self.knowledge.hazards
                        if hazard.needs.weather == (kind,) and hazard.stage and hazard.stage.weather
                    ),
                    None,
                )
        return None


def _subject_stems(text: str) -> list[str]:
    """Return the stems of a text's subject, without heads that name nothing."""
    words = stems(" ".join(subject(text)))
    while words and words[-1] in _EMPTY_HEADS:
        words.pop()
    return words


def _without_repeats(parts: Iterable[RequiredThing]) -> tuple[RequiredThing, ...]:
    """Remove duplicate parts."""
    things: list[RequiredThing] = []
    for part in parts:
        if part not in things:
            things.append(part)
    return tuple(things)


def _is_about_absence(hazard: HazardKind) -> bool:
    return bool(_NEGATION.search(" ".join((hazard.label, hazard.wider, *hazard.words))))


def _phrase(text: str, words: Iterable[str], after: str) -> str:
    """Return the words of a text for a thing and the noun that it modifies: `dog costume`."""
    tokens = re.findall(r"[A-Za-z]+", text)
    phrase_stems = [*words, after]
    for start in range(len(tokens) - len(phrase_stems) + 1):
        phrase = tokens[start : start + len(phrase_stems)]
        if [stem(token.casefold()) for token in phrase] == phrase_stems:
            return " ".join(phrase).casefold()
    return ""
