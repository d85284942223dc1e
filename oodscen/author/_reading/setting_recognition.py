"""Recognition of the place, weather and traffic of a text, by the phrases and words of the knowledge base."""

import re
from collections.abc import Iterable, Sequence
from typing import TypeVar

from oodscen._words.text import folded_words
from oodscen.author._knowledge.base import (
    BackgroundTraffic,
    Conditions,
    HazardKind,
    Knowledge,
    RoadKind,
)

_Entry = TypeVar("_Entry")

_PREFERENCE = 0.5
"""Worth of a preferred place, in words of the text."""


class SettingRecogniser:
    """Recognises settings in texts, the longest phrase first."""

    def __init__(self, knowledge: Knowledge) -> None:
        self._knowledge = knowledge
        self._places = _by_length(
            (form, place)
            for place in knowledge.places
            for phrase in place.phrases
            for form in _forms(phrase)
        )
        self._conditions = _by_length(
            (phrase, condition)
            for condition in knowledge.conditions
            for phrase in (*condition.phrases, *condition.statements)
        )
        self._traffic = _by_length(
            (phrase, traffic) for traffic in knowledge.traffic for phrase in traffic.phrases
        )

    def place(self, text: str, preferred: Sequence[str] = ()) -> RoadKind | None:
        """Return the kind of road that a text names; places with `preferred` keys win among several."""
        words = f" {folded_words(text)} "
        for phrase, place in self._places:
            if phrase in words:
                return place
        best: RoadKind | None = None
        best_score = 0.0
        for place in self._knowledge.places:
            names = (*place.words, *(trait.replace("_", " ") for trait in place.traits))
            hits = sum(f" {folded_words(name)} " in words for name in names)
            score = hits + (_PREFERENCE if place.key in preferred else 0.0)
            if hits and score > best_score:
                best, best_score = place, score
        return best

    def conditions(self, text: str, hazard: HazardKind | None = None) -> tuple[Conditions, ...]:
        """Return the weather and time of day that a text names, ignoring the words of its hazard."""
        words = f" {folded_words(text)} "
        for phrase, condition in self._conditions:
            if phrase in words:
                return (condition,)
        ignored: set[str] = set()
        if hazard is not None:
            for phrase in (*hazard.events, *hazard.details, hazard.label):
                ignored.update(folded_words(phrase).split())
        return tuple(
            condition
            for condition in self._knowledge.conditions
            if any(f" {word} " in words and word not in ignored for word in condition.words)
        )

    def traffic(self, text: str) -> BackgroundTraffic | None:
        """Return the ordinary traffic that a text names."""
        words = f" {folded_words(text)} "
        return next((traffic for phrase, traffic in self._traffic if phrase in words), None)


def _forms(phrase: str) -> tuple[str, ...]:
    """Return a phrase for a place, and the place alone as in a heading."""
    return (phrase, re.sub(r"^(?:on|along|in|over|across) an? ", "", phrase))


def _by_length(pairs: Iterable[tuple[str, _Entry]]) -> list[tuple[str, _Entry]]:
    padded = [(f" {folded_words(phrase)} ", entry) for phrase, entry in pairs]
    return sorted(padded, key=lambda pair: -len(pair[0]))
