"""Prune the diverse tree to what one simulator can show (paper, section III-B)."""

from collections.abc import Iterable, Iterator
from typing import ClassVar, Literal

from oodscen._data import Data
from oodscen.ask import ask
from oodscen.catalogue import Catalogue
from oodscen.concurrency import as_finished
from oodscen.errors import LLMError
from oodscen.prompts import CatalogueDigest, JudgeBranch
from oodscen.protocols import LLM
from oodscen.tree import Node, ScenarioTree, TreeEdit


class PruneDecision(Data):
    """What becomes of one node, and why."""

    noun: ClassVar[str] = "prune decision"

    id: str
    """Of the node."""
    path: tuple[str, ...]
    keep: bool
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    retryable: bool = False
    """Whether a failed question may be answered at another time."""
    reason: str = ""
    assets: tuple[str, ...] = ()
    """Ids of the assets that realise it."""
    behaviours: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    """What an addition to the catalogue would have to bring to restore it."""


class Pruner:
    """Asks for every leaf whether the catalogue can show it.

    Args:
        llm: The tree-LLM.
        catalogue: What the simulator offers.
        threads: How many questions may be under way at once.
    """

    def __init__(self, llm: LLM, catalogue: Catalogue, *, threads: int = 1) -> None:
        self.llm = llm
        self.catalogue = CatalogueDigest.of(catalogue)
        self.threads = threads

    def run(self, tree: ScenarioTree) -> ScenarioTree:
        """Return the simulatable tree; its edits tell the reason for every node."""
        return pruned(tree, self.decisions(tree))

    def decisions(self, tree: ScenarioTree, done: Iterable[str] = ()) -> Iterator[PruneDecision]:
        """Judge the leaves, in the order in which answers come.

        Args:
            tree: The diverse tree.
            done: Ids of leaves that were judged before.
        """
        skip = set(done)
        leaves = [leaf for leaf in tree.leaves if leaf.id not in skip]
        paths = tree.paths
        for _, decision in as_finished(
            lambda leaf: self._judge(leaf, paths[leaf.id]), leaves, threads=self.threads
        ):
            yield decision

    def _judge(self, leaf: Node, path: tuple[str, ...]) -> PruneDecision:
        try:
            answer = ask(self.llm, JudgeBranch(path=path, catalogue=self.catalogue))
        except LLMError as error:
            return PruneDecision(
                id=leaf.id,
                path=path,
                keep=False,
                status="failed",
                error=str(error),
                retryable=error.retryable,
            )
        return PruneDecision(
            id=leaf.id,
            path=path,
            keep=answer.simulatable,
            reason=answer.reasoning,
            assets=tuple(answer.assets),
            behaviours=tuple(answer.behaviours),
            missing=() if answer.simulatable else tuple(answer.missing),
        )


def all_decisions(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
    """Extend the decisions on leaves to every node, in tree order.

    An inner node is kept exactly when one of its children is. The root always stays.
    """
    by_id = {decision.id: decision for decision in judged}
    for node, _ in reversed(list(tree.walk())):
        if node.id in by_id:
            continue
        kept = [child for child in tree.children[node.id] if by_id[child].keep]
        reason = f"{len(kept)} of {len(tree.children[node.id])} branches can be shown"
        by_id[node.id] = PruneDecision(
            id=node.id,
            path=tree.path(node.id),
            keep=bool(kept) or node.parent is None,
            reason=reason,
        )
    return [by_id[node.id] for node, _ in tree.walk()]


def pruned(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> ScenarioTree:
    """Apply decisions on the leaves: one `keep` or `remove` per node, children first."""
    decisions = all_decisions(tree, judged)
    return tree.apply(
        *(
            TreeEdit(
                op="keep" if decision.keep else "remove",
                node=decision.id,
                stage="prune",
                reason=decision.reason or decision.error or "",
            )
            for decision in reversed(decisions)
        )
    )
