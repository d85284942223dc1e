"""Recognition of the hazard of a text or a label, from its words alone."""

import re
from dataclasses import dataclass
from functools import lru_cache

from oodscen._words.text import folded_words, stem
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.hazard_index import HazardIndex
from oodscen.author._reading.label_reading import LabelReader
from oodscen.author._reading.readings import Alternative, LabelReading, RequiredThing
from oodscen.author._reading.setting_recognition import SettingRecogniser
from oodscen.author._reading.stemming import stems

_DRIVING = frozenset(
    map(
        stem,
        """ego vehicle car road street lane traffic driver driving drive highway junction intersection
        truck lorry bus pedestrian cyclist motorcycle motorway carriageway""".split(),
    )
)
_ACCEPTED_SHARE = 0.5
"""Share of a phrase's weight that a text must contain to match it."""
_ACCEPTED_DISTINCTIVE = 4.0
"""Information of a hazard's distinctive words that is enough instead, in nats."""
_ACCEPTED_WEIGHT = 7.0
"""Weight that a text must share with a phrase, or with a hazard's words, to match it, in nats."""
_LABEL_WEIGHT = 4.0
"""The same for a label, which has fewer words and certainly names a hazard."""
_CERTAIN_SHARE = 0.8
"""Share of a phrase's weight from which a text matches it whatever its weight."""
_CANDIDATE_SHARE = 0.2
"""Share of the best hazard's weight that another candidate needs."""
_NUMBER = re.compile(r"\s*\(\d+\)$")
"""Suffix that distinguishes equal labels."""


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
        self._index = HazardIndex(knowledge.hazards)
        self._labels = {
            _key(label): (hazard, label == hazard.wider)
            for hazard in knowledge.hazards
            for label in (hazard.wider, hazard.label)
            if label
        }
        """The hazard of each label that the author wrote, and whether it is the wider one."""
        self._families = {_key(label): label for label in knowledge.families}
        settings = SettingRecogniser(knowledge)
        self.place = settings.place
        self.conditions = settings.conditions
        self.traffic = settings.traffic
        self._reader = LabelReader(knowledge, self._resembling, self._of_label)
        self.recognise = lru_cache(maxsize=8192)(self._recognise)
        self.label = lru_cache(maxsize=8192)(self._label)

    def _recognise(self, text: str, least_weight: float = _ACCEPTED_WEIGHT) -> Recognition:
        weights, shares, distinctive = self._index.evidence(text)
        is_driving = "ego" in text.casefold() or not _DRIVING.isdisjoint(stems(text))
        if not weights:
            return Recognition(None, 0.0, 0.0, is_driving)
        best = max(weights, key=lambda index: (weights[index], -index))
        weight, share = weights[best], shares.get(best, 0.0)
        is_specific = (
            share >= _ACCEPTED_SHARE or distinctive.get(best, 0.0) >= _ACCEPTED_DISTINCTIVE
        )
        is_enough = weight >= least_weight or share >= _CERTAIN_SHARE
        hazard = self.knowledge.hazards[best] if is_specific and is_enough else None
        return Recognition(hazard, weight, share, is_driving)

    def candidates(self, text: str) -> tuple[tuple[HazardKind, float], ...]:
        """Return the hazards that a text may be about, best first, with their weights in nats.

        A text that is too far from all of them has none.
        """
        weights = self._index.evidence(text).weights
        best = max(weights.values(), default=0.0)
        least = max(_CANDIDATE_SHARE * best, 0.5 * _LABEL_WEIGHT)
        indices = [index for index, weight in weights.items() if weight >= least]
        indices.sort(key=lambda index: (-weights[index], index))
        return tuple((self.knowledge.hazards[index], weights[index]) for index in indices)

    def _label(self, label: str) -> tuple[HazardKind | None, bool]:
        """Return the hazard of a label, and whether it is the hazard's wider label."""
        exact = self._labels.get(_key(label))
        if exact is not None:
            return exact
        return next(iter(self.reading(label).hazards), None), False

    def reading(self, label: str) -> LabelReading:
        """Return the alternatives that a label of any author names.

        A family's label names nothing itself; its leaves do.
        """
        if _key(label) in self._families:
            return LabelReading(())
        parts = label.split(", or ")
        if len(parts) > 1 and all(_key(part) in self._labels for part in parts):
            hazards = [self._labels[_key(part)][0] for part in parts]
            return LabelReading(
                tuple(Alternative(hazard.label, (RequiredThing(hazard),)) for hazard in hazards)
            )
        return self._reader.read(_NUMBER.sub("", label))

    def _resembling(self, text: str) -> HazardKind | None:
        """Return the hazard that a label resembles most."""
        return self._recognise(text, _LABEL_WEIGHT).hazard

    def _of_label(self, text: str) -> HazardKind | None:
        """Return the hazard of a label that the author wrote."""
        return self._labels.get(_key(text), (None, False))[0]

    def covered_by(self, label: str) -> tuple[HazardKind, ...]:
        """Return the hazards of a leaf's label: one, with its kin if widened, or several."""
        return self.written(label) or self.reading(label).hazards

    def written(self, label: str) -> tuple[HazardKind, ...]:
        """Return the hazards of a label that the author wrote; empty for any other label."""
        entry = self._labels.get(_key(label))
        if entry is None:
            return ()
        hazard, is_wider = entry
        return (hazard, *self.knowledge.kin(hazard)) if is_wider else (hazard,)

    def family(self, label: str) -> str | None:
        """Return the family that a label names."""
        return self._families.get(_key(label))


def _key(label: str) -> str:
    """Return what equal labels share: their words, without the number that distinguishes them."""
    return folded_words(_NUMBER.sub("", label))
