"""The command that prunes a tree for one simulator, or compares several."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from oodscen._cli.options import (
    json_option,
    llm_options,
    out_option,
    refuse_idle,
    refuse_idle_server,
    seed_option,
    simulator_option,
)
from oodscen._cli.output import if_stopped, say, write, write_lines
from oodscen._cli.paths import READABLE, FileCommand, OutputName
from oodscen._cli.progress import tracked
from oodscen.errors import UsageError

if TYPE_CHECKING:
    from oodscen.data._catalogue import Catalogue
    from oodscen.llm._accounting import Ledger
    from oodscen.protocols import LLM
    from oodscen.stages._prune.decisions import PruneDecision
    from oodscen.tree._scenario_tree import ScenarioTree


@click.command(cls=FileCommand)
@click.argument("tree", type=READABLE)
@llm_options
@seed_option
@simulator_option
@click.option(
    "--catalogue",
    "catalogues",
    multiple=True,
    metavar="NAME|FILE",
    help="Catalogue to prune for instead of a simulator's: a name such as carla-0.9.16, or a JSON file; several are compared.",
)
@click.option("--exact", is_flag=True, help="Drop branches that need substitute assets.")
@click.option(
    "--decisions", type=OutputName(), help="File for the decision and reason of every node."
)
@click.option(
    "--restore",
    type=OutputName(),
    help="File for the ranked additions that would restore dropped branches.",
)
@json_option
@out_option
def prune(
    tree: Path,
    llm: str,
    api_base: str | None,
    seed: int,
    simulator: str,
    catalogues: tuple[str, ...],
    exact: bool,
    decisions: Path | None,
    restore: Path | None,
    as_json: bool,
    out: Path | None,
) -> None:
    """Prune the tree in the file TREE to what a simulator can show.

    Writes the simulatable tree, and a summary to standard error. Branches that need substitute assets are kept
    unless --exact is given; `oodscen run` always drops them. With several --catalogue options, writes a
    comparison of the catalogues instead, as a table or with --json as JSON. Branches that the model did not
    judge are reported on standard error and dropped; the exit code is then 1. Stopped early, it writes the decisions
    made so far, and no tree.
    """
    from oodscen import ScenarioTree, make_llm
    from oodscen._registry import make_catalogue
    from oodscen.llm._accounting import Ledger
    from oodscen.stages._prune.decisions import all_decisions, apply_decisions
    from oodscen.stages._prune.restoration import restoration
    from oodscen.stages._prune.side_by_side import compare

    if catalogues:
        refuse_idle("with --catalogue", "simulator")
    if len(set(catalogues)) < 2:
        refuse_idle("with a single catalogue, for which a tree is written", "as_json")
    if twice := [name for name in dict.fromkeys(catalogues) if catalogues.count(name) > 1]:
        raise UsageError(
            f"--catalogue {twice[0]} is given twice; a comparison needs different catalogues"
        )
    refuse_idle_server(llm)
    grown = ScenarioTree.load(tree)
    ledger = Ledger()
    model = make_llm(llm, seed=seed, api_base=api_base, log=ledger.add)
    offered = {name: make_catalogue(name) for name in catalogues or (simulator,)}
    if len(offered) > 1:
        if decisions or restore:
            raise UsageError(
                "--decisions and --restore need a single catalogue; for several, use --json"
            )
        judged = {
            name: list(_judged(model, one, grown, exact, ledger)) for name, one in offered.items()
        }
        comparison = compare(grown, offered, judged)
        words = comparison.model_dump_json(indent=2) if as_json else str(comparison)
        say(words) if out is None else write(out, words)
        sys.exit(any(tally.failed for tally in comparison.tallies))
    ((name, catalogue),) = offered.items()
    answers: list[PruneDecision] = []

    def save() -> None:
        if decisions is not None:
            write_lines(decisions, answers)

    with if_stopped(answers, save):
        answers.extend(_judged(model, catalogue, grown, exact, ledger))
    if decisions is not None:
        write_lines(decisions, all_decisions(grown, answers))
    if restore is not None:
        write(restore, restoration(answers).to_json())
    write(out, apply_decisions(grown, answers).to_json())
    (tally,) = compare(grown, offered, {name: answers}).tallies
    say(str(tally), err=True)
    sys.exit(bool(tally.failed))


def _judged(
    model: "LLM", catalogue: "Catalogue", tree: "ScenarioTree", exact: bool, ledger: "Ledger"
) -> "Iterator[PruneDecision]":
    """Yield the decision on every leaf as it is made, and report those that failed."""
    from oodscen import Pruner

    pruner = Pruner(model, catalogue, substitutes=not exact)
    for decision in tracked(
        pruner.decisions(tree), f"prune {pruner.name}", len(tree.leaves), ledger
    ):
        if decision.status == "failed":
            say(f"{decision.id}: {decision.error}", err=True)
        yield decision
