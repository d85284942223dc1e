"""The words that the author knows: names of things, and vocabularies of hazards."""

import re
from collections.abc import Iterator
from typing import NamedTuple

from oodscen._words.text import stem
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.stemming import stems
from oodscen.data._category import Category

NEUTRAL = frozenset(
    map(
        stem,
        """road lane street carriageway highway motorway roadway pavement way ahead front middle
        cross crossing standing lying present appearing encountered wandering unexpected sudden
        large big small several group stray loose wild dangerous incident event situation scenario
        hazard accident encounter presence anywhere somewhere nearby""".split(),
    )
)
"""Stems of words that any label may have."""
_LONGEST_NAME = 4
"""Words of the longest name that is looked for at the end of a text."""
_NEGATED = re.compile(
    r"\b(?:no|not|without|neither|nor|never|free of|absence of|lack of|instead of)\s+"
    r"(?:(?:a|an|any|the|single)\s+)*(\w+(?:[-\s]\w+)?)",
    re.IGNORECASE,
)


class Vocabulary(NamedTuple):
    """The stems of the words about a hazard."""

    naming: frozenset[str]
    """Stems of its names and of the things that it needs."""
    every: frozenset[str]
    """All stems, also of its events and details."""


class Meaning(NamedTuple):
    """The meaning of a name."""

    category: Category
    thing: str
    """Empty if the name is that of a whole category."""


class OtherName(NamedTuple):
    """A thing in a text that a hazard is not about."""

    words: tuple[str, ...]
    """Stems of its name."""
    meaning: Meaning
    after: str
    """Stem of the word after it; empty at the end."""


class Lexicon:
    """Names and vocabularies of a knowledge base.

    Args:
        knowledge: The knowledge base.
    """

    def __init__(self, knowledge: Knowledge) -> None:
        self._knowledge = knowledge
        self._names = _names(knowledge)
        self._vocabularies: dict[str, Vocabulary] = {}
        self._compounds: dict[frozenset[str], list[HazardKind]] = {}
        """Hazards by the words of the first thing that they need, if it has several words."""
        for hazard in knowledge.hazards:
            words = frozenset(stems(" ".join(hazard.needs.assets[:1]).replace("_", " ")))
            if len(words) > 1:
                self._compounds.setdefault(words, []).append(hazard)

    def vocabulary(self, hazard: HazardKind) -> Vocabulary:
        """Return the stems of the words about a hazard."""
        if hazard.id not in self._vocabularies:
            self._vocabularies[hazard.id] = _vocabulary_of(hazard)
        return self._vocabularies[hazard.id]

    def covers(self, hazard: HazardKind, text: str) -> bool:
        """Return whether a hazard's vocabulary has all words of a text."""
        return set(stems(text)) <= self.vocabulary(hazard).every | NEUTRAL

    def categories(self, hazard: HazardKind) -> set[Category | None]:
        """Return the categories of the things that a hazard needs."""
        return {self._knowledge.category(name) for name in hazard.needs.assets}

    def things_named_by(self, words: set[str]) -> set[str]:
        """Return the things with any of some stems in their names."""
        return {meaning.thing for name, meaning in self._names.items() if words & set(name)}

    def naming_words(self, words: list[str]) -> set[str]:
        """Return those of some stems that occur in a name."""
        return {word for name in self._names for word in name if word in words}

    def named_at_end(self, words: list[str]) -> Meaning | None:
        """Return the meaning of the longest name at the end of some words."""
        for size in range(min(_LONGEST_NAME, len(words)), 0, -1):
            meaning = self._names.get(tuple(words[-size:]))
            if meaning is not None:
                return meaning
        return None

    def compound_hazard(self, text: str) -> HazardKind | None:
        """Return the hazard that needs a thing whose several words all occur in the text, in any order."""
        words = set(stems(text))
        for name in self._compounds:
            if words >= name:
                for hazard in self._compounds[name]:
                    if words - NEUTRAL <= self.vocabulary(hazard).every:
                        return hazard
        return None

    def other_names(self, text: str, hazard: HazardKind) -> Iterator[OtherName]:
        """Yield the names of things in a text that a hazard is not about."""
        tokens, every = stems(text), self.vocabulary(hazard).every
        taken: set[int] = set()
        for words, meaning in self._names.items():
            if not meaning.thing or meaning.thing in hazard.needs.assets or set(words) <= every:
                continue
            size = len(words)
            for start in range(len(tokens) - size + 1):
                if tuple(tokens[start : start + size]) == words and start not in taken:
                    after = tokens[start + size] if start + size < len(tokens) else ""
                    yield OtherName(words, meaning, after)
                    taken.update(range(start, start + size))

    def affirmed(self, text: str) -> str:
        """Return a text without the things that it says are absent."""

        def rest(match: re.Match[str]) -> str:
            """Return the words of a negation that are left without the thing."""
            words = stems(match[1])
            for size in range(len(words), 0, -1):
                if tuple(words[:size]) in self._names:
                    return " " if size == len(words) else f" {match[1].split()[-1]}"
            return match[0]

        return " ".join(_NEGATED.sub(rest, text).split())


def _names(knowledge: Knowledge) -> dict[tuple[str, ...], Meaning]:
    """Return the names of things and of their kinds, by their stems."""
    meanings: dict[tuple[str, ...], Meaning] = {}
    for group in knowledge.things:
        for name in (*group.names, *group.others):
            words = re.sub(r"[_-]", " ", name)
            meanings.setdefault(tuple(stems(words)), Meaning(group.category, _id(name)))
        for kind in group.kinds:
            meanings[tuple(stems(kind))] = Meaning(group.category, "")
    meanings.pop((), None)
    return meanings


def _vocabulary_of(hazard: HazardKind) -> Vocabulary:
    things = (name.replace("_", " ") for name in hazard.needs.assets)
    naming = (hazard.label, *hazard.words, *things)
    every = (*naming, hazard.wider, *hazard.events, *hazard.details)
    return Vocabulary(frozenset(stems(" ".join(naming))), frozenset(stems(" ".join(every))))


def _id(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.casefold())
