"""Commands about a whole study: run it, judge models on it, report on it."""

import json
import os
import sys
from pathlib import Path
from typing import Any

import click

from oodscen import _paper as paper
from oodscen._cli.numbers import FINITE
from oodscen._cli.options import (
    extras_options,
    json_option,
    judging_options,
    limit_options,
    limits_from,
    llm_options,
    picture_options,
    red_options,
    seed_option,
    simulator_option,
    style_option,
)
from oodscen._cli.output import bars, estimated, left_out, say, standings, summary
from oodscen._cli.paths import READABLE, PathName
from oodscen._registry import DEFAULT_ENCODER
from oodscen.errors import UsageError


@click.command()
@click.argument("out", type=PathName(file_okay=False, path_type=Path))
@llm_options
@click.option("--red-llm", help="Model that imagines scenarios.  [default: --llm]")
@click.option(
    "--context",
    type=click.IntRange(min=2_048),
    help="Context window of --llm in tokens, e.g. 4096; longer questions are shortened.",
)
@click.option("--fallback", help="Model to ask if the others give no answer.")
@click.option("--vlm", "vlms", multiple=True, help="Vision-language model to judge; repeatable.")
@judging_options
@limit_options
@simulator_option
@click.option(
    "--catalogue",
    "catalogues",
    multiple=True,
    metavar="NAME|FILE",
    help="Catalogue to compare with the simulator's; repeatable.  [default: carla-0.9.16 with the built-in author]",
)
@click.option(
    "--encoder",
    default=DEFAULT_ENCODER,
    show_default=True,
    help="Text encoder: a registered name, or module:attr.",
)
@click.option(
    "--baseline",
    type=READABLE,
    help="Texts of ordinary driving: lines, JSONL, CSV or JSON.  [default: the shipped corpus]",
)
@click.option(
    "--nodes",
    type=click.IntRange(12, 2_000),
    help=f"Size of the initial tree.  [default: {paper.NODES['initial']}]",
)
@click.option(
    "--iterations",
    type=click.IntRange(0, 100_000),
    help=f"Rounds of red teaming.  [default: {paper.ITERATIONS}]",
)
@click.option(
    "--red-budget",
    type=click.IntRange(min=0),
    help="Maximum number of model calls for red teaming.",
)
@red_options
@click.option(
    "--per-path",
    type=click.IntRange(1, 999),
    help=f"Texts per simulatable path.  [default: {paper.PER_PATH}]",
)
@click.option(
    "--set",
    "sets",
    multiple=True,
    type=click.IntRange(min=1),
    help="Size of a text set from the diverse tree; repeatable.  [default: 10, 100, 1000 if built-in]",
)
@style_option
@click.option(
    "--candidates",
    type=click.IntRange(1, 100),
    help="Texts written per text kept; the most diverse are kept.  [default: 1]",
)
@click.option(
    "--twins/--no-twins",
    default=None,
    help="Write the ordinary twin of every text.  [default: only with the built-in author]",
)
@click.option("--max-paths", type=click.IntRange(min=1), help="Simulate at most this many paths.")
@click.option(
    "--band",
    nargs=2,
    type=FINITE,
    metavar="LO HI",
    help="Stage only texts whose OOD-ness lies between these values.",
)
@click.option(
    "--workers",
    type=click.IntRange(1, 256),
    help="Simulation processes.  [default: number of CPUs]",
)
@extras_options
@picture_options
@seed_option
@click.option("--quick", is_flag=True, help="Run a small but complete study in seconds.")
@click.option("--retry-failed", is_flag=True, help="Also redo items whose answers were invalid.")
@click.option(
    "--dry-run",
    is_flag=True,
    help="Check the options and estimate calls, tokens and cost, without asking a model.",
)
@json_option
def run(
    out: Path,
    quick: bool,
    workers: int | None,
    open_loop: bool,
    as_json: bool,
    traces: bool,
    annotations: bool,
    video: Any,
    retry_failed: bool,
    dry_run: bool,
    protocol: str,
    **choices: Any,
) -> None:
    """Run the whole pipeline into the folder OUT, or continue a stopped run.

    Models judged by earlier runs of `oodscen evaluate` are kept. The exit code is 1 if items failed, and 3 if
    a cap or an unreachable server stopped the run; run the same command to continue.
    """
    from oodscen._pipeline import Extras, RunOptions, estimate, run_study
    from oodscen.llm._accounting import Ledger
    from oodscen.study._config import StudyConfig
    from oodscen.study._study import Study

    limits = limits_from(choices)
    given = {name: value for name, value in choices.items() if value not in (None, ())}
    if "baseline" in given:
        given["baseline"] = str(given["baseline"])
    given["closed_loop"] = not open_loop
    given["protocols"] = ("ours", "paper") if protocol == "paper" else ("ours",)
    if quick:
        given = {**StudyConfig.quick().model_dump(), **given}
    config = StudyConfig.parse(given)
    before = Study(out)
    if before.store.has("study.json"):
        config = config.judging_too(before.config)
    if dry_run:
        rows = estimate(out, config, RunOptions(workers=workers or 1, limits=limits))
        click.echo(json.dumps([r.model_dump() for r in rows]) if as_json else estimated(rows))
        return
    ledger = Ledger()
    with bars(ledger) as progress:
        study = run_study(
            out,
            config,
            workers=workers or os.cpu_count() or 1,
            progress=progress,
            extras=Extras(traces, annotations, video),
            limits=limits,
            ledger=ledger,
            retry=retry_failed,
        )
    info = study.info
    if as_json:
        click.echo(json.dumps(info, indent=2))
    else:
        say(summary(info))
        for line in left_out(study.verdicts):
            say(line, err=True)
        click.echo(f"report: {(study.folder / 'report.html').resolve()}")
    if info["status"] != "success":
        sys.exit(1)


@click.command()
@click.argument("out", type=PathName(exists=True, file_okay=False, path_type=Path))
@click.option("--vlm", "vlms", multiple=True, help="Vision-language model to judge; repeatable.")
@click.option(
    "--drop",
    "dropped",
    multiple=True,
    metavar="MODEL",
    help="Remove a judged model from the study first; repeatable.",
)
@judging_options
@click.option(
    "--api-base",
    help="Address of an OpenAI-compatible server for the models named here.  [default: the study's]",
)
@click.option("--retry-failed", is_flag=True, help="Ask again where the last answer was unusable.")
@limit_options
@json_option
def evaluate(
    out: Path,
    vlms: tuple[str, ...],
    dropped: tuple[str, ...],
    protocol: str,
    judge: str | None,
    api_base: str | None,
    retry_failed: bool,
    as_json: bool,
    **choices: Any,
) -> None:
    """Judge more vision-language models on the study in the folder OUT.

    Prints the leaderboard, or leaderboard.json with --json. New items are asked first, then unanswered items
    of all models. If a model is given up, only its own items are lost. --drop alone asks no model. --judge scores
    the open answers of all models, including earlier ones. The exit code is 1 if a model judged here left an item
    without a usable answer.
    """
    from oodscen._pipeline import run_study
    from oodscen._pipeline.dropping import drop_models
    from oodscen.judging._leaderboard.leaderboard import Leaderboard
    from oodscen.study._config import StudyConfig
    from oodscen.study._study import Study

    before = Study.open(out)
    click.get_current_context().with_resource(before.store.writing())
    if not vlms and not dropped and not judge:
        raise UsageError(
            "name a model to judge (--vlm MODEL), to remove (--drop MODEL), or to score open answers "
            "(--judge MODEL)"
        )
    for name, count in drop_models(before, dropped).items() if dropped else ():
        kept = "its answers stay in answers.jsonl and are used if it is judged again"
        say(f"{name} is taken out with {count} verdicts; {kept}", err=True)
    config, known = before.config, {verdict.model for verdict in before.verdicts}
    changes = {
        "vlms": vlms,
        "protocols": (protocol,),
        "judge": judge,
        "servers": dict.fromkeys(filter(None, (*vlms, judge)), api_base) if api_base else {},
    }
    limits = limits_from(choices)
    study = before
    if vlms or judge:
        with bars() as progress:
            study = run_study(
                out,
                StudyConfig.parse(config.model_dump() | changes).judging_too(config),
                progress=progress,
                limits=limits,
                workers=os.cpu_count() or 1,
                retry=retry_failed,
            )
    board = Leaderboard.load(study.folder / "leaderboard.json")
    if as_json:
        click.echo(board.model_dump_json(indent=2))
    else:
        say(standings(board))
        click.echo(f"report: {(study.folder / 'report.html').resolve()}")
    verdicts = study.verdicts
    for line in left_out(verdicts):
        say(line, err=True)
    here = {verdict.model for verdict in verdicts} - (known - set(vlms))
    sys.exit(any(one.status == "failed" and one.model in here for one in verdicts))


@click.command()
@click.argument("out", type=PathName(exists=True, file_okay=False, path_type=Path))
def report(out: Path) -> None:
    """Rewrite the report of the study in the folder OUT."""
    from oodscen.report._render import write_report
    from oodscen.study._study import Study

    click.echo(str(write_report(Study.open(out)).resolve()))
