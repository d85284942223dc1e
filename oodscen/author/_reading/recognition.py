"""Recognition of the hazard, place, weather and traffic of a text, from its words alone."""

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TypeVar

from oodscen._text import folded_words, stem
from oodscen.author._knowledge.base import (
    BackgroundTraffic,
    Conditions,
    HazardKind,
    Knowledge,
    RoadKind,
)
from oodscen.author._reading.label_reading import LabelReader
from oodscen.author._reading.readings import Alternative, LabelReading, RequiredThing
from oodscen.author._reading.stemming import stems

Value = TypeVar("Value")

_DRIVING = frozenset(
    map(
        stem,
        """ego vehicle car road street lane traffic driver driving drive highway junction intersection
        truck lorry bus pedestrian cyclist motorcycle motorway carriageway""".split(),
    )
)
_ACCEPTED_SHARE = 0.5
"""Share of a phrase's weight that a text must contain to match it."""
_ACCEPTED_WEIGHT = 7.0
"""Weight that a text must share with a phrase, or with a hazard's words, to match it."""
_LABEL_WEIGHT = 4.0
"""The same for a label, which has fewer words and certainly names a hazard."""
_NUMBER = re.compile(r"\s*\(\d+\)$")
"""Suffix that distinguishes equal labels."""


def _features(tokens: Sequence[str]) -> list[str]:
    return [*tokens, *(f"{a} {b}" for a, b in pairwise(tokens))]


@dataclass(frozen=True)
class Recognition:
    """The recognised hazard of a text, with the strength of the evidence."""

    hazard: HazardKind | None
    weight: float
    """Information that text and hazard share, in nats."""
    share: float
    """Share of the best phrase that the text contains."""
    is_driving: bool
    """True if the text is about driving at all."""


class Recogniser:
    """Recognises hazards, places, weather and traffic in texts, with an index built once."""

    def __init__(self, knowledge: Knowledge) -> None:
        self.knowledge = knowledge
        phrases = [
            (h, parts) for h, hazard in enumerate(knowledge.hazards) for parts in _phrases(hazard)
        ]
        owners: dict[str, set[int]] = {}
        for owner, features in phrases:
            for feature in features:
                owners.setdefault(feature, set()).add(owner)
        total = len(knowledge.hazards)
        self._idf = {f: math.log(1.0 + total / len(o)) for f, o in owners.items()}
        self._owner: list[int] = []
        self._weight: list[float] = []
        self._postings: dict[str, list[tuple[int, float]]] = {}
        for owner, features in phrases:
            number = len(self._owner)
            weights = {feature: self._value(feature) for feature in set(features)}
            self._owner.append(owner)
            self._weight.append(sum(weights.values()))
            for feature, weight in weights.items():
                if weight > 0.0:
                    self._postings.setdefault(feature, []).append((number, weight))
        self._words: dict[str, list[tuple[int, float]]] = {}
        for owner, hazard in enumerate(knowledge.hazards):
            for word in hazard.words:
                tokens = stems(word)
                value = sum(self._idf.get(token, 2.0) for token in tokens)
                self._words.setdefault(" ".join(tokens), []).append((owner, value))
        self._labels = {
            folded_words(label): (hazard, label == hazard.wider)
            for hazard in knowledge.hazards
            for label in (hazard.wider, hazard.label)
            if label
        }
        self._families = {folded_words(label): label for label in knowledge.families}
        contexts = _Contexts(knowledge)
        self.place = contexts.place
        self.conditions = contexts.conditions
        self.traffic = contexts.traffic
        self._reader = LabelReader(knowledge, self._resembles, self._written)
        self.recognise = lru_cache(maxsize=8192)(self._recognise)
        self.label = lru_cache(maxsize=8192)(self._label)

    def _value(self, feature: str) -> float:
        value = self._idf[feature]
        if value < 1.3:
            return 0.0
        return 0.6 * value if " " in feature else value

    def _scores(self, text: str) -> tuple[dict[int, float], dict[int, float], dict[int, float]]:
        """Return the weight, the share of the best phrase, and the value of the distinctive words, by hazard."""
        tokens = stems(text)
        shared: dict[int, float] = {}
        for feature in dict.fromkeys(_features(tokens)):
            for number, weight in self._postings.get(feature, ()):
                shared[number] = shared.get(number, 0.0) + weight
        scores: dict[int, float] = {}
        shares: dict[int, float] = {}
        for number, weight in shared.items():
            owner, share = self._owner[number], weight / self._weight[number]
            if weight * share > scores.get(owner, 0.0):
                scores[owner], shares[owner] = weight * share, share
        named: dict[int, float] = {}
        for gram in sorted(_grams(tokens, 3)):
            for owner, value in self._words.get(gram, ()):
                named[owner] = named.get(owner, 0.0) + value
        for owner, value in named.items():
            scores[owner] = scores.get(owner, 0.0) + 0.5 * value
        return scores, shares, named

    def _recognise(self, text: str, least: float = _ACCEPTED_WEIGHT) -> Recognition:
        scores, shares, named = self._scores(text)
        is_driving = "ego" in text.casefold() or not _DRIVING.isdisjoint(stems(text))
        if not scores:
            return Recognition(None, 0.0, 0.0, is_driving)
        best = max(scores, key=lambda owner: (scores[owner], -owner))
        share = shares.get(best, 0.0)
        weight = scores[best]
        sure = share >= _ACCEPTED_SHARE or named.get(best, 0.0) >= 4.0
        accepted = sure and (weight >= least or share >= 0.8)
        hazard = self.knowledge.hazards[best] if accepted else None
        return Recognition(hazard, weight, share, is_driving)

    def candidates(self, text: str, share: float = 0.2) -> tuple[tuple[HazardKind, float], ...]:
        """Return the hazards that a text may be about, best first, with their weights in nats.

        A hazard needs at least a `share` of the best one's weight; a text that is too far from all of them has none.
        """
        scores = self._scores(text)[0]
        best = max(scores.values(), default=0.0)
        least = max(share * best, 0.5 * _LABEL_WEIGHT)
        found = [owner for owner, score in scores.items() if score >= least]
        found.sort(key=lambda owner: (-scores[owner], owner))
        return tuple((self.knowledge.hazards[owner], scores[owner]) for owner in found)

    def _label(self, label: str) -> tuple[HazardKind | None, bool]:
        exact = self._labels.get(folded_words(label))
        if exact is not None:
            return exact
        return next(iter(self.reading(label).hazards), None), False

    def reading(self, label: str) -> LabelReading:
        """Return the alternatives that a label of any author names.

        A family's label names nothing itself; its leaves do.
        """
        if folded_words(label) in self._families:
            return LabelReading(())
        parts = label.split(", or ")
        if len(parts) > 1 and all(folded_words(part) in self._labels for part in parts):
            hazards = (self._labels[folded_words(part)][0] for part in parts)
            return LabelReading(tuple(Alternative(h.label, (RequiredThing(h),)) for h in hazards))
        return self._reader.read(_NUMBER.sub("", label))

    def _resembles(self, text: str) -> HazardKind | None:
        return self._recognise(text, _LABEL_WEIGHT).hazard

    def _written(self, text: str) -> HazardKind | None:
        """Return the hazard of a label that the author wrote."""
        return self._labels.get(folded_words(text), (None, False))[0]

    def covered_by(self, label: str) -> tuple[HazardKind, ...]:
        """Return the hazards of a leaf's label: one, with its kin if widened, or several."""
        return self.written(label) or self.reading(label).hazards

    def written(self, label: str) -> tuple[HazardKind, ...]:
        """Return the hazards of a label that the author wrote; empty for any other label."""
        found = self._labels.get(folded_words(label))
        if found is None:
            return ()
        hazard, widened = found
        return (hazard, *self.knowledge.kin(hazard)) if widened else (hazard,)

    def family(self, label: str) -> str | None:
        """Return the family that a label names."""
        return self._families.get(folded_words(label))


def _phrases(hazard: HazardKind) -> Iterable[list[str]]:
    for event in (*hazard.events, *hazard.details):
        features: list[str] = []
        for part in event.split("{where}"):
            features += _features(stems(part))
        yield features
    for label in (hazard.label, hazard.wider):
        if label:
            yield _features(stems(label))


def _grams(tokens: Sequence[str], longest: int) -> set[str]:
    return {
        " ".join(tokens[start : start + size])
        for size in range(1, longest + 1)
        for start in range(len(tokens) - size + 1)
    }


class _Contexts:
    """Phrases for places, conditions and traffic, longest first."""

    def __init__(self, knowledge: Knowledge) -> None:
        self._knowledge = knowledge
        self._places = _by_length(
            (form, p) for p in knowledge.places for phrase in p.phrases for form in _forms(phrase)
        )
        self._conditions = _by_length(
            (phrase, c) for c in knowledge.conditions for phrase in (*c.phrases, *c.statements)
        )
        self._traffic = _by_length((phrase, t) for t in knowledge.traffic for phrase in t.phrases)

    def place(self, text: str, allowed: Sequence[str] = ()) -> RoadKind | None:
        """Return the kind of road that a text names; `allowed` keys are preferred."""
        words = f" {folded_words(text)} "
        for phrase, place in self._places:
            if phrase in words:
                return place
        best: tuple[float, RoadKind] | None = None
        for place in self._knowledge.places:
            hits = sum(f" {folded_words(word)} " in words for word in place.words)
            hits += sum(
                f" {folded_words(trait.replace('_', ' '))} " in words for trait in place.traits
            )
            score = hits + (0.5 if place.key in allowed else 0.0)
            if hits and (best is None or score > best[0]):
                best = score, place
        return best[1] if best else None

    def conditions(self, text: str, hazard: HazardKind | None = None) -> tuple[Conditions, ...]:
        """Return the weather and time of day that a text names, ignoring the hazard's own words."""
        words = f" {folded_words(text)} "
        for phrase, condition in self._conditions:
            if phrase in words:
                return (condition,)
        own: Counter[str] = Counter()
        if hazard is not None:
            for phrase in (*hazard.events, *hazard.details, hazard.label):
                own.update(set(folded_words(phrase).split()))
        return tuple(
            condition
            for condition in self._knowledge.conditions
            if any(f" {word} " in words and not own[word] for word in condition.words)
        )

    def traffic(self, text: str) -> BackgroundTraffic | None:
        """Return the ordinary traffic that a text names."""
        words = f" {folded_words(text)} "
        return next((traffic for phrase, traffic in self._traffic if phrase in words), None)


def _forms(phrase: str) -> tuple[str, ...]:
    """Return a phrase for a place, and the place alone as in a heading."""
    return (phrase, re.sub(r"^(?:on|along|in|over|across) an? ", "", phrase))


def _by_length(pairs: Iterable[tuple[str, Value]]) -> list[tuple[str, Value]]:
    padded = [(f" {folded_words(phrase)} ", value) for phrase, value in pairs]
    return sorted(padded, key=lambda pair: -len(pair[0]))
