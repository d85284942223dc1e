"""Interpretation, thing by thing, of labels that the author did not write itself."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

from oodscen._text import stem
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.alternatives import NamedThing, Split, alternatives, conjuncts, subject
from oodscen.author._reading.stemming import stems
from oodscen.data._category import Category
from oodscen.data._scene import WeatherKind

_MOST = 12
"""Largest number of hazards for one word that names a whole category."""
_PRESENT = frozenset({"animal", "pedestrian", "object", "vegetation", "work_zone"})
"""Categories whose members are unusual by their mere presence on the road."""
_NEGATED = re.compile(
    r"\b(?:no|not|without|neither|nor|never|free of|absence of|lack of|instead of)\s+"
    r"(?:(?:a|an|any|the|single)\s+)*(\w+(?:[-\s]\w+)?)",
    re.IGNORECASE,
)
_NEGATION = re.compile(r"\b(?:no|not|without|missing|never|absent|lack)\b", re.IGNORECASE)
_WEATHER: Mapping[WeatherKind, tuple[str, ...]] = {
    "rain": ("rain", "rainfall", "downpour", "rainstorm", "cloudburst"),
    "snow": ("snow", "snowfall", "snowstorm", "blizzard"),
    "fog": ("fog", "mist", "foggy"),
    "ice": ("ice", "icy"),
}
_CIRCUMSTANCE = re.compile(
    r"\b(?:at|in|during|under|by|amid)\s+(?:(?!and\b|or\b)\w+\s+){0,2}?"
    r"(night(?:time)?|dark(?:ness)?|rain(?:fall)?|snow(?:fall)?|fog|mist)\b",
    re.IGNORECASE,
)
_STRENGTHS = frozenset(
    map(stem, "heavy dense thick strong intense extreme severe sudden falling pouring".split())
)
_NEUTRAL = frozenset(
    map(
        stem,
        """road lane street carriageway highway motorway roadway pavement way ahead front middle
        cross crossing standing lying present appearing encountered wandering unexpected sudden
        large big small several group stray loose wild dangerous incident event situation scenario
        hazard accident encounter presence anywhere somewhere nearby""".split(),
    )
)
_EMPTY_HEADS = frozenset(map(stem, "incident event situation scenario encounter presence".split()))
_LONGEST_NAME = 4
"""Words of the longest name that is looked for at the end of a text."""


class _Vocabulary(NamedTuple):
    """The stems of the words about a hazard."""

    naming: frozenset[str]
    """Stems of its names and of the things that it needs."""
    every: frozenset[str]
    """All stems, also of its events and details."""


class _Named(NamedTuple):
    """The meaning of a name."""

    category: Category
    thing: str
    """Empty if the name is that of a whole category."""


@dataclass(frozen=True)
class RequiredThing:
    """One thing that a scene must show."""

    hazard: HazardKind | None = None
    things: tuple[str, ...] = ()
    """Names of further things that it needs."""
    weather: tuple[str, ...] = ()
    """Weather or light in which it happens: `night`."""
    approximate: tuple[str, ...] = ()
    """Words that the hazard only approximates: `dog costume`."""
    category: Category | None = None
    """Category of the named thing, if no hazard is known."""
    why: str = ""
    """The reason if there is no hazard."""


@dataclass(frozen=True)
class Alternative:
    """One of the alternatives of a label."""

    words: str
    parts: tuple[RequiredThing, ...]
    """Parts, all of which are needed."""

    @property
    def hazards(self) -> tuple[HazardKind, ...]:
        """Hazards of the parts, as far as the author knows them."""
        return tuple(part.hazard for part in self.parts if part.hazard is not None)


@dataclass(frozen=True)
class LabelReading:
    """All alternatives of a label."""

    alternatives: tuple[Alternative, ...]
    split: Split | None = None
    """The split of the label, if it was split; its shares are the alternatives."""
    is_any: bool = False
    """True if the label names a category, so that any member will do."""

    @property
    def hazards(self) -> tuple[HazardKind, ...]:
        """All hazards, without duplicates."""
        found = (hazard for one in self.alternatives for hazard in one.hazards)
        return tuple({hazard.id: hazard for hazard in found}.values())


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
        self._names = _names(knowledge)
        self._vocabularies: dict[str, _Vocabulary] = {}
        self._compounds: dict[frozenset[str], list[HazardKind]] = {}
        """Hazards by the words of the first thing that they need, if it has several words."""
        for hazard in knowledge.hazards:
            words = frozenset(stems(" ".join(hazard.needs.assets[:1]).replace("_", " ")))
            if len(words) > 1:
                self._compounds.setdefault(words, []).append(hazard)
        self.read = lru_cache(maxsize=4096)(self._read)
        self.hazard = lru_cache(maxsize=8192)(self._hazard)

    def _read(self, label: str) -> LabelReading:
        text = " ".join(re.sub(r"<[^<>]*>", " ", label).split())
        split = alternatives(text)
        if len(split.shares) == 1:
            return self._single(text)
        whole = self.hazard(text)
        found = tuple(self._share(share, whole) for share in split.shares)
        if all(one.parts[0].why for one in found):
            return self._single(text)
        return LabelReading(found, split)

    def _single(self, text: str) -> LabelReading:
        options = self._options(text)
        if len(options) > 1:
            named = (
                Alternative(part.hazard.label, (part,))
                for part in options
                if part.hazard is not None
            )
            return LabelReading(tuple(named), is_any=True)
        return LabelReading((Alternative(text, self._together(text)),))

    def _share(self, share: NamedThing, whole: HazardKind | None) -> Alternative:
        first: Alternative | None = None
        for reading in share.readings:
            found = Alternative(reading, self._together(reading, share))
            if not any(part.why for part in found.parts):
                return found
            first = first or found
        if whole is not None and self._has_all(whole, share.own):
            return Alternative(share.readings[0], (RequiredThing(whole),))
        assert first is not None
        return first

    def _together(self, text: str, share: NamedThing | None = None) -> tuple[RequiredThing, ...]:
        """Return all parts that a text without alternatives needs."""
        split = conjuncts(text)
        if len(split.shares) > 1 and self._known(text) is None:
            whole = self.hazard(text)
            if whole is None or not all(self._has_all(whole, one.own) for one in split.shares):
                parts = _unequal(self._first(one) for one in split.shares)
                if whole is None or not all(part.why for part in parts):
                    return parts
        part = self._options(text)[0]
        if share is not None and part.hazard is not None and not share.is_act:
            own = set(stems(share.own)) - _NEUTRAL
            if own and not own & self._vocabulary(part.hazard).every and not self._is_of(part, own):
                return (RequiredThing(why=f"the author has no knowledge of {text!r}"),)
        return (part,)

    def _first(self, share: NamedThing) -> RequiredThing:
        """Return the meaning of one conjunct: its most likely reading with a known meaning."""
        found = [self._options(reading)[0] for reading in share.readings]
        return next((part for part in found if not part.why), found[0])

    def _is_of(self, part: RequiredThing, own: set[str]) -> bool:
        """Return whether a hazard was found through the weather or the thing that its words name."""
        things = [named.thing for words, named in self._names.items() if own & set(words)]
        weather = [kind for kind, words in _WEATHER.items() if own & set(map(stem, words))]
        assert part.hazard is not None
        needs = part.hazard.needs
        return bool(set(things) & set(needs.assets) or set(weather) & set(needs.weather))

    def _options(self, text: str) -> tuple[RequiredThing, ...]:
        """Return the parts, any of which a text may mean; usually a single one."""
        known = self._known(text)
        if known is not None:
            return (RequiredThing(known),)
        said = self._affirmed(text)
        if said != text:
            found = self._recognise(text)
            if found is not None and _is_about_absence(found):
                return (RequiredThing(found),)
            if not set(stems(said)) - _NEUTRAL:
                return (RequiredThing(why=f"{text!r} says what is not there, and nothing that is"),)
            return self._options(said)
        weather = self._weather(text)
        if weather is not None:
            return (RequiredThing(weather),)
        when = tuple(dict.fromkeys(map(_kind_of_weather, _CIRCUMSTANCE.findall(text))))
        hazard = self._by_thing(text) or self.hazard(text)
        if hazard is not None:
            when = tuple(kind for kind in when if kind not in hazard.needs.weather)
            return (replace(self._with_things(text, hazard), weather=when),)
        plainer = _CIRCUMSTANCE.sub("", text) if when else text
        return tuple(replace(part, weather=when) for part in self._by_category(plainer))

    def _by_thing(self, text: str) -> HazardKind | None:
        """Return the hazard that needs a thing whose several words all occur in the text, in any order."""
        words = set(stems(text))
        for name in self._compounds:
            if words >= name:
                for hazard in self._compounds[name]:
                    if words - _NEUTRAL <= self._vocabulary(hazard).every:
                        return hazard
        return None

    def _hazard(self, text: str) -> HazardKind | None:
        """Return the hazard that a text resembles most, if it concerns the same thing."""
        known = self._known(text)
        if known is not None:
            return known
        found = self._recognise(text)
        if found is None:
            return None
        words = _subject_stems(text)
        if not words or self._affirmed(text) != text:
            return found if self._affirmed(text) == text or _is_about_absence(found) else None
        vocabulary = self._vocabulary(found)
        if words[-1] in vocabulary.every or set(words) & vocabulary.naming:
            return found
        named = self._named_at_end(words)
        if named is None or named.thing or named.category not in self._categories(found):
            return None
        return found

    def _with_things(self, text: str, hazard: HazardKind) -> RequiredThing:
        """Add the other things that a text names, and the words that the hazard only approximates."""
        every = self._vocabulary(hazard).every
        needed: dict[str, None] = {}
        near: dict[str, None] = {}
        for words, named, after in self._other_names(text, hazard):
            raw = _phrase(text, words, after)
            if not (raw and after in every and after not in _NEUTRAL):
                needed[named.thing] = None
            elif named.category == "animal":
                near[raw] = None
        return RequiredThing(hazard, things=tuple(needed), approximate=tuple(near))

    def _by_category(self, text: str) -> tuple[RequiredThing, ...]:
        """Return the hazards with the thing at the end of a text, or of its category."""
        words = _subject_stems(text)
        named = self._named_at_end(words)
        if named is None:
            return (RequiredThing(why=f"the author has no knowledge of {text!r}"),)
        in_names = {word for name in self._names for word in name if word in words}
        rest = set(stems(text)) - _NEUTRAL - in_names
        if named.thing:
            return (self._with_thing(text, named, rest),)
        is_told = named.category in _PRESENT and not rest
        members = self._mere_members(named.category) if is_told else []
        if members:
            return tuple(map(RequiredThing, members[:_MOST]))
        why = f"the author knows no scenario for {text!r}"
        return (RequiredThing(category=named.category, why=why),)

    def _with_thing(self, text: str, named: _Named, rest: set[str]) -> RequiredThing:
        """Return the first hazard with a thing that covers the rest of a text's words."""
        thing, category = named.thing, named.category
        users = [hazard for hazard in self.knowledge.hazards if thing in hazard.needs.assets]
        users.sort(key=lambda hazard: (hazard.needs.assets.index(thing), hazard.stage is None))
        for hazard in users if rest or category in _PRESENT else ():
            if rest <= self._vocabulary(hazard).every:
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
            and self._categories(hazard) == {category}
        ]

    def _other_names(
        self, text: str, hazard: HazardKind
    ) -> Iterator[tuple[tuple[str, ...], _Named, str]]:
        """Yield the names of things in a text that a hazard is not about, each with its words and the word after it."""
        tokens, every = stems(text), self._vocabulary(hazard).every
        taken: set[int] = set()
        for words, named in self._names.items():
            if not named.thing or named.thing in hazard.needs.assets or set(words) <= every:
                continue
            size = len(words)
            for start in range(len(tokens) - size + 1):
                if tuple(tokens[start : start + size]) == words and start not in taken:
                    after = tokens[start + size] if start + size < len(tokens) else ""
                    yield words, named, after
                    taken.update(range(start, start + size))

    def _named_at_end(self, words: list[str]) -> _Named | None:
        """Return the meaning of the longest name at the end of some words."""
        for size in range(min(_LONGEST_NAME, len(words)), 0, -1):
            found = self._names.get(tuple(words[-size:]))
            if found is not None:
                return found
        return None

    def _weather(self, text: str) -> HazardKind | None:
        """Return the hazard that consists of weather alone, if the text names nothing else."""
        left = set(stems(text)) - _STRENGTHS - _NEUTRAL
        for kind, words in _WEATHER.items():
            if left and left <= set(map(stem, words)):
                return next(
                    (
                        hazard
                        for hazard in self.knowledge.hazards
                        if hazard.needs.weather == (kind,) and hazard.stage and hazard.stage.weather
                    ),
                    None,
                )
        return None

    def _affirmed(self, text: str) -> str:
        """Return a text without the things that it says are absent."""

        def without(found: re.Match[str]) -> str:
            words = stems(found.group(1))
            for size in range(len(words), 0, -1):
                if tuple(words[:size]) in self._names:
                    return " " if size == len(words) else f" {found.group(1).split()[-1]}"
            return found.group(0)

        return " ".join(_NEGATED.sub(without, text).split())

    def _categories(self, hazard: HazardKind) -> set[Category | None]:
        return {self.knowledge.category(name) for name in hazard.needs.assets}

    def _vocabulary(self, hazard: HazardKind) -> _Vocabulary:
        if hazard.id not in self._vocabularies:
            self._vocabularies[hazard.id] = _vocabulary_of(hazard)
        return self._vocabularies[hazard.id]

    def _has_all(self, hazard: HazardKind, words: str) -> bool:
        return set(stems(words)) <= self._vocabulary(hazard).every | _NEUTRAL


def _names(knowledge: Knowledge) -> dict[tuple[str, ...], _Named]:
    """Return the names of things and of their kinds, by their stems."""
    found: dict[tuple[str, ...], _Named] = {}
    for group in knowledge.things:
        for name in (*group.names, *group.others):
            words = re.sub(r"[_-]", " ", name)
            found.setdefault(tuple(stems(words)), _Named(group.category, _id(name)))
        for kind in group.kinds:
            found[tuple(stems(kind))] = _Named(group.category, "")
    found.pop((), None)
    return found


def _vocabulary_of(hazard: HazardKind) -> _Vocabulary:
    things = (name.replace("_", " ") for name in hazard.needs.assets)
    naming = (hazard.label, *hazard.words, *things)
    every = (*naming, hazard.wider, *hazard.events, *hazard.details)
    return _Vocabulary(frozenset(stems(" ".join(naming))), frozenset(stems(" ".join(every))))


def _subject_stems(text: str) -> list[str]:
    """Return the stems of a text's subject, without heads that name nothing."""
    words = stems(" ".join(subject(text)))
    while words and words[-1] in _EMPTY_HEADS:
        words.pop()
    return words


def _unequal(parts: Iterable[RequiredThing]) -> tuple[RequiredThing, ...]:
    """Remove duplicate parts."""
    found: list[RequiredThing] = []
    for part in parts:
        if part not in found:
            found.append(part)
    return tuple(found)


def _kind_of_weather(word: str) -> str:
    """Return the name of a weather need: `night` for `darkness`."""
    found = (kind for kind, words in _WEATHER.items() if word.casefold() in words)
    return next(found, "night")


def _is_about_absence(hazard: HazardKind) -> bool:
    return bool(_NEGATION.search(" ".join((hazard.label, hazard.wider, *hazard.words))))


def _phrase(text: str, words: Iterable[str], after: str) -> str:
    """Return the words of a text for a thing and the noun that it modifies: `dog costume`."""
    tokens = re.findall(r"[A-Za-z]+", text)
    wanted = [*words, after]
    for start in range(len(tokens) - len(wanted) + 1):
        found = tokens[start : start + len(wanted)]
        if [stem(token.casefold()) for token in found] == wanted:
            return " ".join(found).casefold()
    return ""


def _id(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.casefold())
