"""The command that lets driving stacks drive a study's scenes."""

import json
import sys
from pathlib import Path

import click

from oodscen.cli.options import json_option
from oodscen.cli.output import say


@click.command()
@click.argument("out", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option(
    "--driver",
    "drivers",
    multiple=True,
    help="rule-based, or module:attr that makes a driver; repeatable.  [default: rule-based]",
)
@click.option("--limit", type=click.IntRange(min=1), help="Drive at most this many scenes.")
@json_option
def drive(out: Path, drivers: tuple[str, ...], limit: int | None, as_json: bool) -> None:
    """Let driving stacks drive the scenes and twins of the study in the folder OUT.

    Writes drives.jsonl beside the other files, and prints what all drivers in it come to. The exit code is 1 if
    a driver named here failed on an item, which a collision is not.
    """
    from oodscen.judging.closed_loop import DriveResult, RuleBasedDriver
    from oodscen.judging.closed_loop import drive as drive_scenes
    from oodscen.registry import find, make_simulator
    from oodscen.study import Study
    from oodscen.twins import scene_of

    study = Study.open(out)
    scenes = study.scenes[:limit]
    names = drivers or ("rule-based",)
    makers = [(n, RuleBasedDriver if n == "rule-based" else find("driver", n)) for n in names]
    lines = {line["id"]: line for line in study.store.lines("drives.jsonl")}
    with make_simulator(study.config.simulator) as simulator:
        for name, make in makers:
            for result in drive_scenes(scenes, make, simulator, name=name, seed=study.config.seed):
                lines[result.id] = result.model_dump(mode="json")
    study.store.write_lines("drives.jsonl", lines.values())
    rows = [DriveResult.parse(line) for line in lines.values()]
    summary = [
        {
            "driver": name,
            "items": kind,
            "n": len(found),
            "passed": sum(row.passed for row in found),
            "collisions": sum(bool(row.collisions) for row in found),
            "off_road": sum(row.off_road for row in found),
            "failed": sum(row.status == "failed" for row in found),
        }
        for name in dict.fromkeys(row.driver for row in rows)
        for kind, is_twin in (("scenes", False), ("twins", True))
        for found in [[r for r in rows if r.driver == name and r.is_twin is is_twin]]
    ]
    if as_json:
        say(json.dumps(summary, indent=2))
        summary = []
    for row in summary:
        say(
            "{driver}, {items}: {passed} of {n} passed, {collisions} collisions, {off_road} off the "
            "road, {failed} failed".format(**row)
        )
    ran = {scene.id for scene in scenes}
    here = [row for row in rows if row.driver in names and scene_of(row.scene_id) in ran]
    sys.exit(any(row.status == "failed" for row in here))
