"""The red-LLM's prompt: imagine an OOD scenario that the tree may lack."""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen._words.wording import description_fault
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import CatalogueDigest


class ImaginedScenario(Brief, BaseModel):
    """Answer: one scenario in words."""

    reasoning: str = Field(default="", description="what is missing or rare, in a sentence")
    text: str = Field(description="one or two sentences about the ego vehicle and what it meets")
    once_in_km: float | None = Field(
        default=None,
        gt=0.0,
        le=1e18,
        description="kilometres of urban driving in which a vehicle meets this kind about once",
    )


class ImagineScenario(Prompt[ImaginedScenario]):
    """Imagine one potential OOD scenario in urban driving (paper, section III-A, red teaming)."""

    purpose: ClassVar[str] = "imagine-scenario"
    template: ClassVar[str] = "imagine_scenario.md"
    answer: ClassVar[type[BaseModel]] = ImaginedScenario

    shown: tuple[str, ...]
    """The few-shot examples."""
    catalogue: CatalogueDigest | None = None
    """Content of the study's simulator; `None` in the paper's open loop."""
    covered: tuple[str, ...] = ()
    """Labels of the existing leaves; in the paper's open loop this field and all that follow are empty."""
    unlisted: int = 0
    """Number of further leaves, if the tree is too large to list them all."""
    thin: tuple[str, ...] = ()
    """Labels of the groups with the fewest leaves."""
    refused: tuple[str, ...] = ()
    """Recent proposals that were rejected as nothing new."""
    least_km: float | None = None
    """Wanted rarity: the kind is met about once in so many kilometres at least; `None` without a wish."""
    most_km: float | None = None
    """The same at most."""
    corner: str = ""
    """Label of the group to look at, while others look at others."""

    def check(self, answer: ImaginedScenario) -> list[Issue]:
        """Return a fault unless the text is one short paragraph of plain words."""
        if not 20 <= len(answer.text.strip()) <= 600:
            return [Issue("text", "write one or two sentences, 20 to 600 characters")]
        fault = description_fault(answer.text)
        return [Issue("text", fault)] if fault else []
