"""The first question to a vision-language model: describe a frame."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.data._messages import Image, Message
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt


class FrameDescription(Brief, BaseModel):
    """Answer: what is seen."""

    description: str = Field(description="what the frame shows, for a driver")


class DescribeFrame(Prompt[FrameDescription]):
    """Describe one of the frames, zero-shot chain of thought (paper, section V-C)."""

    purpose: ClassVar[str] = "describe-frame"
    template: ClassVar[str] = "describe_frame.md"
    answer: ClassVar[type[BaseModel]] = FrameDescription

    frames: tuple[Image, ...]
    """The frames so far, in order; the last one is to be described."""
    descriptions: tuple[str, ...] = ()
    """Descriptions of the earlier frames."""
    total: int = 3
    """Number of frames of the drive."""

    def earlier(self) -> tuple[Message, ...]:
        """Return the turns about the earlier frames."""
        return frame_turns(self.frames[:-1], self.descriptions)

    def images(self) -> tuple[Image, ...]:
        """Return the frame to be described."""
        return self.frames[-1:]

    def check(self, answer: FrameDescription) -> list[Issue]:
        """Return a fault if the answer repeats the dots of the question instead of words."""
        if not any(char.isalnum() for char in answer.description):
            return [Issue("description", "there is none")]
        return []


def frame_turns(frames: tuple[Image, ...], descriptions: tuple[str, ...]) -> tuple[Message, ...]:
    """Render the conversation about the frames described so far."""
    turns: list[Message] = []
    for index, description in enumerate(descriptions):
        prompt = DescribeFrame(
            frames=frames[: index + 1], descriptions=descriptions[:index], total=max(3, len(frames))
        )
        turns.append(Message(role="user", text=prompt.question(), images=prompt.images()))
        answer = FrameDescription(description=description)
        turns.append(Message(role="assistant", text=answer.model_dump_json()))
    return tuple(turns)
