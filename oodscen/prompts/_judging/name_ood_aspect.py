"""The first task as the paper asks it: name the out-of-distribution aspect."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.errors import Issue
from oodscen.prompts._judging.drive_facts import DriveQuestion


class NamedAspect(Brief, BaseModel):
    """Answer: the OOD aspect."""

    reasoning: str = Field(default="", description="step by step, short")
    aspect: str = Field(description="the OOD aspect, as a short noun phrase")


class NameOodAspect(DriveQuestion[NamedAspect]):
    """Name the OOD aspect of a drive that has one (paper, section V-C, first task).

    The question asks for neither a likelihood nor a confidence: the paper shows no ordinary drives.
    """

    purpose: ClassVar[str] = "name-ood-aspect"
    template: ClassVar[str] = "name_ood_aspect.md"
    answer: ClassVar[type[BaseModel]] = NamedAspect

    def check(self, answer: NamedAspect) -> list[Issue]:
        """Return a fault if the aspect repeats the dots of the question."""
        if answer.aspect and not any(char.isalnum() for char in answer.aspect):
            return [Issue("aspect", "name it")]
        return []
