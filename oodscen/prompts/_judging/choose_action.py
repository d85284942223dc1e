"""The second task: choose the ego vehicle's action."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.data._base import Data
from oodscen.data._messages import Image, Message
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.describe_frame import DescribeFrame, frame_turns


class ActionOption(Data):
    """One of the discrete actions."""

    id: str
    description: str


class ChosenAction(Brief, BaseModel):
    """Answer: one of the options."""

    reasoning: str = Field(default="", description="step by step, short")
    action: str = Field(description="id of one option")


class ChooseAction(Prompt[ChosenAction]):
    """Choose a safe control action (paper, section V-C, second task)."""

    purpose: ClassVar[str] = "choose-action"
    template: ClassVar[str] = "choose_action.md"
    answer: ClassVar[type[BaseModel]] = ChosenAction
    follows = (DescribeFrame,)

    frames: tuple[Image, ...]
    descriptions: tuple[str, ...]
    """The model's descriptions of the frames."""
    options: tuple[ActionOption, ...]
    is_whole_trace: bool = False
    """True if the frames show the whole drive, as in the paper, instead of the time before the decision."""

    def earlier(self) -> tuple[Message, ...]:
        """Return the turns about the frames."""
        return frame_turns(self.frames, self.descriptions)

    def check(self, answer: ChosenAction) -> list[Issue]:
        """Return a fault if the action is not one of the options."""
        known = [option.id for option in self.options]
        if answer.action not in known:
            return [Issue("action", f"{answer.action!r} is none of {', '.join(known)}")]
        return []
