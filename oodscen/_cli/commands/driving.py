"""The command that runs driving stacks in a study's scenes."""

import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from oodscen._cli.commands.completion import ComponentName
from oodscen._cli.numbers import FiniteRange
from oodscen._cli.options import json_option
from oodscen._cli.output import say
from oodscen._cli.paths import PathName
from oodscen._cli.progress import tracked

if TYPE_CHECKING:
    from oodscen.data._drive_result import DriveResult
    from oodscen.judging._drive_board import DriveRate, DriveRow, Pairing
    from oodscen.judging._leaderboard.rows import Estimate
    from oodscen.study._study import Study

_LISTED = 5
"""Maximum number of failed drives that are listed."""


@click.command()
@click.argument("out", type=PathName(exists=True, file_okay=False, path_type=Path))
@click.option(
    "--driver",
    "drivers",
    type=ComponentName("driver"),
    multiple=True,
    help="Driver: rule-based, r157 (the careful human driver of UN Regulation 157), rss, the id of an "
    "action (stop), or a module:attr that creates one; repeatable.  [default: rule-based]",
)
@click.option("--limit", type=click.IntRange(min=1), help="Drive at most this many scenes.")
@click.option(
    "--workers",
    type=click.IntRange(0, 256),
    default=1,
    show_default=True,
    help="Processes in which the drivers run; 0 for this process, for debuggers.",
)
@click.option(
    "--time-limit",
    type=FiniteRange(min=0, min_open=True),
    metavar="SECONDS",
    help="Fail a scene whose drives, with its twin's, take longer.",
)
@json_option
def drive(
    out: Path,
    drivers: tuple[str, ...],
    limit: int | None,
    workers: int,
    time_limit: float | None,
    as_json: bool,
) -> None:
    """Run driving stacks in the scenes and twins of the study in the folder OUT.

    Writes drives.jsonl, prints the results of all drivers in it and updates the report. The exit code is 1 if a
    driver named here failed on an item; a collision is not a failure. A command that is ended keeps the drives that
    have ended.
    """
    from oodscen._pipeline.drives import drive_all
    from oodscen.data._pairing import scene_of
    from oodscen.judging._drive_board import drive_board
    from oodscen.report._render import write_report
    from oodscen.study._stale import refuse_stale
    from oodscen.study._study import Study

    study = Study.open(out.absolute())  # A stack may change the working folder.
    click.get_current_context().with_resource(study.store.writing())
    scenes = study.scenes
    refuse_stale(study, study.episodes, scenes)
    chosen = scenes[:limit]
    names = tuple(dict.fromkeys(drivers)) or ("rule-based",)
    simulator, seed = study.config.simulator, study.config.seed
    drives = drive_all(names, chosen, simulator, seed, workers=workers, time_limit_s=time_limit)
    earlier = study.drives
    results = _save_results(study, tracked(drives, "drive", len(names) * len(chosen)))
    board = drive_board(results, study.scenarios, seed=seed)
    page = write_report(study)
    if as_json:
        say(json.dumps([row.model_dump(mode="json") for row in board.rows], indent=2))
    else:
        lines = [line for row in board.rows for line in _row_lines(row)]
        say("\n".join([*lines, *board.remarks()]))
        say(f"report: {page.resolve()}")
    scene_ids = {scene.id for scene in chosen}
    failures = [
        result
        for result in results
        if result.status == "failed"
        and result.driver in names
        and scene_of(result.scene_id) in scene_ids
    ]
    for failure in failures[:_LISTED]:
        say(f"{failure.id}: {failure.error or failure.error_type}", err=True)
    if len(failures) > _LISTED:
        say(f"... and {len(failures) - _LISTED} more in drives.jsonl", err=True)
    dropped = {result.id for result in earlier} - {result.id for result in results}
    if dropped:
        say(
            f"{len(dropped)} earlier results are dropped, because their scenes have changed",
            err=True,
        )
    sys.exit(bool(failures))


def _save_results(
    study: "Study", batches: "Iterable[Sequence[DriveResult]]"
) -> "Sequence[DriveResult]":
    """Append results to the study's as they come, then put all in order and return them.

    The end of the command, in whatever way, loses none of those before it.
    """
    from oodscen.judging._drive_board import current_results

    scenes = study.scenes
    by_id = {result.id: result for result in current_results(study.drives, scenes)}
    has_driven = False
    try:
        for batch in batches:
            for result in batch:
                study.store.append("drives.jsonl", result)
                by_id[result.id] = result
            has_driven = True
    except BaseException:
        if has_driven:
            study.store.write_lines("drives.jsonl", current_results(by_id.values(), scenes))
        raise
    results = current_results(by_id.values(), scenes)
    study.store.write_lines("drives.jsonl", results)
    return results


def _row_lines(row: "DriveRow") -> Iterator[str]:
    """Yield a few lines about one driver's results in the scenes, or in the twins."""
    from oodscen.judging._drive_board import CRITICAL_TTC_S

    shares, means = row.shares, row.means
    inconclusive = f", {row.inconclusive} inconclusive" if row.inconclusive else ""
    yield (
        f"{row.driver}, {row.kind}: {row.passed} of {row.n} passed{_interval(shares['passed'])}, "
        f"{row.collisions} collisions{_interval(shares['collisions'])}, "
        f"{row.off_road} off the road, {row.failed} failed{inconclusive}"
    )
    yield (
        f"  means: least TTC {_mean(means['min_ttc_s'], ' s')}, "
        f"least headway {_mean(means['min_headway_s'], ' s')}, "
        f"hardest braking {_mean(means['peak_deceleration'], ' m/s2')}, "
        f"peak jerk {_mean(means['peak_jerk'], ' m/s3')}, "
        f"progress {_mean(means['progress'], '', form='.0%')}"
    )
    needless = shares.get("needless")
    braking = f"; needless braking in {_share(needless)}" if needless else ""
    yield f"  a collision or a TTC below {CRITICAL_TTC_S} s in {_share(shares['critical'])}{braking}"
    if row.paired is not None and row.paired.n:
        yield _pairs_line(row.paired)


def _pairs_line(pairs: "Pairing") -> str:
    both_right, test = pairs.drives_and_passes, pairs.against_rule_based
    line = (
        f"  of {pairs.n} pairs {pairs.both} passed both, {pairs.twin_only} only the twin, "
        f"{pairs.scene_only} only the scene; drives and passes: {both_right.hits}{_interval(both_right)}"
    )
    if test:
        line += (
            f", {100 * test.difference:+.0f} points against rule-based (p {test.p_clustered:.3f})"
        )
    return line


def _share(share: "DriveRate") -> str:
    return f"{share.hits} of {share.n}{_interval(share)}"


def _interval(share: "DriveRate") -> str:
    return f" [{share.interval.low:.0%}, {share.interval.high:.0%}]" if share.interval else ""


def _mean(mean: "Estimate", unit: str, *, form: str = ".1f") -> str:
    if mean.value is None:
        return "-"
    text = f"{mean.value:{form}}{unit}"
    interval = mean.interval
    return text + (f" [{interval.low:{form}}, {interval.high:{form}}]" if interval else "")
