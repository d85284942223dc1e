"""The prompt for the ordinary twin of a text."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen._words.text import folded_words
from oodscen._words.wording import description_fault
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt


class OrdinaryText(Brief, BaseModel):
    """Answer: one text."""

    text: str = Field(description="the same situation on an ordinary day")


class DescribeOrdinary(Prompt[OrdinaryText]):
    """Rewrite a text with its unusual event replaced by the event's ordinary counterpart.

    Place, phrasing, length and any weather that is not itself the event stay the same, so that text
    and twin differ only in what happens.
    """

    purpose: ClassVar[str] = "describe-ordinary"
    template: ClassVar[str] = "describe_ordinary.md"
    answer: ClassVar[type[BaseModel]] = OrdinaryText

    text: str
    """The text with the unusual event."""
    path: tuple[str, ...] = ()
    """Labels from the root down to the leaf, if the text has one."""

    def check(self, answer: OrdinaryText) -> list[Issue]:
        """Return a fault if the answer is the same text, differs much in length, or is not in plain words."""
        words, original = folded_words(answer.text), folded_words(self.text)
        if words == original:
            return [Issue("text", "is the same text; replace the unusual event")]
        count, original_count = len(words.split()), len(original.split())
        if not 0.5 * original_count - 4 <= count <= 1.5 * original_count + 4:
            message = f"has {count} words; keep about the {original_count} of the original"
            return [Issue("text", message)]
        fault = description_fault(answer.text)
        return [Issue("text", fault)] if fault else []
