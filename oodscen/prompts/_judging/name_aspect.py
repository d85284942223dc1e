"""The first task: name what is out of the ordinary."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.errors import Issue
from oodscen.prompts._judging.drive_facts import DriveQuestion


class OodAspect(Brief, BaseModel):
    """Answer: whether the situation is OOD, and in which respect."""

    reasoning: str = Field(default="", description="step by step, short")
    is_ood: bool = Field(description="whether anything is out of the ordinary")
    confidence: float | None = Field(
        default=None, ge=0, le=1, description="how sure you are of is_ood, from 0.5 to 1"
    )
    aspect: str = Field(
        default="", description="the thing and what is wrong with it, as a short noun phrase"
    )


class NameAspect(DriveQuestion[OodAspect]):
    """Name the OOD characteristic of a drive (paper, section V-C, first task)."""

    purpose: ClassVar[str] = "name-aspect"
    template: ClassVar[str] = "name_aspect.md"
    answer: ClassVar[type[BaseModel]] = OodAspect

    def check(self, answer: OodAspect) -> list[Issue]:
        """Return a fault if the aspect repeats the dots of the question."""
        if answer.is_ood and answer.aspect and not any(char.isalnum() for char in answer.aspect):
            return [Issue("aspect", "name it, or leave it empty")]
        return []
