"""The designing prompt: describe a movement that no catalogue has, as data."""

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field

from oodscen._display import Brief
from oodscen.data._category import Category
from oodscen.data._designs import motion as motions
from oodscen.data._designs.motion import Motion
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt


class DesignedMotion(Brief, BaseModel):
    """Answer: the design of a movement, or the reason why there is none."""

    model_config = ConfigDict(extra="forbid")

    reasoning: str = Field(
        default="", description="what makes the movement recognisable, in a sentence"
    )
    motion: Motion | None = Field(description="the design, or null")
    cannot_make: str = Field(
        default="", max_length=400, description="why it cannot be made; else left out"
    )


class DesignMotion(Prompt[DesignedMotion]):
    """Make a movement that a catalogue lacks."""

    purpose: ClassVar[str] = "design-motion"
    template: ClassVar[str] = "design_motion.md"
    answer: ClassVar[type[BaseModel]] = DesignedMotion

    name: str
    """Name of the movement, which becomes its id."""
    path: tuple[str, ...] = ()
    """Labels from the root down to a leaf that needs it."""
    categories: tuple[Category, ...] = ()
    """Categories of the things of which some move so; empty if that is not known."""

    def variables(self) -> dict[str, Any]:
        """Return the fields, with what the bodies can do."""
        return {
            **super().variables(),
            "abilities": motions.ABILITIES,
            "most_keys": motions.MOST_KEYS,
            "longest_s": motions.LONGEST_S,
            "farthest_m": motions.FARTHEST_M,
        }

    def check(self, answer: DesignedMotion) -> list[Issue]:
        """Return faults: no design and no reason, another name, or a body of no category that is there."""
        if answer.motion is None:
            if answer.cannot_make:
                return []
            return [Issue("motion", "give the design, or say in `cannot_make` why there is none")]
        issues = []
        if answer.motion.id != self.name:
            issues.append(Issue("motion.id", f"must be {self.name!r}"))
        able = motions.ABILITIES[answer.motion.body].categories
        if self.categories and not set(able) & set(self.categories):
            categories = ", ".join(self.categories)
            issues.append(Issue("motion.body", f"what moves so is of category {categories}"))
        return issues
