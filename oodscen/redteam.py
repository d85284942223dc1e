"""Red teaming: a red-LLM imagines scenarios, the tree-LLM makes the tree cover them."""

from collections.abc import Iterable, Iterator
from typing import ClassVar, Literal

from oodscen._data import Data
from oodscen.ask import ask
from oodscen.errors import DataError, LLMError
from oodscen.paper import FEW_SHOTS, ITERATIONS, attestation
from oodscen.prompts import ImagineScenario, PlacedScenario, PlaceScenario
from oodscen.protocols import LLM
from oodscen.tree import ScenarioTree, TreeEdit


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
    decision: Literal["covered", "broaden", "add", "reject"] | None = None
    reason: str = ""
    """Of the tree-LLM."""
    edits: tuple[TreeEdit, ...] = ()
    """What was done to the tree; a covered text leaves a `keep`."""
    nodes: int = 0
    """Size of the tree after the round."""


class RedTeamer:
    """Grows a diverse tree out of an initial one (paper, section III-A, red teaming).

    Args:
        llm: The tree-LLM.
        red_llm: The red-LLM; the same model if left out.
        iterations: Number of rounds.
        closed_loop: Show the red-LLM what is covered already. `False` is the paper's procedure.
        shown: The few shots.
    """

    def __init__(
        self,
        llm: LLM,
        red_llm: LLM | None = None,
        *,
        iterations: int = ITERATIONS,
        closed_loop: bool = True,
        shown: tuple[str, ...] = FEW_SHOTS,
    ) -> None:
        self.llm = llm
        self.red_llm = red_llm or llm
        self.iterations = iterations
        self.closed_loop = closed_loop
        self.shown = shown

    def run(self, tree: ScenarioTree) -> ScenarioTree:
        """Return the tree after all rounds; its edits tell the round, text and reason of each."""
        for item in self.rounds(tree):
            tree = tree.apply(*item.edits)
        return tree

    def rounds(self, tree: ScenarioTree, done: Iterable[Round] = ()) -> Iterator[Round]:
        """Play the rounds one by one.

        A round that fails is yielded with its error and leaves the tree as it is.

        Args:
            tree: The tree before the first round.
            done: Rounds that were played before, to continue after them.
        """
        first = 1
        for item in done:
            tree = tree.apply(*item.edits)
            first = item.round + 1
        for number in range(first, self.iterations + 1):
            item = self._play(tree, number)
            tree = tree.apply(*item.edits)
            yield item

    def _play(self, tree: ScenarioTree, number: int) -> Round:
        covered = tuple(leaf.label for leaf in tree.leaves) if self.closed_loop else ()
        text = ""
        try:
            imagine = ImagineScenario(shown=self.shown, covered=covered)
            text = " ".join(ask(self.red_llm, imagine, sample=number).text.split())
            placed = ask(self.llm, PlaceScenario(text=text, nodes=tree.nodes), sample=number)
            edits = _edits(tree, placed, number, text)
            size = len(tree.apply(*edits))
        except (LLMError, DataError) as error:
            return Round(
                round=number,
                status="failed",
                error=str(error),
                retryable=getattr(error, "retryable", False),
                text=text,
                nodes=len(tree),
            )
        return Round(
            round=number,
            text=text,
            decision=placed.decision,
            reason=placed.reasoning,
            edits=edits,
            nodes=size,
        )


def _edits(
    tree: ScenarioTree, placed: PlacedScenario, number: int, text: str
) -> tuple[TreeEdit, ...]:
    """Translate a decision into edits; `ask` has checked that it fits the tree."""
    if placed.decision == "reject" or placed.node is None:
        return ()
    why = {"stage": "redteam", "round": number, "reason": placed.reasoning, "source": text}
    if placed.decision == "covered":
        return (TreeEdit(op="keep", node=placed.node, **why),)
    label = " ".join((placed.label or "").split())
    if placed.decision == "broaden":
        return (
            TreeEdit(
                op="broaden", node=placed.node, label=label, attested=attestation(label), **why
            ),
        )
    edits = []
    parent = placed.node
    if placed.category:
        family = " ".join(placed.category.split())
        edits.append(
            TreeEdit(op="add", node=tree.new_id(family), parent=parent, label=family, **why)
        )
        parent = edits[0].node
        tree = tree.apply(*edits)
    leaf = TreeEdit(
        op="add",
        node=tree.new_id(label),
        parent=parent,
        label=label,
        attested=attestation(label),
        **why,
    )
    return (*edits, leaf)
