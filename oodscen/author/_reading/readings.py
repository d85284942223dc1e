"""The meaning of a label: alternatives, and the things that each of them needs."""

from dataclasses import dataclass

from oodscen.author._knowledge.base import HazardKind
from oodscen.author._reading.alternatives import Split
from oodscen.data._category import Category


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
        kinds = (hazard for alternative in self.alternatives for hazard in alternative.hazards)
        return tuple({hazard.id: hazard for hazard in kinds}.values())
