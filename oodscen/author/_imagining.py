"""Imagination of the built-in author: draws hazards and responds to labels that a question names."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

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
    softness: float = 5.0
    listens: float = 5.0 / 6.0
    follows: float = 1.0 / 3.0
    favours: float = 0.5


class Imagination:
    """Draws the hazard of an imagined scenario for a question."""

    def __init__(
        self, seed: int, knowledge: Knowledge, recogniser: Recogniser, habits: Habits | None = None
    ) -> None:
        self.knowledge = knowledge
        self.recogniser = recogniser
        self.habits = habits or Habits()
        self._order = stream(seed, "repertoire").permutation(len(knowledge.hazards))
        self._first = [h for h in knowledge.hazards if h.first]
        self._known = lru_cache(maxsize=8)(self._named)

    def hazard(self, prompt: ImagineScenario, rng: np.random.Generator) -> HazardKind:
        """Draw a hazard; covered, thin and refused labels count only if the question names them."""
        ranks = self._order
        listens, follows, place = rng.random(), rng.random(), rng.random()
        if self._first and rng.random() < self.habits.favours:
            known = self._known(prompt.covered, prompt.refused)
            own = [hazard for hazard in self._first if hazard.id not in known]
            if own:
                return own[int(place * len(own))]
        is_told = bool(prompt.covered or prompt.refused)
        if is_told and listens < self.habits.listens:
            known = self._known(prompt.covered, prompt.refused)
            left = [n for n in ranks if self.knowledge.hazards[n].id not in known]
            if prompt.thin and follows < self.habits.follows:
                families = {self.recogniser.family(label) for label in prompt.thin}
                thin = [n for n in left if self.knowledge.hazards[n].family in families]
                left = thin or left
            ranks = np.array(left, dtype=np.int64) if left else ranks
        return self.knowledge.hazards[int(self._drawn(ranks, place))]

    def _drawn(self, hazards: np.ndarray, place: float) -> int:
        rank = np.empty(len(self._order), np.int64)
        rank[self._order] = np.arange(len(self._order))
        steps = (rank[hazards] - self.habits.repertoire) / self.habits.softness
        # The best remaining rank sets the scale, so that the next one is drawn even far from the
        # repertoire.
        weights = -np.logaddexp(0.0, steps)
        total = np.cumsum(np.exp(weights - weights.max()))
        return int(hazards[int(np.searchsorted(total, place * total[-1], side="right"))])

    def _named(self, covered: tuple[str, ...], refused: tuple[str, ...]) -> Collection[str]:
        labels = {h.id for label in covered for h in self.recogniser.covered_by(label)}
        texts = (self.recogniser.recognise(text).hazard for text in refused)
        return labels | {hazard.id for hazard in texts if hazard is not None}
