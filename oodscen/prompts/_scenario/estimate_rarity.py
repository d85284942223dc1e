"""The question of how rarely drivers meet the situations of texts."""

from typing import Annotated, ClassVar, Literal

from annotated_types import Ge, Le
from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt

Decades = Annotated[float, Ge(-2.0), Le(18.0)]


class RarityEstimate(Brief, BaseModel):
    """The rarity of one text."""

    number: int = Field(description="number of the text")
    unit: Literal["log10 km"] = Field(description="always log10 km")
    low: Decades | None = Field(default=None, description="low end, log10 km")
    best: Decades | None = Field(default=None, description="estimate, log10 km")
    high: Decades | None = Field(default=None, description="high end, log10 km")
    problem: Literal["none", "no driving", "impossible", "several events", "not understood"] = (
        "none"
    )


class RarityEstimates(Brief, BaseModel):
    """Answer: the rarity of every text."""

    estimates: list[RarityEstimate]


class EstimateRarity(Prompt[RarityEstimates]):
    """Estimate about once in how many kilometres drivers meet the situations of some texts."""

    purpose: ClassVar[str] = "estimate-rarity"
    template: ClassVar[str] = "estimate_rarity.md"
    answer: ClassVar[type[BaseModel]] = RarityEstimates

    texts: tuple[str, ...] = Field(min_length=1)
    population: str
    """Drivers and roads that the estimates are about."""

    def check(self, answer: RarityEstimates) -> list[Issue]:
        """Return a fault for every text without exactly one entry, and for figures out of order or missing."""
        numbers = [estimate.number for estimate in answer.estimates]
        counts = {number: numbers.count(number) for number in range(1, len(self.texts) + 1)}
        issues = [
            Issue("estimates", f"text {number} has {count} entries, not one")
            for number, count in counts.items()
            if count != 1
        ]
        if unknown := sorted(set(numbers) - set(counts)):
            issues.append(Issue("estimates", f"there is no text {unknown[0]}"))
        for index, estimate in enumerate(answer.estimates):
            figures = [
                figure
                for figure in (estimate.low, estimate.best, estimate.high)
                if figure is not None
            ]
            may_be_silent = estimate.problem not in ("none", "several events")
            is_complete = len(figures) == 3 or (not figures and may_be_silent)
            if figures != sorted(figures) or not is_complete:
                fault = (
                    "low, best and high are three logarithms in order, or all null with a problem"
                )
                issues.append(Issue(f"estimates[{index}]", fault))
        return issues
