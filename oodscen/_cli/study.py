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
    llm_options,
    picture_options,
    red_options,
    seed_option,
    simulator_option,
    style_option,
    traffic_from,
    traffic_options,
)
from oodscen._cli.output import bars, estimated, left_out, say, standings, summary
from oodscen._cli.paths import READABLE, PathName
from oodscen._registry import DEFAULT_ENCODER
from oodscen.errors import UsageError


@click.command()
@click.argument("out", type=PathName(file_okay=False, path_type=Path))
@llm_options
@click.option("--red-llm", help="Model that imagines scenarios; the same as --llm if left out.")
@click.option(
    "--context",
    type=click.IntRange(min=2_048),
    help="Tokens that --llm can read and write, e.g. 4096; longer questions are shortened.",
)
@click.option("--fallback", help="Model that is asked where the others give no answer.")
@click.option("--vlm", "vlms", multiple=True, help="Vision-language model to judge; repeatable.")
@judging_options
@traffic_options
@simulator_option
@click.option(
    "--catalogue",
    "catalogues",
    multiple=True,
    metavar="NAME|FILE",
    help="Prune for this catalogue too, to compare; repeatable.  [default: carla-0.9.16 if built-in]",
)
@click.option("--encoder", default=DEFAULT_ENCODER, show_default=True, help="Name, or module:attr.")
@click.option(
    "--baseline", type=READABLE, help="Ordinary-driving texts: lines, JSONL, CSV or JSON."
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
    "--red-budget", type=click.IntRange(min=0), help="Model calls of the red teaming, at most."
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
    help="Texts written for each that is kept; the most diverse are kept.  [default: 1]",
)
@click.option(
    "--twins/--no-twins",
    default=None,
    help="Write every text's ordinary twin.  [default: where the built-in author writes]",
)
@click.option("--max-paths", type=click.IntRange(min=1), help="Simulate at most this many paths.")
@click.option(
    "--band",
    nargs=2,
    type=FINITE,
    metavar="LO HI",
    help="Stage only texts whose OOD-ness lies in this band.",
)
@click.option(
    "--workers",
    type=click.IntRange(1, 256),
    help="Processes that simulate.  [default: number of CPUs]",
)
@extras_options
@picture_options
@seed_option
@click.option("--quick", is_flag=True, help="A complete small run in seconds.")
@click.option(
    "--retry-failed", is_flag=True, help="Do items again whose answers were never valid, too."
)
@click.option(
    "--dry-run",
    is_flag=True,
    help="Only say how many calls and tokens the run needs, at what cost.",
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
    """Run the whole paper into the folder OUT, or continue a run that stopped.

    Models that `oodscen evaluate` judged in OUT stay judged. The exit code is 1 if items failed, and 3 if the
    run was stopped by a cap or a server that is down; the same command continues it.
    """
    from oodscen._pipeline import Extras, estimate, run_study
    from oodscen.llm._accounting import Ledger
    from oodscen.study import Study, StudyConfig

    traffic = traffic_from(choices)
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
        rows = estimate(out, config, prices=traffic.prices)
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
            traffic=traffic,
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
@click.option("--vlm", "vlms", multiple=True, help="Vision-language model; repeatable.")
@click.option(
    "--drop",
    "dropped",
    multiple=True,
    metavar="MODEL",
    help="Take a judged model out of the study, before others are judged; repeatable.",
)
@judging_options
@click.option(
    "--api-base",
    help="Address of an OpenAI-compatible server for the models named here.  [default: the study's]",
)
@click.option(
    "--retry-failed", is_flag=True, help="Ask again where no usable answer came the last time."
)
@traffic_options
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
    """Judge further vision-language models on the study in the folder OUT.

    Prints the leaderboard, or leaderboard.json with --json. The exit code is 1 if a model judged here left an
    item without a usable answer. After all new items, items without an answer are asked again, those of
    earlier models included; a model that is given up costs its own items only. With --drop alone no model is
    asked. --judge scores the open aspects of all models and references, those of earlier runs too.
    """
    from oodscen._pipeline import run_study
    from oodscen._pipeline.dropping import drop_models
    from oodscen.judging._leaderboard.leaderboard import Leaderboard
    from oodscen.study import Study, StudyConfig

    before = Study.open(out)
    click.get_current_context().with_resource(before.store.writing())
    if not vlms and not dropped and not judge:
        raise UsageError(
            "name a model to judge (--vlm MODEL), one to take out (--drop MODEL), or who scores what was said "
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
    traffic = traffic_from(choices)
    study = before
    if vlms or judge:
        with bars() as progress:
            study = run_study(
                out,
                StudyConfig.parse(config.model_dump() | changes).judging_too(config),
                progress=progress,
                traffic=traffic,
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
    from oodscen.report import write_report
    from oodscen.study import Study

    click.echo(str(write_report(Study.open(out)).resolve()))
