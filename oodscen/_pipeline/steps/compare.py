"""The stage that compares other simulators with the study's own."""

from oodscen._io.study_files import CATALOGUES
from oodscen._pipeline.context import Context
from oodscen.data._catalogue import Catalogue
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.pruner import Pruner
from oodscen.stages._prune.side_by_side import compare
from oodscen.tree._scenario_tree import ScenarioTree


def compare_catalogues(run: Context, tree: ScenarioTree) -> None:
    """Prune the diverse tree for other catalogues too, and store the comparison.

    Branches that only substitutes can show are kept and marked. The questions about the study's own simulator
    equal those of the pruning stage, so a recorded model is not asked them again.
    """
    catalogues = {run.config.simulator: run.simulator.catalogue(), **run.compared}
    if len(catalogues) == 1 or _is_compared(run, tree, catalogues):
        return
    total = len(catalogues) * len(tree.leaves)
    judged: dict[str, list[PruneDecision]] = {}
    done = 0
    for name, catalogue in catalogues.items():
        pruner = Pruner(
            run.llm, catalogue, threads=run.threads, cancel=run.cancel, context=run.config.context
        )
        judged[name] = []
        for decision in pruner.decisions(tree):
            judged[name].append(decision)
            done += 1
            run.progress("compare", done, total)
    run.store.write(CATALOGUES, compare(tree, catalogues, judged).to_json() + "\n")


def _is_compared(run: Context, tree: ScenarioTree, catalogues: dict[str, Catalogue]) -> bool:
    """Return whether a comparison of this tree and these catalogues is stored.

    One with leaves that failed counts unless they are retried.
    """
    if not run.store.holds(CATALOGUES):
        return False
    comparison = run.study.comparison
    if run.options.retry and any(tally.failed for tally in comparison.tallies):
        return False
    is_same = all(
        tally.catalogue_digest in ("", catalogues[tally.catalogue].digest())
        for tally in comparison.tallies
        if tally.catalogue in catalogues
    )
    return is_same and {line.id: line.path for line in comparison.lines} == tree.paths
