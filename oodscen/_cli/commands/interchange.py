"""Commands that take scenes and runs from other tools, and vary scenes: import, verdict, vary."""

import json
import sys
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from oodscen._cli.commands.completion import ComponentName
from oodscen._cli.options import (
    json_option,
    refuse_idle,
    refuse_idle_server,
    run_seed_option,
    seed_option,
    simulator_option,
)
from oodscen._cli.output import say
from oodscen._cli.paths import READABLE, PathName
from oodscen._cli.places import SceneSource, scenes_of
from oodscen._cli.progress import tracked
from oodscen._members import using
from oodscen._words.text import one_line, printable
from oodscen.data._catalogue import Catalogue
from oodscen.data._pairing import is_twin, kind_of, scene_of
from oodscen.data._scene import Scene
from oodscen.errors import OodscenError, UsageError

if TYPE_CHECKING:
    from oodscen.interchange._verdicts.verdict import PlayedVerdict

_PLACE = PathName(exists=True, path_type=Path)


@click.command("import")
@click.argument("files", metavar="FILE.xosc...", type=READABLE, nargs=-1, required=True)
@click.option(
    "--map", "road", help="Map of the catalogue, or .xodr file, in place of the file's own."
)
@click.option("--hazard", "hazards", multiple=True, help="Name of an unusual entity; repeatable.")
@click.option("--ego", help="Name of the entity that is the ego.")
@click.option(
    "--llm",
    type=ComponentName("llm"),
    help="Model that names the unusual entities of files of others, without --hazard.",
)
@click.option("--api-base", help="Address of an OpenAI-compatible server.")
@simulator_option
def import_(
    files: tuple[Path, ...],
    road: str | None,
    hazards: tuple[str, ...],
    ego: str | None,
    llm: str | None,
    api_base: str | None,
    simulator: str,
) -> None:
    """Read OpenSCENARIO XML files as scenes, one per line on standard output.

    What a scene cannot hold is listed on standard error with its line and element. A file that cannot be read is
    reported, and the exit code is then 1. An unchanged export gives back its scene: --map, --hazard and --ego are for
    files of others. Two files that would give scenes of one id are refused before anything is written.
    """
    from oodscen import make_llm, make_simulator
    from oodscen.interchange import read_openscenario

    if api_base is not None and llm is None:
        raise UsageError("--api-base is the address of a model; name it with --llm")
    if llm is not None:
        refuse_idle_server(llm)
    if hazards:
        refuse_idle("with --hazard", "llm")
    model = make_llm(llm, api_base=api_base) if llm is not None else None
    catalogue = make_simulator(simulator).catalogue()
    is_told = road is not None or bool(hazards) or ego is not None
    _check_files(files, catalogue, is_told=is_told)
    failed = 0
    for path in files:
        try:
            imported = read_openscenario(
                path, catalogue, road=road, hazards=hazards, ego=ego, llm=model
            )
        except OodscenError as error:
            say(str(error), err=True)
            failed += 1
            continue
        say(imported.scene.to_json())
        for issue in imported.omissions:
            say(f"{path}: {issue}", err=True)
    sys.exit(bool(failed))


def _check_files(files: Sequence[Path], catalogue: Catalogue, *, is_told: bool) -> None:
    """Refuse files that give scenes of one id, and unchanged exports if a map, a hazard or an ego is named.

    Raises:
        UsageError: Before a model is asked about any file, and before anything is written.
    """
    from oodscen.interchange._reading.scenario import foresee

    owners: dict[str, list[Path]] = {}
    exports: list[Path] = []
    for path in files:
        with suppress(OodscenError):  # It is reported when it is read.
            name, is_export = foresee(path, catalogue)
            owners.setdefault(name, []).append(path)
            exports += [path] if is_export else []
    for name, paths in owners.items():
        if len(paths) > 1:
            raise UsageError(
                f"{paths[0]} and {paths[1]} would both give a scene {name!r}; import them apart"
            )
    if is_told and exports:
        raise UsageError(
            f"{exports[0]} is an unchanged export, which gives back its scene with its own map, hazard and ego: "
            "import it without --map, --hazard and --ego"
        )


def _driver_name(ctx: click.Context, param: click.Parameter, value: str | None) -> str | None:
    """Return the name of a driver that played, which is not that of one that drives here."""
    from oodscen._entry_points import DRIVERS
    from oodscen.data._episode import ACTIONS

    if value is None:
        return None
    name = value.strip()
    if not name or name != printable(one_line(name)):
        raise click.BadParameter("is empty, or no plain line.", ctx, param)
    if name.lower() in {*DRIVERS, *ACTIONS}:
        raise click.BadParameter(f"{name!r} is a driver of `oodscen drive`.", ctx, param)
    return name


@click.command()
@click.argument("place", metavar="STUDY|SCENES", type=_PLACE)
@click.argument("files", metavar="POSES...", type=READABLE, nargs=-1, required=True)
@click.option(
    "--driver",
    callback=_driver_name,
    help="Name of what drove the ego; its results enter the study's table of drivers.",
)
@click.option(
    "--replace", is_flag=True, help="Replace the driver's earlier results of these scenes."
)
@simulator_option
@run_seed_option
@json_option
def verdict(
    place: Path,
    files: tuple[Path, ...],
    driver: str | None,
    replace: bool,
    simulator: str,
    seed: int | None,
    as_json: bool,
) -> None:
    """Judge runs that another player drove, by the poses that it wrote.

    Each file has the name of its scene or ordinary drive: SCENE.csv, SCENE.osi or SCENE.mcap. The exit code is 1 if a
    file could not be judged, or its run is inconclusive; a collision is not a failure.
    """
    from oodscen.interchange import verdict as judge
    from oodscen.study._stale import refuse_stale
    from oodscen.study._study import Study

    if not driver or not place.is_dir():
        refuse_idle("without --driver and a study, whose table it is for", "replace")
    names = Counter(path.stem for path in files)
    if driver and (twice := [name for name, count in names.items() if count > 1]):
        raise UsageError(f"{twice[0]} has several files; a driver has one result per scene")
    source = scenes_of(place, simulator)
    scenes, catalogue, facts = source.scenes, source.catalogue, source.facts
    seed = source.seed if seed is None else seed
    if driver and place.is_dir():
        study = Study.open(place)
        refuse_stale(study, study.episodes, scenes)
    by_id = {scene.id: scene for scene in (*scenes, *facts.demands.values())}
    verdicts: list[PlayedVerdict] = []
    failed = 0
    for path in files:
        try:
            scene = _scene_named(path.stem, by_id, source, seed)
            verdicts.append(judge(scene, path, catalogue, driver=driver or "played", seed=seed))
        except OodscenError as error:
            say(f"{path}: {error}", err=True)
            failed += 1
    if as_json:
        say(
            json.dumps(
                [played_verdict.model_dump(mode="json") for played_verdict in verdicts], indent=2
            )
        )
    else:
        for played_verdict in verdicts:
            say(_line(played_verdict))
    if driver and verdicts and place.is_dir():
        _enter(place, verdicts, replace)
    sys.exit(bool(failed) or any(played_verdict.inconclusive for played_verdict in verdicts))


@click.command()
@click.argument("place", metavar="STUDY|SCENES", type=_PLACE)
@click.option("--scene", "wanted", help="Vary only the scene with this id.")
@click.option(
    "-n",
    "count",
    type=click.IntRange(1, 100_000),
    default=10,
    show_default=True,
    help="Variants of each scene.",
)
@seed_option
@simulator_option
def vary(place: Path, wanted: str | None, count: int, seed: int, simulator: str) -> None:
    """Draw variants of scenes from the ranges of their parameters, one scene per line.

    Each variant is checked like any other scene, and against the claims of its text where a study has them. Ordinary
    demands are varied as well; twins beside their scenes are not, as `oodscen export` makes those of the variants. The
    exit code is 1 if some scene has fewer variants than asked for.
    """
    source = scenes_of(place, simulator)
    catalogue, facts = source.catalogue, source.facts
    by_id = {scene.id: scene for scene in (*source.scenes, *facts.demands.values())}
    if wanted is not None:
        scenes = [_scene_named(wanted, by_id, source, source.seed)]
    else:
        scenes = [one for one in by_id.values() if not (one.is_twin and scene_of(one.id) in by_id)]
        if twins := len(by_id) - len(scenes):
            say(f"{twins} twins are left out: `export` makes those of the variants", err=True)
    short = 0
    for scene in tracked(scenes, "vary", len(scenes)):
        claims = [] if scene.is_twin else facts.claims(scene)  # A twin is what its text is not.
        variants = scene.vary(catalogue, count, claims=claims, seed=seed)
        for variant in variants:
            say(variant.to_json())
        if len(variants) < count:
            if faults := scene.check(catalogue):
                say(f"{scene.id}: cannot be staged itself: {faults[0]}", err=True)
            say(f"{scene.id}: {len(variants)} of {count} variants can be staged", err=True)
            short += 1
    sys.exit(bool(short))


def _scene_named(name: str, by_id: dict[str, Scene], source: SceneSource, seed: int) -> Scene:
    """Return a scene or its ordinary drive; twins are made, as no file holds them."""
    from oodscen import make_simulator
    from oodscen.interchange._recording import ordinary_twin

    if name in by_id:
        return by_id[name]
    if is_twin(name) and (scene := by_id.get(scene_of(name))):
        with using(make_simulator(source.simulator)) as simulator:
            return ordinary_twin(scene, source.catalogue, seed=seed, simulator=simulator)
    raise UsageError(f"there is no scene {name!r}")


def _enter(place: Path, verdicts: "list[PlayedVerdict]", is_replacing: bool) -> None:
    """Enter the drives of scenes and twins into the study's table and write its report again.

    Raises:
        UsageError: If the table has other results of the driver for these scenes that are not to be replaced.
    """
    from oodscen._pipeline.playing import enter_played
    from oodscen.report._render import write_report
    from oodscen.study._study import Study

    study = Study.open(place)
    click.get_current_context().with_resource(study.store.writing())
    drives = [played.drive for played in verdicts if kind_of(played.scene_id) != "demand"]
    if left_out := len(verdicts) - len(drives):
        say(f"not in the table, which has scenes and twins only: demands ({left_out})", err=True)
    if drives:
        enter_played(study, drives, is_replacing=is_replacing)
        write_report(study)


def _line(played: "PlayedVerdict") -> str:
    decided = f"decision at {played.decision_s:.2f} s" if played.decision_fired else "no decision"
    notes = "".join(f"; {note}" for note in played.notes)
    outcome = played.outcome
    if outcome is None:
        return f"{played.scene_id}: {decided}, inconclusive: {played.inconclusive}{notes}"
    hit = f"touches {', '.join(outcome.contacts)}" if outcome.contacts else ""
    harm = hit or ("leaves the road" if outcome.off_road else "")
    harm = harm or ("drives past the red light" if outcome.ran_red else "safe")
    margin = "" if outcome.margin_m is None else f", margin {outcome.margin_m:.2f} m"
    return f"{played.scene_id}: {decided}, {harm}{margin}{notes}"
