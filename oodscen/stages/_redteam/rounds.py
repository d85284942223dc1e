"""The log of red teaming, round by round."""

from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from oodscen.data._base import Data
from oodscen.data._issues import IssuesError
from oodscen.errors import Issue
from oodscen.tree._scenario_tree import TreeEdit

Decision = Literal[
    "add",
    "split",
    "broaden",
    "covered",
    "duplicate",
    "implausible",
    "not-ood",
    "off-topic",
    "malformed",
]
"""The decision on a proposal.

`add`: a new leaf. `split`: an overly broad leaf became a family, with a new leaf in it. `broaden`: a leaf's
label was widened. `covered`: a leaf describes it already. `duplicate`: too similar to what exists, so that
the tree-LLM was not asked. `implausible`: met too rarely or too often for the band that is set, by the
red-LLM's own estimate or the offline one; the tree-LLM was not asked. `not-ood`: ordinary driving.
`off-topic`: not about driving. `malformed`: an answer stayed invalid, or did not fit the tree.
"""

NEW = ("add", "split")
"""Decisions that add a new kind."""


class RunnerUp(Data):
    """A leaf that the text of a round would also have fitted."""

    noun: ClassVar[str] = "runner-up"

    node: str
    why: str = ""


class Round(Data):
    """One round of red teaming: the proposal, and the decision on it."""

    noun: ClassVar[str] = "red-team round"

    round: int = Field(ge=1)
    """Number of the round, from 1."""
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    retryable: bool = False
    """True if a failed round may succeed later."""
    text: str = ""
    """The red-LLM's proposal."""
    once_in_km: float | None = Field(default=None, gt=0)
    """Kilometres in which a vehicle meets this kind about once; `None` if nothing tells."""
    once_in_km_by: Literal["model", "head"] | None = None
    """The red-LLM, or the offline head of `Metrics.rarity` if the red-LLM gave no figure."""
    decision: Decision | None = None
    """`None` if no answer came."""
    reason: str = ""
    """The tree-LLM's reason; for a duplicate, the label or proposal that it resembles."""
    edits: tuple[TreeEdit, ...] = ()
    """Edits of the tree; a covered text leaves a `keep`."""
    nodes: int = Field(default=0, ge=0)
    """Size of the tree after the round."""
    kind: str | None = None
    """Id of the leaf that stands for the text after the round."""
    runners_up: tuple[RunnerUp, ...] = ()
    """Leaves that were the next best choices."""
    similarity: float | None = Field(default=None, ge=-1, le=1)
    """Similarity to the nearest label or proposal, from -1 to 1, four decimals; `None` if nothing was compared."""
    nearest: str | None = None
    """Id of the leaf behind that similarity."""
    nearest_by: Literal["label", "text"] | None = None
    """`label` if the leaf's label is nearest, `text` if an earlier proposal that it stands for is."""
    calls: int = Field(default=0, ge=0)
    """Model calls of the round, including repairs."""
    seen: int = Field(default=0, ge=0)
    """Number of the last round in the tree that the red-LLM saw; 0 is the initial tree."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.decision == "split" and [edit.op for edit in self.edits[:2]] != ["broaden", "add"]:
            fault = "a split widens a leaf, and adds one with its old label"
            raise IssuesError([Issue("edits", fault)])
        return self
