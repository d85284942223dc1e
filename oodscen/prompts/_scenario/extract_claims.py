"""The reading prompt: the claims of a text about a scene."""

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field

from oodscen._display import Brief
from oodscen._words.text import folded_words
from oodscen.data._claim import NUMBERS, OF_THINGS, VALUES, Claim
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt

MOST_CLAIMS = 60
"""Largest number of claims in an answer."""
_SMALL = frozenset(
    "a an and as at by for from in into is it its of on or that the there this to with".split()
)
"""Words that make no claim by themselves."""


class Claims(Brief, BaseModel):
    """Answer: what a text says, in its order."""

    model_config = ConfigDict(extra="forbid")

    claims: list[Claim] = Field(description="every claim that the words make")


class ExtractClaims(Prompt[Claims]):
    """Read the claims of a text from its words alone, for later comparison with scenes."""

    purpose: ClassVar[str] = "extract-claims"
    template: ClassVar[str] = "extract_claims.md"
    answer: ClassVar[type[BaseModel]] = Claims

    text: str

    def variables(self) -> dict[str, Any]:
        """Return the text and the vocabulary of claims."""
        return {
            "text": self.text,
            "values": VALUES,
            "numbers": NUMBERS,
            "of_things": sorted(OF_THINGS),
        }

    def check(self, answer: Claims) -> list[Issue]:
        """Return faults: quotes that the text lacks, repeated claims, and subjects not claimed to be present."""
        issues = []
        words = f" {folded_words(self.text)} "
        if len(answer.claims) > MOST_CLAIMS:
            issues.append(Issue("claims", f"give {MOST_CLAIMS} at most, not {len(answer.claims)}"))
        seen: set[tuple[str, str, str]] = set()
        for index, claim in enumerate(answer.claims):
            path = f"claims[{index}]"
            quote = folded_words(claim.quote)
            if not set(quote.split()) - _SMALL or f" {quote} " not in words:
                issues.append(Issue(f"{path}.quote", "copy the words of the text that say so"))
            key = (claim.kind, claim.value, claim.subject)
            if key in seen:
                issues.append(Issue(path, "the same claim is there already"))
            seen.add(key)
        present = {claim.subject for claim in answer.claims if claim.kind == "thing"}
        subjects = dict.fromkeys(claim.subject for claim in answer.claims if claim.subject)
        issues += [
            Issue("claims", f"add a claim `thing` `present` for {subject!r}")
            for subject in subjects
            if subject not in present
        ]
        return issues
