"""The second turn of growing a tree: sort the examples into the two classes."""

from typing import ClassVar, Literal

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.data._messages import Message
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._tree.give_examples import Examples, GiveExamples


class ClassifiedExample(Brief, BaseModel):
    """The class of one example."""

    number: int = Field(description="of the example, counted from 1")
    reasoning: str = Field(description="one short sentence")
    scenario_class: Literal["environmental", "interactional"]


class Classification(Brief, BaseModel):
    """Answer: one class for every example."""

    examples: list[ClassifiedExample]


class ClassifyExamples(Prompt[Classification]):
    """Classify each example as environmental or interactional (paper, section III-A)."""

    purpose: ClassVar[str] = "classify-examples"
    template: ClassVar[str] = "classify_examples.md"
    answer: ClassVar[type[BaseModel]] = Classification
    follows = (GiveExamples,)

    asked: GiveExamples
    """The first turn."""
    given: tuple[str, ...]
    """The examples from the model's answer to the first turn."""

    def earlier(self) -> tuple[Message, ...]:
        """Return the first turn and its answer."""
        return (
            Message(role="user", text=self.asked.question()),
            Message(role="assistant", text=Examples(examples=list(self.given)).model_dump_json()),
        )

    def check(self, answer: Classification) -> list[Issue]:
        """Return a fault unless every example has exactly one class."""
        numbers = sorted(item.number for item in answer.examples)
        wanted = list(range(1, len(self.given) + 1))
        if numbers != wanted:
            return [Issue("examples", f"classify the numbers 1 to {len(self.given)}, each once")]
        return []
