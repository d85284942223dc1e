"""The first task: name what is out of the ordinary."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.data._messages import Image, Message
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.describe_frame import DescribeFrame, frame_turns


class OodAspect(Brief, BaseModel):
    """Answer: whether the situation is OOD, and in which respect."""

    reasoning: str = Field(default="", description="step by step, short")
    is_ood: bool = Field(description="whether anything is out of the ordinary")
    confidence: float | None = Field(
        default=None, ge=0, le=1, description="how sure you are of is_ood, from 0.5 to 1"
    )
    aspect: str = Field(default="", description="the unusual aspect, as a short noun phrase")


class NameAspect(Prompt[OodAspect]):
    """Name the OOD characteristic of a drive of three frames (paper, section V-C, first task)."""

    purpose: ClassVar[str] = "name-aspect"
    template: ClassVar[str] = "name_aspect.md"
    answer: ClassVar[type[BaseModel]] = OodAspect
    follows = (DescribeFrame,)

    frames: tuple[Image, ...]
    descriptions: tuple[str, ...]
    """The model's descriptions of the frames."""

    def earlier(self) -> tuple[Message, ...]:
        """Return the turns about the frames."""
        return frame_turns(self.frames, self.descriptions)

    def check(self, answer: OodAspect) -> list[Issue]:
        """Return a fault if the aspect repeats the dots of the question."""
        if answer.is_ood and answer.aspect and not any(char.isalnum() for char in answer.aspect):
            return [Issue("aspect", "name it, or leave it empty")]
        return []
