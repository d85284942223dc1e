"""The describing question: texts that realise one path of the tree."""

import re
from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen.errors import Issue
from oodscen.prompts.base import Prompt


class Descriptions(BaseModel):
    """Answer: distinct texts."""

    texts: list[str] = Field(description="one or two sentences each")


class DescribePath(Prompt[Descriptions]):
    """Write scenarios along one path of the tree (paper, section III-B)."""

    purpose: ClassVar[str] = "describe-path"
    template: ClassVar[str] = "describe_path.md"
    answer: ClassVar[type[BaseModel]] = Descriptions

    path: tuple[str, ...]
    """Labels from the root down to the leaf."""
    count: int
    """How many texts are wanted."""
    avoid: tuple[str, ...] = ()
    """Texts that exist already."""

    def check(self, answer: Descriptions) -> list[Issue]:
        """There are enough texts, of reasonable length, no two of them equal."""
        issues = []
        if len(answer.texts) != self.count:
            issues.append(Issue("texts", f"give {self.count}, not {len(answer.texts)}"))
        seen = {plain(text) for text in self.avoid}
        for index, text in enumerate(answer.texts):
            if not 20 <= len(text.strip()) <= 600:
                issues.append(Issue(f"texts[{index}]", "use 20 to 600 characters"))
            if plain(text) in seen:
                issues.append(Issue(f"texts[{index}]", "says the same as an earlier text"))
            seen.add(plain(text))
        return issues


def plain(text: str) -> str:
    """Return a text without case and punctuation, to compare it with others."""
    return " ".join(re.findall(r"[^\W_]+", text.casefold()))
