"""Task one as the paper puts it: which aspect is out-of-distribution?"""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen.data._messages import Image, Message
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.describe_frame import DescribeFrame, frame_turns


class NamedAspect(BaseModel):
    """Answer: the OOD aspect."""

    reasoning: str = Field(default="", description="step by step, short")
    aspect: str = Field(description="the OOD aspect, as a short noun phrase")


class NameOodAspect(Prompt[NamedAspect]):
    """Name the OOD aspect of a drive that has one (paper, section V-C, first task).

    Nothing is asked about how likely that is, nor how sure the answer is: the paper shows no ordinary drives.
    """

    purpose: ClassVar[str] = "name-ood-aspect"
    template: ClassVar[str] = "name_ood_aspect.md"
    answer: ClassVar[type[BaseModel]] = NamedAspect
    follows = (DescribeFrame,)

    frames: tuple[Image, ...]
    """First, middle and last of the whole trace."""
    descriptions: tuple[str, ...]
    """What the model said about each frame."""

    def earlier(self) -> tuple[Message, ...]:
        """Return the turns about the frames."""
        return frame_turns(self.frames, self.descriptions)

    def check(self, answer: NamedAspect) -> list[Issue]:
        """The aspect is not the dots of the question."""
        if answer.aspect and not any(char.isalnum() for char in answer.aspect):
            return [Issue("aspect", "name it")]
        return []
