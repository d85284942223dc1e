"""The question to a judge model: does an open answer name the aspect of a scenario?"""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.prompts._base import Prompt


class AspectJudgement(Brief, BaseModel):
    """Answer: whether both mean the same."""

    reasoning: str = Field(default="", description="short")
    is_same: bool = Field(description="whether the answer names what the label says")


class JudgeAspect(Prompt[AspectJudgement]):
    """Compare a model's open answer with the ground truth."""

    purpose: ClassVar[str] = "judge-aspect"
    template: ClassVar[str] = "judge_aspect.md"
    answer: ClassVar[type[BaseModel]] = AspectJudgement

    aspect: str
    """The answer of the judged model."""
    path: tuple[str, ...]
    """Labels below the root, down to the leaf."""
