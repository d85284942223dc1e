"""The log of red teaming, round by round."""

from typing import ClassVar, Literal

from oodscen.data._base import Data
from oodscen.tree._scenario_tree import TreeEdit

Decision = Literal[
    "add",
    "split",
    "broaden",
    "covered",
    "duplicate",
    "not-ood",
    "off-topic",
    "malformed",
]
"""What became of a proposal.

`add`: a new leaf. `split`: a leaf that stood for too much became a family, with a new leaf in it.
`broaden`: a leaf's label was widened. `covered`: a leaf describes it already. `duplicate`: too near to
what exists, so that the tree-LLM was not asked. `not-ood`: ordinary driving. `off-topic`: no driving.
`malformed`: an answer stayed invalid, or did not fit the tree.
"""

NEW = ("add", "split")
"""Decisions that bring a new kind."""


class RunnerUp(Data):
    """A leaf that the text of a round would have fitted as well."""

    noun: ClassVar[str] = "runner-up"

    node: str
    why: str = ""


class Round(Data):
    """One round of red teaming: what was imagined, and what became of it."""

    noun: ClassVar[str] = "red-team round"

    round: int
    """Counted from 1."""
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    retryable: bool = False
    """Whether a failed round may succeed at another time."""
    text: str = ""
    """What the red-LLM imagined."""
    decision: Decision | None = None
    """`None` where no answer came."""
    reason: str = ""
    """Of the tree-LLM; for a duplicate, what it is too near to."""
    edits: tuple[TreeEdit, ...] = ()
    """What was done to the tree; a covered text leaves a `keep`."""
    nodes: int = 0
    """Size of the tree after the round."""
    kind: str | None = None
    """Id of the leaf that stands for the text after the round."""
    runners_up: tuple[RunnerUp, ...] = ()
    """Leaves that would have been the next best choices."""
    similarity: float | None = None
    """To the nearest of what existed, from -1 to 1, four decimals; `None` where nothing compared."""
    nearest: str | None = None
    """Id of the leaf to which that belongs."""
    nearest_by: Literal["label", "text"] | None = None
    """Whether the leaf's label is nearest, or an earlier proposal that it stands for."""
    calls: int = 0
    """Model calls spent on the round, repair turns included."""
    seen: int = 0
    """The red-LLM saw the tree as it was after this round; 0 is the initial tree."""
