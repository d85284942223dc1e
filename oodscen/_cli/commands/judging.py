"""Commands about what the scores of models are worth."""

import json
from pathlib import Path
from typing import Any

import click

from oodscen._cli.numbers import SHARE, FiniteRange
from oodscen._cli.options import json_option, refuse_idle
from oodscen._cli.output import say
from oodscen._cli.paths import PathName
from oodscen._io.study_files import AUDIT
from oodscen._numbers import MOST

_COUNT = click.IntRange(1, MOST)


@click.command()
@click.argument("first", type=SHARE)
@click.argument("second", type=SHARE)
@click.option("--unpaired", is_flag=True, help="The models are judged on different scenes.")
@click.option(
    "--agreement",
    type=FiniteRange(-1.0, 1.0),
    default=0.0,
    show_default=True,
    help="Correlation between the two models' results on the same scene.",
)
@click.option(
    "--power", "power_", type=SHARE, default=0.8, show_default=True, help="Required power."
)
@click.option("--alpha", type=SHARE, default=0.05, show_default=True, help="Significance level.")
@click.option(
    "--comparisons",
    type=_COUNT,
    default=1,
    show_default=True,
    help="Number of comparisons (Holm correction).",
)
@click.option("--per-path", type=_COUNT, default=10, show_default=True, help="Scenes per path.")
@click.option(
    "--icc",
    type=FiniteRange(0.0, 1.0),
    default=0.2,
    show_default=True,
    help="Intraclass correlation of the scenes of one path, 0 to 1.",
)
@click.option(
    "--scenes", type=click.IntRange(min=1), help="Print the power of this many scenes instead."
)
@json_option
def power(
    first: float,
    second: float,
    unpaired: bool,
    agreement: float,
    power_: float,
    alpha: float,
    comparisons: int,
    per_path: int,
    icc: float,
    scenes: int | None,
    as_json: bool,
) -> None:
    """Print the number of scenes needed to tell the success rates FIRST and SECOND apart, e.g. 0.66 0.51."""
    from oodscen.judging._leaderboard.power import distinct_percents, power_of, scenes_needed
    from oodscen.judging._rates_in_words import number_of

    if scenes is not None:
        refuse_idle("with --scenes, which prints the power of that many scenes", "power_")
    if unpaired:
        refuse_idle("with --unpaired", "agreement")
    design: dict[str, Any] = {
        "paired": not unpaired,
        "agreement": agreement,
        "alpha": alpha,
        "comparisons": comparisons,
        "per_path": per_path,
        "icc": icc,
    }
    if scenes is None:
        needed = scenes_needed(first, second, power=power_, **design)
        say(needed.model_dump_json(indent=2) if as_json else str(needed))
        return
    achieved = power_of(first, second, scenes, **design)
    if as_json:
        say(json.dumps({"scenes": scenes, "power": achieved}))
        return
    size = min(per_path, scenes)
    paths = f" in paths of {size} that correlate by {icc:g}" if size > 1 and icc else ""
    (percent,) = distinct_percents(achieved)
    say(f"{number_of(scenes, 'scene')}{paths} can show that difference with a power of {percent}")


@click.command()
@click.argument("out", type=PathName(exists=True, file_okay=False, path_type=Path))
@json_option
def audit(out: Path, as_json: bool) -> None:
    """Measure how well shortcuts tell rare from ordinary in the study in the folder OUT.

    Rules on what the simulator knows, simple classifiers on small pictures, sizes of files, map and weather
    learn on some paths and are tested on the others. Writes audit.json and the report. The best on bodies or
    pictures is the floor that a model has to beat in noticing.
    """
    from oodscen.data._base import canonical_json
    from oodscen.judging._shortcuts.audit import audit as audit_shortcuts
    from oodscen.report._render import write_report
    from oodscen.study._frames import frames_of
    from oodscen.study._stale import refuse_stale
    from oodscen.study._study import Study

    study = Study.open(out)
    with study.store.writing():
        episodes, scenes = study.episodes, study.scenes
        refuse_stale(study, episodes, scenes)
        for episode in episodes:
            frames_of(study.store, episode.frames, episode.file_sha256, study.config.camera)
        result = audit_shortcuts(
            episodes, scenes, study.scenarios, study.folder, seed=study.config.seed
        )
        study.store.write(AUDIT, canonical_json(result.model_dump(mode="json")) + "\n")
    write_report(study)
    say(result.model_dump_json(indent=2) if as_json else str(result))
