"""The question to a judge model: does an open answer name the aspect of a scenario?"""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.data._scene import Visible
from oodscen.prompts._base import Prompt


class AspectJudgement(Brief, BaseModel):
    """Answer, in two steps: the thing, and what is wrong with it."""

    reasoning: str = Field(default="", description="short")
    is_same_thing: bool = Field(description="whether the answer names the thing")
    is_same_fault: bool = Field(description="whether the answer names what is wrong with the thing")


class JudgeAspect(Prompt[AspectJudgement]):
    """Compare a model's open answer with the ground truth."""

    purpose: ClassVar[str] = "judge-aspect"
    template: ClassVar[str] = "judge_aspect.md"
    answer: ClassVar[type[BaseModel]] = AspectJudgement

    aspect: str
    """The answer of the judged model."""
    path: tuple[str, ...]
    """Labels below the root, down to the leaf."""
    visible: tuple[Visible, ...] = ()
    """Everything that can be seen of the hazard."""
