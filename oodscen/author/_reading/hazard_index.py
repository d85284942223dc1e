"""Index of the words about hazards, and the evidence that a text gives for each hazard."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from oodscen.author._knowledge.base import HazardKind
from oodscen.author._reading.stemming import stems

_COMMON_NATS = 1.3
"""Information below which a word or pair of words is too common to count, in nats."""
_PAIR_FACTOR = 0.6
"""Factor on the information of a pair of words, whose words count as well."""
_UNKNOWN_NATS = 2.0
"""Information of a distinctive word's part that no phrase has, in nats."""
_DISTINCTIVE_FACTOR = 0.5
"""Factor on the information of distinctive words in the weight of a hazard."""
_LONGEST_DISTINCTIVE = 3
"""Number of words of the longest distinctive expression."""


class Evidence(NamedTuple):
    """Evidence that a text gives for each hazard, by the hazard's index; hazards that it does not touch are left out."""

    weights: dict[int, float]
    """Information that text and hazard share, in nats."""
    shares: dict[int, float]
    """Share of the hazard's best phrase that the text contains."""
    distinctive: dict[int, float]
    """Information of the hazard's distinctive words in the text, in nats."""


class HazardIndex:
    """Phrases and distinctive words of hazards.

    Args:
        hazards: The hazards, which are named by their indices.
    """

    def __init__(self, hazards: Sequence[HazardKind]) -> None:
        phrases = [
            (index, dict.fromkeys(features))
            for index, hazard in enumerate(hazards)
            for features in _phrases(hazard)
        ]
        owners: dict[str, set[int]] = {}
        for owner, features in phrases:
            for feature in features:
                owners.setdefault(feature, set()).add(owner)
        self._information = {
            feature: math.log(1.0 + len(hazards) / len(having))
            for feature, having in owners.items()
        }
        self._phrase_owners = [owner for owner, _ in phrases]
        self._phrase_weights: list[float] = []
        self._postings: dict[str, list[tuple[int, float]]] = {}
        """Phrases with a feature, and its weight in them."""
        for phrase, (_, features) in enumerate(phrases):
            weights = {feature: self._weight(feature) for feature in features}
            self._phrase_weights.append(sum(weights.values()))
            for feature, weight in weights.items():
                if weight > 0.0:
                    self._postings.setdefault(feature, []).append((phrase, weight))
        self._distinctive: dict[str, list[tuple[int, float]]] = {}
        """Hazards with a distinctive expression, and its information."""
        for index, hazard in enumerate(hazards):
            for word in hazard.words:
                tokens = stems(word)
                value = sum(self._information.get(token, _UNKNOWN_NATS) for token in tokens)
                self._distinctive.setdefault(" ".join(tokens), []).append((index, value))

    def evidence(self, text: str) -> Evidence:
        """Return what a text says for the hazards."""
        tokens = stems(text)
        shared: dict[int, float] = {}
        for feature in dict.fromkeys(_features(tokens)):
            for phrase, weight in self._postings.get(feature, ()):
                shared[phrase] = shared.get(phrase, 0.0) + weight
        weights: dict[int, float] = {}
        shares: dict[int, float] = {}
        for phrase, weight in shared.items():
            owner = self._phrase_owners[phrase]
            share = weight / self._phrase_weights[phrase]
            if weight * share > weights.get(owner, 0.0):
                weights[owner], shares[owner] = weight * share, share
        distinctive: dict[int, float] = {}
        for expression in sorted(_expressions(tokens)):
            for owner, value in self._distinctive.get(expression, ()):
                distinctive[owner] = distinctive.get(owner, 0.0) + value
        for owner, value in distinctive.items():
            weights[owner] = weights.get(owner, 0.0) + _DISTINCTIVE_FACTOR * value
        return Evidence(weights, shares, distinctive)

    def _weight(self, feature: str) -> float:
        information = self._information[feature]
        if information < _COMMON_NATS:
            return 0.0
        return _PAIR_FACTOR * information if " " in feature else information


def _phrases(hazard: HazardKind) -> Iterator[list[str]]:
    """Yield the features of the events, details and labels of a hazard."""
    for event in (*hazard.events, *hazard.details):
        features: list[str] = []
        for part in event.split("{where}"):
            features += _features(stems(part))
        yield features
    for label in (hazard.label, hazard.wider):
        if label:
            yield _features(stems(label))


def _features(tokens: Sequence[str]) -> list[str]:
    """Return stems and pairs of neighbouring stems."""
    return [*tokens, *(f"{first} {second}" for first, second in pairwise(tokens))]


def _expressions(tokens: Sequence[str]) -> set[str]:
    """Return all runs of stems that may be a distinctive expression."""
    return {
        " ".join(tokens[start : start + size])
        for size in range(1, _LONGEST_DISTINCTIVE + 1)
        for start in range(len(tokens) - size + 1)
    }
