"""The first turn of growing a tree: introduce the concept and ask for examples."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen._words.wording import description_fault
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt


class Examples(Brief, BaseModel):
    """Answer: short descriptions of OOD driving scenarios."""

    examples: list[str] = Field(description="one sentence each")


class GiveExamples(Prompt[Examples]):
    """Ask for examples of out-of-distribution driving scenarios (paper, section III-A)."""

    purpose: ClassVar[str] = "give-examples"
    template: ClassVar[str] = "give_examples.md"
    answer: ClassVar[type[BaseModel]] = Examples

    shown: tuple[str, ...]
    """The few-shot examples."""
    count: int
    """Number of new examples to give."""

    def check(self, answer: Examples) -> list[Issue]:
        """Return faults if there are too few examples, empty ones, or some not in plain words."""
        filled = [text for text in answer.examples if text.strip()]
        if len(filled) < self.count:
            return [Issue("examples", f"give {self.count}, not {len(filled)}")]
        return [
            Issue(f"examples[{index}]", fault)
            for index, text in enumerate(answer.examples)
            if text.strip() and (fault := description_fault(text))
        ]
