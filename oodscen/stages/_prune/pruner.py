"""The pruner, which reduces the diverse tree to what one simulator can show (paper, section III-B)."""

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal, TypeVar

from oodscen._concurrency import as_finished
from oodscen._display import Brief
from oodscen._numbers import whole_number
from oodscen._paper import attestation
from oodscen._progress import Progress, counted, reporting
from oodscen._text import one_line
from oodscen.data._additions import Addition
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.errors import LLMError
from oodscen.llm._ask import ask, speaker
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._fitting import fitted
from oodscen.prompts._tree.judge_branch import JudgeBranch
from oodscen.protocols import LLM
from oodscen.tree._scenario_tree import Node, ScenarioTree, TreeEdit

if TYPE_CHECKING:
    from oodscen.stages._prune.restoration import Restoration
    from oodscen.stages._prune.side_by_side import CatalogueComparison

_LONGEST_REASON = 1_000
"""Maximum length of a model's reason that is stored, in characters."""

Means = TypeVar("Means", bound=Hashable)

Match = Literal["full", "substitute", "part", "none"]
"""The quality of a match between a branch and a catalogue.

`full`: shown as it is. `substitute`: with assets that stand in for others. `part`: only a part of what the
label names, or below an inner node not every branch. `none`: not at all.
"""


class StandIn(Data):
    """An asset that replaces something the catalogue lacks."""

    asset: str
    stands_for: str


class PruneDecision(Data):
    """The decision about one node, with its reason."""

    noun: ClassVar[str] = "prune decision"

    id: str
    """Id of the node."""
    path: tuple[str, ...]
    keep: bool
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    retryable: bool = False
    """True if a failed question may succeed later."""
    reason: str = ""
    match: Match | None = None
    """`None` if the question failed."""
    label: str = ""
    """The node's narrower label, if only a part of it can be shown."""
    assets: tuple[str, ...] = ()
    """Ids of the assets that realise the node; for an inner node, those of all its kept branches."""
    states: tuple[str, ...] = ()
    """Required states, as `asset: state`."""
    behaviours: tuple[str, ...] = ()
    weather: tuple[str, ...] = ()
    """Required weather: `night`, `fog`, `rain`, `snow` or `ice`."""
    traits: tuple[str, ...] = ()
    """Required traits of the map."""
    substitutes: tuple[StandIn, ...] = ()
    missing: tuple[str, ...] = ()
    """The additions in `lacks` in words."""
    lacks: tuple[Addition, ...] = ()
    """Additions to the catalogue: for a dropped leaf all that restore it, for a kept one those that would
    replace its substitutes or show the rest of its label.
    """
    same_as: tuple[str, ...] = ()
    """Ids of the other leaves that the simulator shows with exactly the same means."""
    catalogue: str = ""
    """The simulator and its version."""
    model: str = ""
    """Name of the model that judged; empty for inner nodes, which follow from their leaves."""
    prompt: str = ""
    """The question that the model was asked: `purpose@version`."""


class Pruner(Brief):
    """Asks for every leaf whether the catalogue can show it.

    Args:
        llm: The tree-LLM.
        catalogue: The simulator's catalogue.
        threads: Maximum number of concurrent questions.
        cancel: Called when waiting for answers is interrupted, so that pending calls end soon.
        substitutes: Keep branches that are shown with substitute assets.
        context: Context window of the model in tokens, if the whole catalogue is too long for it.
    """

    _repr_fields = ("llm", "name", "substitutes", "threads")

    def __init__(
        self,
        llm: LLM,
        catalogue: Catalogue,
        *,
        threads: int = 1,
        cancel: Callable[[], None] | None = None,
        substitutes: bool = True,
        context: int | None = None,
    ) -> None:
        self.llm = llm
        self.catalogue = CatalogueDigest.of(catalogue)
        self.name = f"{catalogue.simulator}-{catalogue.version}"
        self.threads = whole_number("threads", threads, 1)
        self.cancel = cancel
        self.substitutes = substitutes
        self.context = None if context is None else whole_number("context", context, 1)

    def run(self, tree: ScenarioTree, *, progress: Progress | bool | None = None) -> ScenarioTree:
        """Return the simulatable tree; its edits hold the reason for every node.

        Args:
            tree: The diverse tree.
            progress: True for a progress bar, or a callable; it counts the leaves.
        """
        with reporting(progress) as told:
            judged = counted(self.decisions(tree), "prune", len(tree.leaves), told)
            return pruned(tree, judged)

    def decisions(self, tree: ScenarioTree, done: Iterable[str] = ()) -> Iterator[PruneDecision]:
        """Yield a decision for every leaf, in the order of the answers.

        Args:
            tree: The diverse tree.
            done: Ids of leaves that were already judged.
        """
        skip = set(done)
        leaves = [leaf for leaf in tree.leaves if leaf.id not in skip]
        paths = tree.paths
        for _, decision in as_finished(
            lambda leaf: self._judge(leaf, paths[leaf.id]),
            leaves,
            threads=self.threads,
            cancel=self.cancel,
        ):
            yield decision

    @staticmethod
    def pruned(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> ScenarioTree:
        """Return the tree after decisions on its leaves, as `run` does after its own."""
        return pruned(tree, judged)

    @staticmethod
    def all_decisions(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
        """Extend the decisions on leaves to every node, in tree order."""
        return all_decisions(tree, judged)

    @staticmethod
    def restoration(decisions: Iterable[PruneDecision]) -> "Restoration":
        """Rank the additions that would restore the branches that pruning dropped.

        A leaf is restored when everything that it lacks is added. This holds for the same judge:
        `Catalogue.extended` makes the catalogue with which to ask it again.

        Args:
            decisions: Decisions on leaves, or on every node; inner nodes are ignored.
        """
        from oodscen.stages._prune.restoration import restoration

        return restoration(decisions)

    @staticmethod
    def compare(
        tree: ScenarioTree,
        catalogues: Mapping[str, Catalogue],
        judged: Mapping[str, Sequence[PruneDecision]],
    ) -> "CatalogueComparison":
        """Compare the decisions of several catalogues about one tree.

        Args:
            tree: The diverse tree.
            catalogues: The catalogues by name.
            judged: The decisions about all leaves, by the same names.

        Raises:
            ValueError: When catalogues and decisions have different names.
        """
        from oodscen.stages._prune.side_by_side import compare

        return compare(tree, catalogues, judged)

    def _judge(self, leaf: Node, path: tuple[str, ...]) -> PruneDecision:
        asked = {
            "catalogue": self.name,
            "model": speaker(self.llm),
            "prompt": JudgeBranch.citation(),
        }
        try:
            question = JudgeBranch(path=path, catalogue=self.catalogue)
            answer = ask(self.llm, fitted(question, self.context))
        except LLMError as error:
            return PruneDecision(
                id=leaf.id,
                path=path,
                keep=False,
                status="failed",
                error=str(error),
                retryable=error.retryable,
                **asked,
            )
        standing = tuple(
            StandIn(asset=one.asset, stands_for=one.stands_for) for one in answer.substitutes
        )
        keep = answer.simulatable and (self.substitutes or not standing)
        match: Match = "full"
        if not keep:
            match = "none"
        elif answer.label:
            match = "part"
        elif standing:
            match = "substitute"
        lacks = tuple(dict.fromkeys(answer.missing)) if match != "full" else ()
        used = answer if keep else None
        return PruneDecision(
            id=leaf.id,
            path=path,
            keep=keep,
            reason=one_line(answer.reasoning)[:_LONGEST_REASON] or _said(keep, lacks),
            match=match,
            label=one_line(answer.label) if keep else "",
            assets=_unique(used.assets) if used else (),
            states=_unique(used.states) if used else (),
            behaviours=_unique(used.behaviours) if used else (),
            weather=_unique(used.weather) if used else (),
            traits=_unique(used.traits) if used else (),
            substitutes=standing if keep else (),
            missing=tuple(one.words for one in lacks),
            lacks=lacks,
            **asked,
        )


def all_decisions(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
    """Extend the decisions on leaves to every node, in tree order.

    An inner node is kept exactly if one of its children is, and is realised by everything that realises
    these. The root always stays. Leaves that are realised by the same means name each other in `same_as`.
    """
    judged = alike(tree, judged)
    leaves = {decision.id for decision in judged}
    return [
        one if one.id in leaves else one.model_copy(update={"path": tree.path(one.id)})
        for one in fates(tree, judged)
    ]


def fates(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
    """Extend the decisions on leaves to every node; inner nodes get no path."""
    by_id = {decision.id: decision for decision in judged}
    for node, _ in reversed(list(tree.walk())):
        if node.id in by_id:
            continue
        children = tree.children[node.id]
        kept = [child for child in children if by_id[child].keep]
        is_whole = bool(children) and all(by_id[child].match == "full" for child in children)
        match: Match = "full" if is_whole else "part" if kept else "none"
        reason = f"{len(kept)} of {len(children)} branches can be shown"
        if not children:
            reason = "nothing lies below it"
        below = [by_id[child] for child in kept]
        by_id[node.id] = PruneDecision(
            id=node.id,
            path=(),
            keep=bool(kept) or node.parent is None,
            reason=reason,
            match=match,
            assets=_all([one.assets for one in below]),
            states=_all([one.states for one in below]),
            behaviours=_all([one.behaviours for one in below]),
            weather=_all([one.weather for one in below]),
            traits=_all([one.traits for one in below]),
            substitutes=_all([one.substitutes for one in below]),
            catalogue=next((by_id[child].catalogue for child in children), ""),
        )
    return [by_id[node.id] for node, _ in tree.walk()]


def alike(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
    """Set `same_as` of kept leaves that the simulator shows by the same means; keep the given order."""
    judged = list(judged)
    order = {node.id: number for number, node in enumerate(tree.nodes)}
    groups: dict[tuple[frozenset[str], ...], list[str]] = {}
    for one in sorted(judged, key=lambda one: order.get(one.id, len(order))):
        if one.keep and any(means := _means(one)):
            groups.setdefault(means, []).append(one.id)
    return [
        one.model_copy(
            update={"same_as": tuple(i for i in groups.get(_means(one), ()) if i != one.id)}
            if one.keep
            else {"same_as": ()}
        )
        for one in judged
    ]


def pruned(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> ScenarioTree:
    """Apply decisions on the leaves: one `keep`, `narrow` or `remove` per node, children first.

    A narrowed leaf stays attested only if its new label still names what the paper simulated.
    """
    return tree.apply(*(_edit(decision) for decision in reversed(fates(tree, judged))))


def _edit(decision: PruneDecision) -> TreeEdit:
    is_narrowed = decision.keep and bool(decision.label)
    return TreeEdit(
        op="narrow" if is_narrowed else "keep" if decision.keep else "remove",
        node=decision.id,
        label=decision.label if is_narrowed else None,
        attested=attestation(decision.label) if is_narrowed else None,
        stage="prune",
        reason=decision.reason or decision.error or "",
        model=decision.model,
        prompt=decision.prompt,
    )


def _means(decision: PruneDecision) -> tuple[frozenset[str], ...]:
    """Return everything that a decision demands of a simulator."""
    return tuple(
        frozenset(names)
        for names in (
            decision.assets,
            decision.states,
            decision.behaviours,
            decision.weather,
            decision.traits,
        )
    )


def _unique(names: Sequence[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(names))


def _all(lists: Sequence[tuple[Means, ...]]) -> tuple[Means, ...]:
    """Return the union of the assets, behaviours and weather that show the branches below a node."""
    if len(lists) == 1:
        return lists[0]
    return tuple(dict.fromkeys(one for means in lists for one in means))


def _said(keep: bool, lacks: Sequence[Addition]) -> str:
    """Return a reason for a decision whose model gave none."""
    if keep:
        return "the model says that it can be shown"
    return f"missing: {', '.join(one.words for one in lacks)}" if lacks else "no reason was given"
