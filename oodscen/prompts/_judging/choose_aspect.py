"""Task one as a closed question: which of these kinds of situation is it?"""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen.data._messages import Image, Message
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.describe_frame import DescribeFrame, frame_turns


class ChosenAspect(BaseModel):
    """Answer: the number of one option."""

    reasoning: str = Field(default="", description="step by step, short")
    choice: int = Field(ge=1, description="number of one option")


class ChooseAspect(Prompt[ChosenAspect]):
    """Choose what three frames showed among the leaves of a tree and "nothing unusual"."""

    purpose: ClassVar[str] = "choose-aspect"
    template: ClassVar[str] = "choose_aspect.md"
    answer: ClassVar[type[BaseModel]] = ChosenAspect
    follows = (DescribeFrame,)

    frames: tuple[Image, ...]
    descriptions: tuple[str, ...]
    """What the model said about each frame."""
    labels: tuple[str, ...]
    """In the order in which they are shown; shuffle them, so that a place in the list wins nothing."""

    def earlier(self) -> tuple[Message, ...]:
        """Return the turns about the frames."""
        return frame_turns(self.frames, self.descriptions)

    def check(self, answer: ChosenAspect) -> list[Issue]:
        """The number is that of an option."""
        if answer.choice > len(self.labels):
            return [Issue("choice", f"there are {len(self.labels)} options")]
        return []
