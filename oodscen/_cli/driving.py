"""The command that runs driving stacks in a study's scenes."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from oodscen._cli.completion import ComponentName
from oodscen._cli.numbers import FiniteRange
from oodscen._cli.options import json_option
from oodscen._cli.output import say
from oodscen._cli.paths import PathName
from oodscen._cli.progress import tracked

if TYPE_CHECKING:
    from oodscen.judging._drive_board import DriveRate, DriveRow
    from oodscen.judging._leaderboard.rows import Estimate

_SHOWN = 5
"""Failed drives that are named."""


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
    driver named here failed on an item; a collision is not a failure. An interrupted command keeps the drives that
    have ended.
    """
    from oodscen._pipeline.drives import drive_all
    from oodscen.data._pairing import scene_of
    from oodscen.judging._drive_board import current_results, drive_board
    from oodscen.report._render import write_report
    from oodscen.study._stale import refuse_stale
    from oodscen.study._study import Study

    study = Study.open(out.absolute())  # A stack may change the working folder.
    click.get_current_context().with_resource(study.store.writing())
    staged, scenarios = study.scenes, study.scenarios
    refuse_stale(study, study.episodes, staged)
    scenes = staged[:limit]
    names = drivers or ("rule-based",)
    before = study.drives
    found = {row.id: row for row in current_results(before, staged)}
    simulator, seed = study.config.simulator, study.config.seed
    drives = drive_all(names, scenes, simulator, seed, workers=workers, time_limit_s=time_limit)
    has_driven = False
    try:
        for results in tracked(drives, "drive", len(names) * len(scenes)):
            found.update((result.id, result) for result in results)
            has_driven = True
    except BaseException:
        if has_driven:
            study.store.write_lines("drives.jsonl", current_results(found.values(), staged))
        raise
    rows = current_results(found.values(), staged)
    board = drive_board(rows, scenarios, seed=study.config.seed)
    study.store.write_lines("drives.jsonl", rows)
    page = write_report(study)
    if as_json:
        say(json.dumps([row.model_dump(mode="json") for row in board.rows], indent=2))
    else:
        say("\n".join([*map(_line, board.rows), *board.remarks()]))
        say(f"report: {page.resolve()}")
    ran = {scene.id for scene in scenes}
    here = [row for row in rows if row.driver in names and scene_of(row.scene_id) in ran]
    failed = [row for row in here if row.status == "failed"]
    for row in failed[:_SHOWN]:
        say(f"{row.id}: {row.error or row.error_type}", err=True)
    if len(failed) > _SHOWN:
        say(f"... and {len(failed) - _SHOWN} more in drives.jsonl", err=True)
    if lost := len({drive_result.id for drive_result in before} - {row.id for row in rows}):
        say(f"{lost} earlier results are dropped, because their scenes have changed", err=True)
    sys.exit(bool(failed))


def _line(row: "DriveRow") -> str:
    """Summarise one driver's results in the scenes, or in the twins, in a few lines."""
    from oodscen.judging._drive_board import CRITICAL_TTC_S

    share, mean = row.shares, row.means
    critical, needless = share["critical"], share.get("needless")
    lines = [
        f"{row.driver}, {row.kind}: {row.passed} of {row.n} passed{_range(share['passed'])}, {row.collisions} "
        f"collisions{_range(share['collisions'])}, {row.off_road} off the road, {row.failed} failed"
        + (f", {row.inconclusive} inconclusive" if row.inconclusive else ""),
        f"  means: least TTC {_mean(mean['min_ttc_s'], ' s')}, least headway {_mean(mean['min_headway_s'], ' s')}, "
        f"hardest braking {_mean(mean['peak_deceleration'], ' m/s2')}, peak jerk {_mean(mean['peak_jerk'], ' m/s3')}, "
        f"progress {_mean(mean['progress'], '', percent=True)}",
        f"  a collision or a TTC below {CRITICAL_TTC_S} s in {_of(critical)}"
        + (f"; needless braking in {_of(needless)}" if needless else ""),
    ]
    if (pair := row.paired) is not None and pair.n:
        sound, test = pair.drives_and_passes, pair.against_rule_based
        pairs = (
            f"  of {pair.n} pairs {pair.both} passed both, {pair.twin_only} only the twin, {pair.scene_only} only the "
            f"scene; drives and passes: {sound.hits}{_range(sound)}"
        )
        if test:
            points = f"{100 * test.difference:+.0f} points"
            pairs += f", {points} against rule-based (p {test.p_clustered:.3f})"
        lines.append(pairs)
    return "\n".join(lines)


def _of(share: "DriveRate") -> str:
    return f"{share.hits} of {share.n}{_range(share)}"


def _range(share: "DriveRate") -> str:
    return f" [{share.interval.low:.0%}, {share.interval.high:.0%}]" if share.interval else ""


def _mean(mean: "Estimate", unit: str, *, percent: bool = False) -> str:
    if mean.value is None:
        return "-"
    form = ".0%" if percent else ".1f"
    between = mean.interval
    text = f"{mean.value:{form}}{unit}"
    return text + (f" [{between.low:{form}}, {between.high:{form}}]" if between else "")
