"""Turn one of growing a tree: introduce the concept, ask for examples."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen.errors import Issue
from oodscen.prompts._base import Prompt


class Examples(BaseModel):
    """Answer: short descriptions of OOD driving scenarios."""

    examples: list[str] = Field(description="one sentence each")


class GiveExamples(Prompt[Examples]):
    """What is an out-of-distribution driving scenario? Give examples (paper, section III-A)."""

    purpose: ClassVar[str] = "give-examples"
    template: ClassVar[str] = "give_examples.md"
    answer: ClassVar[type[BaseModel]] = Examples

    shown: tuple[str, ...]
    """The few shots."""
    count: int
    """How many new examples are wanted."""

    def check(self, answer: Examples) -> list[Issue]:
        """Ask for enough examples, none of them empty."""
        filled = [text for text in answer.examples if text.strip()]
        if len(filled) < self.count:
            return [Issue("examples", f"give {self.count}, not {len(filled)}")]
        return []
