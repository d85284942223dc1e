"""Commands that exchange scenes with other tools: export, import, verdict, vary."""

import json
import os
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import starmap
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from oodscen._cli.completion import ComponentName
from oodscen._cli.exporting import claim_folder, refuse_clashes, require_extra
from oodscen._cli.options import (
    json_option,
    refuse_idle,
    refuse_idle_server,
    seed_option,
    simulator_option,
)
from oodscen._cli.output import say, write
from oodscen._cli.paths import READABLE, PathName
from oodscen._cli.places import KnownFacts, scenes_of, simulator_of
from oodscen._cli.progress import tracked
from oodscen._files import writing
from oodscen._members import using
from oodscen._processes import Processes
from oodscen._study_files import refuse_inside
from oodscen._text import one_line, printable
from oodscen.data._catalogue import Catalogue
from oodscen.data._episode import ACTIONS
from oodscen.data._pairing import is_twin, scene_of, twin_id
from oodscen.data._scene import Scene
from oodscen.errors import MissingExtra, OodscenError, UsageError

if TYPE_CHECKING:
    from oodscen.interchange._verdicts.verdict import PlayedVerdict

_PLACE = PathName(exists=True, path_type=Path)
_FOLDER = PathName(file_okay=False, path_type=Path)
_Written = tuple[int, list[str]]
_PART = 24
"""Number of scenes that a process writes in one go."""


@click.command()
@click.argument("place", metavar="STUDY|SCENES", type=_PLACE)
@click.option("-o", "--out", type=_FOLDER, required=True, help="Folder to write into.")
@click.option(
    "--to",
    "form",
    type=click.Choice(("openscenario", "openlabel", "osi", "mcap", "rerun")),
    default="openscenario",
    show_default=True,
    help="Format.",
)
@click.option(
    "--mode",
    type=click.Choice(("replay", "reactive")),
    default="replay",
    show_default=True,
    help="Courses as rolled out, or triggers as conditions on the ego.",
)
@click.option(
    "--for",
    "target",
    type=click.Choice(("generic", "esmini", "carla-scenario-runner")),
    default="generic",
    show_default=True,
    help="Player for which the files are written.",
)
@click.option(
    "--action",
    type=click.Choice(ACTIONS),
    default="keep_speed",
    show_default=True,
    help="The ego's action after the decision, in a replay.",
)
@click.option("--ego/--no-ego", default=True, show_default=True, help="Write the ego's course.")
@click.option(
    "--twins/--no-twins",
    default=True,
    show_default=True,
    help="Write the ordinary twins and demands as well.",
)
@click.option("--logical", is_flag=True, help="Write the ranges of the scenes' parameters as well.")
@click.option("--limit", type=click.IntRange(min=1), help="Write at most this many scenes.")
@click.option(
    "--workers",
    type=click.IntRange(1, 256),
    help="Processes.  [default: number of CPUs, one for few scenes]",
)
@simulator_option
@seed_option
def export(
    place: Path,
    out: Path,
    limit: int | None,
    workers: int | None,
    simulator: str,
    **options: Any,
) -> None:
    """Write scenes and their ordinary drives (twins and demands) into a folder.

    The scenes are those of a study, or of a file with one scene per line. `openscenario` writes OpenSCENARIO XML with
    OpenDRIVE, `openlabel` tags of the operational design domain and behaviour, `osi` a trace of ground truth, `mcap`
    the same trace with its map in one file, `rerun` a recording for the Rerun viewer. Scenes that cannot be written,
    also as the ego has no lane for the action, are reported on standard error, and the exit code is then 1.
    """
    if (form := options["form"]) != "openscenario":
        refuse_idle(f"with --to {form}", "mode", "target", "ego", "logical")
    if form == "openlabel" or options["mode"] == "reactive":
        refuse_idle("without a replay", "action")
    require_extra(form)
    scenes, catalogue, facts = scenes_of(place, simulator)
    scenes = scenes[:limit]
    options["simulator"] = simulator_of(place, simulator)
    if not options["twins"]:
        facts = facts._replace(demands={})
    refuse_inside(out)
    refuse_clashes(scenes, facts, options)
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
    written, faults = 0, list[str]()
    claim_folder(out, scenes, catalogue, options["form"])
    parts = [scenes[first : first + _PART] for first in range(0, len(scenes), _PART)]
    jobs = [(part, catalogue, facts.of(part), out, options) for part in parts]
    for some, errors in tracked(_results(jobs, workers), "export", len(jobs)):
        written += some
        faults += errors
    for fault in faults:
        say(fault, err=True)
    say(f"{written} files in {out}, {len(faults)} failed", err=True)
    sys.exit(bool(faults))


def _results(jobs: Sequence[tuple[Any, ...]], workers: int | None) -> Iterator[_Written]:
    """Yield what the jobs of `write_scenes` return, in processes if there are several."""
    count = min(workers or os.cpu_count() or 1, len(jobs))
    if count < 2:
        yield from starmap(write_scenes, jobs)
        return
    with Processes(count) as pool:
        for future in [pool.submit(write_scenes, *job) for job in jobs]:
            yield future.result()


def write_scenes(
    scenes: Sequence[Scene],
    catalogue: Catalogue,
    known: KnownFacts,
    out: Path,
    options: dict[str, Any],
) -> _Written:
    """Write some scenes, and return the number of files and the faults of scenes that cannot be written."""
    from oodscen.interchange._recording import ordinary_twin

    written, faults = 0, list[str]()
    for scene in scenes:
        items = [scene, *known.demands_of(scene)]
        if options["twins"] and not scene.is_ordinary:
            with _kept(faults, twin_id(scene.id)):
                items.append(ordinary_twin(scene, catalogue, seed=options["seed"]))
        for item in items:
            with _kept(faults, item.id):
                _write(item, catalogue, known, out, options)
                written += 1
    return written, faults


@contextmanager
def _kept(faults: list[str], name: str) -> Iterator[None]:
    """Keep an error about an item as a line, and go on; a missing package would fail every item."""
    try:
        yield
    except MissingExtra:
        raise
    except OodscenError as error:
        faults.append(f"{name}: {error}")


def _write(
    scene: Scene,
    catalogue: Catalogue,
    known: KnownFacts,
    out: Path,
    options: dict[str, Any],
) -> None:
    """Write one scene in the chosen format."""
    from oodscen._files import replace
    from oodscen.interchange._writing.logical import logical_file

    seed = options["seed"]
    if options["form"] == "openlabel":
        write(out / f"{scene.id}.json", json.dumps(scene.to_openlabel(catalogue), indent=2))
    elif options["form"] in ("osi", "mcap"):
        form = options["form"]
        trace = scene.to_osi(catalogue, action=options["action"], seed=seed, container=form)
        replace(out / f"{scene.id}.{form}", trace)
    elif options["form"] == "rerun":
        from oodscen import make_simulator
        from oodscen.interchange._traces.rerun_files import write_rerun

        with using(make_simulator(options["simulator"])) as drawing:
            path = out / f"{scene.id}.rrd"
            write_rerun(scene, drawing, path, action=options["action"], seed=seed)
    else:
        chosen = {name: options[name] for name in ("mode", "target", "action", "ego")}
        file = scene.to_openscenario(catalogue, seed=seed, properties=known(scene), **chosen)
        file.save(out)
        if options["logical"] and not scene.is_ordinary:
            is_12 = options["target"] != "carla-scenario-runner"
            claims = known.claims(scene)
            if options["mode"] == "reactive" and is_12:
                logical = logical_file(file, scene, catalogue, claims, seed)
            else:
                logical = scene.to_openscenario(catalogue, mode="logical", claims=claims, seed=seed)
            if logical.beside:
                logical.save(out)


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

    if value is None:
        return None
    name = value.strip()
    if not name or name != printable(one_line(name)):
        raise click.BadParameter("is empty, or no plain line.", ctx, param)
    if name.lower() in DRIVERS:
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
@seed_option
@json_option
def verdict(
    place: Path,
    files: tuple[Path, ...],
    driver: str | None,
    replace: bool,
    simulator: str,
    seed: int,
    as_json: bool,
) -> None:
    """Judge runs that another player drove, by the poses that it wrote.

    Each file has the name of its scene or ordinary drive: SCENE.csv, SCENE.osi or SCENE.mcap. The exit code is 1 if a
    file could not be judged, or its run is inconclusive; a collision is not a failure.
    """
    from oodscen.interchange import verdict as judge

    if not driver or not place.is_dir():
        refuse_idle("without --driver and a study, whose table it is for", "replace")
    names = Counter(path.stem for path in files)
    if driver and (twice := [name for name, count in names.items() if count > 1]):
        raise UsageError(f"{twice[0]} has several files; a driver has one result per scene")
    scenes, catalogue, facts = scenes_of(place, simulator)
    by_id = {scene.id: scene for scene in (*scenes, *facts.demands.values())}
    verdicts: list[PlayedVerdict] = []
    failed = 0
    for path in files:
        try:
            scene = _scene_named(path.stem, by_id, catalogue, seed)
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
        for one in verdicts:
            say(_line(one))
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

    Each variant is checked like any other scene, and against the claims of its text where a study has them. The exit
    code is 1 if some scene has fewer variants than asked for.
    """
    scenes, catalogue, facts = scenes_of(place, simulator)
    if wanted is not None:
        scenes = [one for one in (*scenes, *facts.demands.values()) if one.id == wanted]
        if not scenes:
            raise UsageError(f"there is no scene {wanted!r}")
    short = 0
    for scene in tracked(scenes, "vary", len(scenes)):
        variants = scene.vary(catalogue, count, claims=facts.claims(scene), seed=seed)
        for variant in variants:
            say(variant.to_json())
        if len(variants) < count:
            if faults := scene.check(catalogue):
                say(f"{scene.id}: cannot be staged itself: {faults[0]}", err=True)
            say(f"{scene.id}: {len(variants)} of {count} variants can be staged", err=True)
            short += 1
    sys.exit(bool(short))


def _scene_named(name: str, by_id: dict[str, Scene], catalogue: Catalogue, seed: int) -> Scene:
    """Return a scene or its ordinary drive; twins are made, as no file holds them."""
    from oodscen.interchange._recording import ordinary_twin

    if name in by_id:
        return by_id[name]
    if is_twin(name) and scene_of(name) in by_id:
        return ordinary_twin(by_id[scene_of(name)], catalogue, seed=seed)
    raise UsageError(f"there is no scene {name!r}")


def _enter(place: Path, found: "list[PlayedVerdict]", is_replacing: bool) -> None:
    """Enter the drives into the study's table and write its report again.

    Raises:
        UsageError: If the table has other results of the driver for these scenes that are not to be replaced.
    """
    from oodscen.judging._drive_board import current_results
    from oodscen.report._render import write_report
    from oodscen.study._study import Study

    study = Study.open(place)
    click.get_current_context().with_resource(study.store.writing())
    digests = {scene.id: scene.digest() for scene in study.scenes}
    rows = {row.id: row for row in current_results(study.drives, study.scenes)}
    results = [
        played_verdict.drive.model_copy(
            update={"made_from": digests[scene_of(played_verdict.scene_id)]}
        )
        for played_verdict in found
    ]
    other = [result.scene_id for result in results if result != rows.get(result.id, result)]
    if other and not is_replacing:
        raise UsageError(
            f"{results[0].driver} has another result for {', '.join(other[:5])} already, which --replace replaces"
        )
    rows |= {result.id: result for result in results}
    study.store.write_lines("drives.jsonl", list(rows.values()))
    write_report(study)


def _line(one: "PlayedVerdict") -> str:
    came = f"decision at {one.decision_s:.2f} s" if one.decision_fired else "no decision"
    notes = "".join(f"; {note}" for note in one.notes)
    outcome = one.outcome
    if outcome is None:
        return f"{one.scene_id}: {came}, inconclusive: {one.inconclusive}{notes}"
    hit = f"touches {', '.join(outcome.contacts)}" if outcome.contacts else ""
    harm = hit or ("leaves the road" if outcome.off_road else "")
    harm = harm or ("drives past the red light" if outcome.ran_red else "safe")
    margin = "" if outcome.margin_m is None else f", margin {outcome.margin_m:.2f} m"
    return f"{one.scene_id}: {came}, {harm}{margin}{notes}"
