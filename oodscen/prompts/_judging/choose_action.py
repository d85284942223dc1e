"""The second task: choose the ego vehicle's action."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.data._base import Data
from oodscen.errors import Issue
from oodscen.prompts._judging.drive_facts import DriveQuestion


class ActionOption(Data):
    """One of the discrete actions."""

    id: str
    description: str


class ChosenAction(Brief, BaseModel):
    """Answer: one of the options."""

    reasoning: str = Field(default="", description="step by step, short")
    action: str = Field(description="id of one option")


class ChooseAction(DriveQuestion[ChosenAction]):
    """Choose a safe control action (paper, section V-C, second task)."""

    purpose: ClassVar[str] = "choose-action"
    template: ClassVar[str] = "choose_action.md"
    answer: ClassVar[type[BaseModel]] = ChosenAction

    options: tuple[ActionOption, ...]
    is_collision_only: bool = False
    """True if only collisions count, as in the paper, and leaving the road does not."""

    def check(self, answer: ChosenAction) -> list[Issue]:
        """Return a fault if the action is not one of the options."""
        ids = [option.id for option in self.options]
        if answer.action not in ids:
            return [Issue("action", f"{answer.action[:80]!r} is none of {', '.join(ids)}")]
        return []
