"""The first task as a multiple-choice question: choose the kind of situation."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.errors import Issue
from oodscen.prompts._judging.drive_facts import DriveQuestion


class ChosenAspect(Brief, BaseModel):
    """Answer: the number of one option."""

    reasoning: str = Field(default="", description="step by step, short")
    choice: int = Field(ge=1, description="number of one option")


class ChooseAspect(DriveQuestion[ChosenAspect]):
    """Choose among kinds of situations and "nothing unusual" for a drive."""

    purpose: ClassVar[str] = "choose-aspect"
    template: ClassVar[str] = "choose_aspect.md"
    answer: ClassVar[type[BaseModel]] = ChosenAspect

    labels: tuple[str, ...]
    """Labels in the order in which they are shown. Shuffle them, so that position confers no advantage."""

    def check(self, answer: ChosenAspect) -> list[Issue]:
        """Return a fault if the number is not that of an option."""
        if answer.choice > len(self.labels):
            return [Issue("choice", f"there are {len(self.labels)} options")]
        return []
