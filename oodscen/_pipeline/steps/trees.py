"""The stages that make the trees: grow, red-team, prune."""

from oodscen._pipeline.context import Context
from oodscen._pipeline.steps.making import makes, pruner, with_made
from oodscen.errors import DataError, Issue, UsageError
from oodscen.stages._grow import TreeGrower
from oodscen.stages._prune.decisions import all_decisions, apply_decisions
from oodscen.stages._prune.restoration import restoration
from oodscen.stages._redteam.red_teamer import RedTeamer
from oodscen.stages._redteam.thresholds import TOKENS
from oodscen.study._rounds import rounds_on
from oodscen.tree._labels import CLASSES
from oodscen.tree._scenario_tree import ScenarioTree


def grow(run: Context) -> ScenarioTree:
    """Grow the initial tree, or take the given one."""
    if not run.store.holds("tree.initial.json"):
        run.store.write("tree.initial.json", _tree_text(_initial(run)))
    run.progress("grow", 1, 1)
    return run.study.tree("initial")


def check_given(run: Context) -> None:
    """Check that a study has the tree that it is to be given, and can begin with it.

    Raises:
        UsageError: If it has none.
        DataError: If it has no nodes, no path although red teaming adds none, or a situation directly below the root.
    """
    tree = run.options.tree
    if tree is None:
        if run.config.tree is not None and not run.store.holds("tree.initial.json"):
            raise UsageError(
                "the study has no tree.initial.json, and a tree is to be given: give it again (--tree)"
            )
        return
    inner = {node.parent for node in tree}
    roots = {node.id for node in tree if node.parent is None}
    loose = [node for node in tree if node.parent in roots and node.id not in inner]
    classes = {name.casefold() for name in CLASSES}
    issues = [
        Issue(
            node.id,
            f"{node.label!r} lies directly below the root; a situation needs a class above it",
        )
        for node in loose
        if node.label.casefold() not in classes
    ]
    if not issues and not (tree.paths or (len(tree) and run.config.iterations)):
        issues = [Issue("", "has no path, and red teaming adds none")]
    if issues:
        raise DataError(tree.noun, issues)


def _initial(run: Context) -> ScenarioTree:
    if run.config.tree is None:
        return TreeGrower(run.llm, nodes=run.config.nodes).run()
    assert run.options.tree is not None, "check_given has checked it"
    return run.options.tree


def redteam(run: Context, tree: ScenarioTree) -> ScenarioTree:
    """Grow the diverse tree, round by round.

    Every round after a missing one is played again; so is every round if the initial tree has changed.
    """
    total = run.config.iterations
    done = rounds_on(run.study, tree)
    # Later rounds build on a failed one, so only trailing failures can be played again.
    while done and run.is_again(done[-1].model_dump()):
        done.pop()
    run.store.write_lines("redteam.jsonl", done)
    run.progress("redteam", len(done), total)
    teamer = RedTeamer(
        run.llm,
        run.red_llm,
        iterations=total,
        closed_loop=run.config.closed_loop,
        encoder=run.encoder,
        catalogue=run.simulator.catalogue() if run.config.context is None else None,
        nearest=run.config.nearest,
        nearest_label=run.config.nearest_label,
        budget=run.config.red_budget,
        patience=run.config.red_patience,
        coverage=run.config.red_coverage,
        in_flight=run.config.in_flight,
        threads=run.models.threads(run.config.red_llm or run.config.llm),
        cancel=run.cancel,
        broadenings=run.config.broadenings,
        rarity=run.config.rarity,
        tokens=TOKENS if run.config.context is None else min(TOKENS, run.config.context // 2),
    )
    for item in teamer.rounds(tree, done) if teamer.stopped_by(done) is None else ():
        run.store.append("redteam.jsonl", item)
        done.append(item)
        run.progress("redteam", item.round, total)
    run.progress("redteam", len(done), len(done))
    run.store.write_lines("redteam.jsonl", done)
    diverse = tree.apply(*(edit for item in done for edit in item.edits))
    run.store.write("tree.diverse.json", _tree_text(diverse))
    return diverse


def prune(run: Context, tree: ScenarioTree) -> ScenarioTree:
    """Prune the tree to what the simulator's catalogue can show exactly.

    Branches that need substitutes are dropped as well: a scene must show what its text names.
    """
    total = len(tree.leaves)
    paths = tree.paths
    judgements = [item for item in run.study.decisions if paths.get(item.id) == item.path]
    judgements = [item for item in judgements if not run.is_again(item.model_dump())]
    run.store.write_lines("pruned.jsonl", judgements)
    run.progress("prune", len(judgements), total)
    judge = pruner(run, run.simulator.catalogue())
    for decision in judge.decisions(tree, [item.id for item in judgements]):
        run.store.append("pruned.jsonl", decision)
        judgements.append(decision)
        run.progress("prune", len(judgements), total)
    if makes(run):
        judgements = with_made(run, tree, judgements)
    decisions = all_decisions(tree, judgements)
    run.store.write_lines("pruned.jsonl", decisions)
    simulatable = apply_decisions(tree, judgements)
    run.store.write_lines("edits.jsonl", simulatable.edits)
    run.store.write("restore.json", restoration(decisions).to_json() + "\n")
    run.store.write("tree.simulatable.json", _tree_text(simulatable))
    return simulatable


def _tree_text(tree: ScenarioTree) -> str:
    return tree.to_json() + "\n"
