"""Imagination of the built-in author: draws hazards and responds to labels that a question names."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from oodscen._seeding import stream
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.prompts._tree.imagine_scenario import ImagineScenario


@dataclass(frozen=True)
class Habits:
    """Drawing habits of a model that is asked the same question repeatedly.

    A language model does not sample uniformly from what it knows: asked the same question, it
    returns to a repertoire. Hazards have a seeded order of preference, and the hazard of rank r is
    drawn with weight 1 / (1 + exp((r - repertoire) / softness)).

    `repertoire` is set so that a hundred rounds of the open loop add about as many nodes to a tree
    of 40 as two models did: the paper's (37) and a frontier model that followed the paper by hand
    (39). In five rounds out of six, hazards that the question names as covered are excluded and the
    next in the order are drawn; in the sixth, the list is ignored. If the question names thin
    groups, a third of the rounds that heed it draw from those groups.

    Half of the rounds draw from hazards marked as first, until the question names them as covered
    or refused.
    """

    repertoire: float = 46.0
    """Number of hazards that are drawn often."""
    softness: float = 5.0
    """Range of ranks over which the weight falls."""
    listens: float = 5.0 / 6.0
    """Share of the rounds that heed covered and refused labels."""
    follows: float = 1.0 / 3.0
    """Share of those that draw from thin groups."""
    favours: float = 0.5
    """Share of the rounds that draw from hazards marked as first."""


class Imagination:
    """Draws the hazard of an imagined scenario for a question."""

    def __init__(
        self, seed: int, knowledge: Knowledge, recogniser: Recogniser, habits: Habits | None = None
    ) -> None:
        self.knowledge = knowledge
        self.recogniser = recogniser
        self.habits = habits or Habits()
        self._order = stream(seed, "repertoire").permutation(len(knowledge.hazards))
        self._ranks = np.argsort(self._order)
        self._first = [hazard for hazard in knowledge.hazards if hazard.first]
        self._named = lru_cache(maxsize=8)(self._hazards_named)

    def hazard(self, prompt: ImagineScenario, rng: np.random.Generator) -> HazardKind:
        """Draw a hazard; covered, thin and refused labels count only if the question names them."""
        hazards, candidates = self.knowledge.hazards, self._order
        listening, following, quantile = rng.random(), rng.random(), rng.random()
        named = self._named(prompt.covered, prompt.refused)
        if self._first and rng.random() < self.habits.favours:
            first = [hazard for hazard in self._first if hazard.id not in named]
            if first:
                return first[int(quantile * len(first))]
        if listening < self.habits.listens:
            new = [index for index in candidates if hazards[index].id not in named]
            if prompt.thin and following < self.habits.follows:
                families = {self.recogniser.family(label) for label in prompt.thin}
                thin = [index for index in new if hazards[index].family in families]
                new = thin or new
            if new:
                candidates = np.array(new)
        return hazards[self._draw(candidates, quantile)]

    def _draw(self, candidates: NDArray[np.int64], quantile: float) -> int:
        """Return the candidate at a quantile of the weights by rank."""
        steps = (self._ranks[candidates] - self.habits.repertoire) / self.habits.softness
        # The best remaining rank sets the scale, so that the next one is drawn even far from the
        # repertoire.
        weights = -np.logaddexp(0.0, steps)
        total = np.cumsum(np.exp(weights - weights.max()))
        return int(candidates[np.searchsorted(total, quantile * total[-1], side="right")])

    def _hazards_named(self, covered: tuple[str, ...], refused: tuple[str, ...]) -> Collection[str]:
        """Return the ids of the hazards of covered labels and refused texts."""
        ids = {hazard.id for label in covered for hazard in self.recogniser.covered_by(label)}
        recognised = (self.recogniser.recognise(text).hazard for text in refused)
        return ids | {hazard.id for hazard in recognised if hazard is not None}
