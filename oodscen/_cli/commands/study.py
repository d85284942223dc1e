"""Commands about a whole study: run it, report on it, put its questions to a person."""

import json
import os
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from oodscen import _paper as paper
from oodscen._cli.commands.completion import ComponentName
from oodscen._cli.configuration import RUN_SECTIONS, config_option
from oodscen._cli.help import SectionedCommand
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
    refuse_idle,
    refuse_idle_in_open_loop,
    refuse_idle_prices,
    require_option,
    rollout_options,
    seed_option,
    simulator_option,
    study_rear_view_option,
    style_option,
)
from oodscen._cli.output import say, write
from oodscen._cli.paths import READABLE, OutputName, PathName
from oodscen._cli.progress import bars
from oodscen._cli.summaries import estimated, exit_code, graded, left_out, summary
from oodscen._entry_points import is_builtin
from oodscen._io.files import is_written_through
from oodscen._io.study_files import QUIZ, refuse_own
from oodscen._registry import DEFAULT_ENCODER
from oodscen.errors import AnswerError, UsageError

if TYPE_CHECKING:
    from oodscen.study._config import StudyConfig


@click.command(cls=SectionedCommand, sections=RUN_SECTIONS)
@click.argument("out", type=PathName(file_okay=False, path_type=Path))
@config_option
@llm_options
@click.option("--red-llm", help="Model that imagines scenarios.  [default: --llm]")
@click.option(
    "--context",
    type=click.IntRange(min=4_096),
    help="Context window of --llm in tokens, e.g. 8192; longer questions are shortened.",
)
@click.option("--fallback", help="Model to ask if the others give no answer at all.")
@click.option(
    "--rarity-llm", help="Model that also estimates the rarity of the texts.  [default: none]"
)
@click.option(
    "--recogniser",
    help="Vision model that names made things without their captions; what it does not name is dropped.  "
    "[default: none]",
)
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
    type=ComponentName("encoder"),
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
    "--tree",
    type=PathName(dir_okay=False, path_type=Path),
    help="Tree to begin with, as `oodscen grow`, `tree` and `redteam` write it; a begun study needs it no more.  "
    "[default: --llm grows one]",
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
    help="Size of a text set from the diverse tree; repeatable.  [default: 10, 100, 1000 if built-in, without --tree]",
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
@click.option(
    "--demands/--no-demands",
    default=None,
    help="Run an ordinary demand beside every scene: a queue, a red light ...  [default: --demands]",
)
@click.option(
    "--made/--no-made",
    default=None,
    help="Let the model design things that the simulator lacks, or keep to its catalogue.  [default: only "
    "with a model other than the built-in author, if the simulator draws props]",
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
@rollout_options
@click.option(
    "--frames",
    type=click.IntRange(3, 8),
    help="Frames of a drive, at even distances in time.  [default: 3]",
)
@seed_option
@click.option("--quick", is_flag=True, help="Run a small but complete study, in a minute or two.")
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
    without_pictures: bool,
    tree: Path | None,
    **choices: Any,
) -> None:
    """Run the whole pipeline into the folder OUT, or continue a stopped run.

    `oodscen init` writes a file for --config, which can hold every option; options given here win.

    Models judged by earlier runs of `oodscen evaluate` are kept. The exit code is 1 if items failed, and 3 if
    a cap or an unreachable server stopped the run; run the same command to continue.
    """
    from oodscen._pipeline import Outputs, RunOptions, estimate, run_study
    from oodscen.llm._accounting import Ledger
    from oodscen.study._study import Study
    from oodscen.tree._scenario_tree import ScenarioTree

    _refuse_idle_options(choices, open_loop=open_loop, dry_run=dry_run, has_tree=tree is not None)
    choices["closed_loop"] = not open_loop
    choices["protocols"] = ("ours", "paper") if protocol == "paper" else ("ours",)
    if without_pictures:
        choices["withheld"] = choices["vlms"]
    limits = limits_from(choices)
    before = Study(out)
    is_new = not before.store.has("study.json")
    given_tree = None
    choices["tree"] = None if is_new else before.config.tree
    is_held = choices["tree"] is not None and before.store.holds("tree.initial.json")
    if tree is not None and (tree.exists() or not is_held):
        given_tree = ScenarioTree.load(tree)
        choices["tree"] = given_tree.digest()
    config = _config(choices, quick, None if is_new else before.config)
    refuse_idle_prices(limits, config.models, config.servers)
    if is_new:
        _tell_outlook(config.simulator)
    if dry_run:
        with bars() as progress:
            options = RunOptions(
                workers=workers or 1, limits=limits, progress=progress, tree=given_tree
            )
            rows = estimate(out, config, options)
        say(json.dumps([r.model_dump() for r in rows]) if as_json else estimated(rows))
        return
    ledger = Ledger()
    try:
        with bars(ledger) as progress:
            study = run_study(
                out,
                config,
                workers=workers or os.cpu_count() or 1,
                progress=progress,
                outputs=Outputs(traces, annotations, video),
                limits=limits,
                ledger=ledger,
                tree=given_tree,
                retry=retry_failed,
            )
    except AnswerError:
        say(
            "the same command finds these answers in the study again; --retry-failed asks anew",
            err=True,
        )
        raise
    info = study.info
    if as_json:
        say(json.dumps(info, indent=2))
    else:
        say(summary(info))
        for line in left_out(study.verdicts):
            say(line, err=True)
        say(f"report: {(study.folder / 'report.html').resolve()}")
    if info["status"] != "success":
        sys.exit(1)


def _refuse_idle_options(
    choices: dict[str, Any], *, open_loop: bool, dry_run: bool, has_tree: bool
) -> None:
    """Refuse options that would do nothing beside the others."""
    if open_loop:
        refuse_idle_in_open_loop()
    if not choices["vlms"]:
        refuse_idle("without --vlm", "without_pictures")
    if choices["made"] is False or (choices["made"] is None and is_builtin(choices["llm"])):
        refuse_idle("unless things are made (--made)", "recogniser")
    if is_builtin(choices["llm"]) and is_builtin(choices["red_llm"] or choices["llm"]):
        refuse_idle("on the built-in author, which has no context window", "context")
    if choices["encoder"].casefold() == "none":
        raise UsageError(
            "a study measures its texts and needs an encoder; `none` is for the commands of single stages"
        )
    if has_tree:
        refuse_idle("with --tree, which gives the initial tree", "nodes")
    if dry_run:
        refuse_idle("with --dry-run, which counts what was never asked", "retry_failed")


def _config(choices: dict[str, Any], quick: bool, before: "StudyConfig | None") -> "StudyConfig":
    """Return the configuration that the options choose, with the judged models of `before`."""
    from oodscen.study._config import StudyConfig

    given = {name: value for name, value in choices.items() if value not in (None, ())}
    if "baseline" in given:
        given["baseline"] = str(given["baseline"])
    small = StudyConfig.quick().model_dump() if quick else {}
    if given.get("tree"):
        small["sets"] = None
    config = StudyConfig.parse({**small, **given})
    return config if before is None else config.judging_too(before, set(given))


def _tell_outlook(simulator: str) -> None:
    """Say before the work if the simulator can show less than half of what is known."""
    from oodscen._doctor import outlook

    line, is_little = outlook(simulator)
    if is_little:
        more = "other branches are dropped, and restore.json ranks what would bring them back"
        say(f"{simulator}: {line}; {more}", err=True)


@click.command()
@click.argument("out", type=PathName(exists=True, file_okay=False, path_type=Path))
@require_option
def report(out: Path, required: str | None) -> None:
    """Rewrite the report of the study in the folder OUT, with the grades of a requirement if one is given."""
    from oodscen.study._study import Study

    study = Study.open(out)
    write(None, str(study.write_report(required, warn=partial(say, err=True)).resolve()))
    if required is not None:
        grades = study.requirements(required)
        say(graded(grades))
        sys.exit(exit_code(grades))


@click.command()
@click.argument("out", type=PathName(exists=True, file_okay=False, path_type=Path))
@click.option(
    "-o", "--out", "file", type=OutputName(), help="File to write.  [default: quiz.html in OUT]"
)
@click.option(
    "--scenes",
    type=click.IntRange(1, 1_000),
    default=20,
    show_default=True,
    help="Maximum number of scenes; each comes with its ordinary drives.",
)
@study_rear_view_option
def quiz(out: Path, file: Path | None, scenes: int, rear_view: bool | None) -> None:
    """Write a page that puts the questions of the study in the folder OUT to a person.

    The page needs no network and holds no answers. It saves a file that `oodscen evaluate OUT --answers FILE`
    takes as the row human:NAME.
    """
    from oodscen._pipeline import RunOptions
    from oodscen._pipeline.answering import take_rear_views
    from oodscen.report._quiz import draw_drives, write_quiz
    from oodscen.study._study import Study

    if file is not None and not is_written_through(file):
        refuse_own(file, but=QUIZ)
    study = Study.open(out)
    shows_rear = study.config.rear_view if rear_view is None else rear_view
    if shows_rear:
        drives = [drive.episode for drive in draw_drives(study, scenes)]
        with bars() as progress:
            options = RunOptions(workers=os.cpu_count() or 1, progress=progress)
            take_rear_views(study, drives, options)
    target = write_quiz(study, file, scenes=scenes, rear_view=shows_rear)
    write(None, str(target.resolve()))
