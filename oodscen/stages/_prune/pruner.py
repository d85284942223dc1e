"""The pruner, which reduces the diverse tree to what one simulator can show (paper, section III-B)."""

from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from typing import Any

from oodscen._arguments import checked, instance_of
from oodscen._display import Brief
from oodscen._numbers import whole_number
from oodscen._parallel.threads import as_finished
from oodscen._progress import Progress, counted, reporting
from oodscen._words.text import one_line
from oodscen.data._additions import Addition
from oodscen.data._catalogue import Catalogue
from oodscen.errors import LLMError
from oodscen.llm._ask import ask, speaker
from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._fitting import fitted
from oodscen.prompts._tree.judge_branch import BranchJudgement, JudgeBranch, JudgeBranches
from oodscen.protocols import LLM
from oodscen.stages._failures import refuse_if_all_failed
from oodscen.stages._prune.decisions import (
    MEANS,
    Match,
    PruneDecision,
    SubstitutedAsset,
    all_decisions,
    apply_decisions,
)
from oodscen.stages._prune.restoration import restoration
from oodscen.stages._prune.side_by_side import compare
from oodscen.tree._scenario_tree import Node, ScenarioTree

TOGETHER = 8
"""Number of leaves that one question is about: the catalogue is longer than all that is said of them."""
_LONGEST_REASON = 1_000
"""Number of characters of a reason that are kept."""


class Pruner(Brief):
    """Asks for every leaf whether the catalogue can show it.

    Neighbouring leaves are asked about together. If the model gives no valid answer about them, each is asked
    about alone.

    Args:
        llm: The tree-LLM.
        catalogue: The simulator's catalogue.
        threads: Maximum number of concurrent questions.
        cancel: Called when waiting for answers is interrupted, so that pending calls end soon.
        substitutes: Keep branches that are shown with substitute assets.
        context: Context window of the model in tokens, if the whole catalogue is too long for it. Leaves are then
            asked about one by one.
        together: Largest number of leaves in one question.
    """

    _repr_fields = ("llm", "name", "substitutes", "threads")

    @checked
    def __init__(
        self,
        llm: LLM,
        catalogue: Catalogue,
        *,
        threads: int = 1,
        cancel: Callable[[], None] | None = None,
        substitutes: bool = True,
        context: int | None = None,
        together: int = TOGETHER,
    ) -> None:
        instance_of("catalogue", catalogue, Catalogue)
        self.llm = llm
        self.catalogue = CatalogueDigest.of(catalogue)
        self.name = f"{catalogue.simulator}-{catalogue.version}"
        self.threads = whole_number("threads", threads, 1)
        self.cancel = cancel
        self.substitutes = substitutes
        self.context = None if context is None else whole_number("context", context, 1)
        self.together = whole_number("together", together, 1) if context is None else 1

    @checked
    def run(self, tree: ScenarioTree, *, progress: Progress | bool | None = None) -> ScenarioTree:
        """Return the simulatable tree; its edits hold the reason for every node.

        A leaf that could not be judged is dropped, and its edit says so.

        Args:
            tree: The diverse tree.
            progress: True for a progress bar, or a callable; it counts the leaves.

        Raises:
            LLMError: When no leaf could be judged.
        """
        with reporting(progress) as report_progress:
            decisions = self.decisions(tree)
            judged = list(counted(decisions, "prune", len(tree.leaves), report_progress))
        refuse_if_all_failed(judged, "no leaf could be judged", self.llm.name)
        return apply_decisions(tree, judged)

    @checked
    def decisions(self, tree: ScenarioTree, done: Iterable[str] = ()) -> Iterator[PruneDecision]:
        """Yield a decision for every leaf, in the order of the answers.

        Args:
            tree: The diverse tree.
            done: Ids of leaves that were already judged. They get no decision; where one of their group does, the
                question names them as well.
        """
        skip = set(done)
        branches = [(leaf, tree.paths[leaf.id]) for leaf in tree.leaves]
        # Groups hold what is done as well, so that they are the same groups, and questions, as ever.
        groups = [
            branches[start : start + self.together]
            for start in range(0, len(branches), self.together)
        ]
        for _, decisions in as_finished(
            lambda group: self._judge_all(group, skip),
            [group for group in groups if any(leaf.id not in skip for leaf, _ in group)],
            threads=self.threads,
            cancel=self.cancel,
        ):
            yield from decisions

    pruned = staticmethod(apply_decisions)
    all_decisions = staticmethod(all_decisions)
    restoration = staticmethod(restoration)
    compare = staticmethod(compare)

    def _judge_all(
        self, branches: Sequence[tuple[Node, tuple[str, ...]]], skip: Set[str]
    ) -> list[PruneDecision]:
        """Judge leaves in one call, or one by one if the model does not manage several."""
        wanted = [(leaf, path) for leaf, path in branches if leaf.id not in skip]
        if len(branches) == 1:
            return [self._judge(leaf, path) for leaf, path in wanted]
        paths = tuple(path for _, path in branches)
        question = JudgeBranches(paths=paths, catalogue=self.catalogue, exact=not self.substitutes)
        try:
            judgements = ask(self.llm, question).judgements
        except LLMError as error:
            if error.retryable:
                return [self._failed(leaf, path, error, question) for leaf, path in wanted]
            return [self._judge(leaf, path) for leaf, path in wanted]
        by_number = {judgement.number: judgement for judgement in judgements}
        return [
            self._decision(leaf, path, by_number[number], question)
            for number, (leaf, path) in enumerate(branches, start=1)
            if leaf.id not in skip
        ]

    def _judge(self, leaf: Node, path: tuple[str, ...]) -> PruneDecision:
        judge = JudgeBranch(path=path, catalogue=self.catalogue, exact=not self.substitutes)
        question = fitted(judge, self.context)
        try:
            return self._decision(leaf, path, ask(self.llm, question), question)
        except LLMError as error:
            return self._failed(leaf, path, error, question)

    def _provenance(self, question: Prompt[Any]) -> dict[str, str]:
        model = speaker(self.llm)
        return {"catalogue": self.name, "model": model, "prompt": question.citation()}

    def _failed(
        self, leaf: Node, path: tuple[str, ...], error: LLMError, question: Prompt[Any]
    ) -> PruneDecision:
        return PruneDecision(
            id=leaf.id,
            path=path,
            keep=False,
            status="failed",
            error=str(error),
            retryable=error.retryable,
            **self._provenance(question),
        )

    def _decision(
        self, leaf: Node, path: tuple[str, ...], answer: BranchJudgement, question: Prompt[Any]
    ) -> PruneDecision:
        substitutes = tuple(
            SubstitutedAsset(asset=substitute.asset, stands_for=substitute.stands_for)
            for substitute in answer.substitutes
        )
        keep = answer.simulatable and (self.substitutes or not substitutes)
        match: Match = "full"
        if not keep:
            match = "none"
        elif answer.label:
            match = "part"
        elif substitutes:
            match = "substitute"
        lacks = tuple(dict.fromkeys(answer.missing)) if match != "full" else ()
        if answer.simulatable and not keep:
            lacks = lacks or self._stood_for(substitutes)
        reason = one_line(answer.reasoning)[:_LONGEST_REASON] or _default_reason(keep, lacks)
        means = {name: tuple(dict.fromkeys(getattr(answer, name))) for name in MEANS}
        # A model may name a substitute as such alone.
        shown_by = (*answer.assets, *(substitute.asset for substitute in substitutes))
        means["assets"] = tuple(dict.fromkeys(shown_by))
        return PruneDecision(
            id=leaf.id,
            path=path,
            keep=keep,
            reason=reason,
            match=match,
            label=one_line(answer.label) if keep else "",
            **means if keep else {},
            substitutes=substitutes if keep else (),
            missing=tuple(lack.words for lack in lacks),
            lacks=lacks,
            instead=() if keep else tuple(map(tuple, answer.instead)),
            **self._provenance(question),
        )

    def _stood_for(self, substitutes: Sequence[SubstitutedAsset]) -> tuple[Addition, ...]:
        """Return the things that refused substitutes stand for, each once, as additions to the catalogue."""
        categories = {asset.id: asset.category for asset in self.catalogue.assets}
        additions = (
            Addition(
                kind="asset",
                name=substitute.stands_for,
                category=categories.get(substitute.asset),
            )
            for substitute in substitutes
        )
        return tuple({addition.name: addition for addition in additions}.values())


def _default_reason(keep: bool, lacks: Sequence[Addition]) -> str:
    """Return a reason for a decision whose model gave none."""
    if keep:
        return "the model says that it can be shown"
    if lacks:
        return f"missing: {', '.join(lack.words for lack in lacks)}"
    return "no reason was given"
