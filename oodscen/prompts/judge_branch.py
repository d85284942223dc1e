"""The pruning question: can a simulator show what a branch describes?"""

from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen.errors import Issue, close_matches
from oodscen.prompts.base import Prompt
from oodscen.prompts.digest import CatalogueDigest


class BranchJudgement(BaseModel):
    """Answer: whether a branch can be simulated, with what, or what is missing."""

    reasoning: str = Field(description="one or two sentences")
    simulatable: bool
    assets: list[str] = Field(default=[], description="ids of the assets that realise it")
    behaviours: list[str] = Field(default=[], description="ids of the behaviours that realise it")
    missing: list[str] = Field(
        default=[], description="what would have to be added, if it is not simulatable"
    )


class JudgeBranch(Prompt[BranchJudgement]):
    """Prune to what the simulator's assets can show (paper, section III-B)."""

    purpose: ClassVar[str] = "judge-branch"
    template: ClassVar[str] = "judge_branch.md"
    answer: ClassVar[type[BaseModel]] = BranchJudgement

    path: tuple[str, ...]
    """Labels from the root down to the leaf."""
    catalogue: CatalogueDigest

    def check(self, answer: BranchJudgement) -> list[Issue]:
        """Named assets and behaviours exist; a refusal says what is missing."""
        issues = []
        for field, named, known in (
            ("assets", answer.assets, [a.id for a in self.catalogue.assets]),
            ("behaviours", answer.behaviours, [b.id for b in self.catalogue.behaviours]),
        ):
            for index, name in enumerate(named):
                if name not in known:
                    matches = close_matches(name, known)
                    hint = f"; did you mean {' or '.join(matches)}?" if matches else ""
                    issues.append(Issue(f"{field}[{index}]", f"{name!r} is not in the list{hint}"))
        if not answer.simulatable and not answer.missing:
            issues.append(Issue("missing", "say what would have to be added"))
        return issues
