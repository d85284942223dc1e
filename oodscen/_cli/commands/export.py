"""The command that writes scenes in the formats of other tools."""

import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from oodscen._cli.export_folder import (
    ExportOptions,
    claim_folder,
    list_written,
    refuse_clashes,
    require_extra,
)
from oodscen._cli.options import refuse_idle, run_seed_option, simulator_option
from oodscen._cli.output import say, write
from oodscen._cli.paths import PathName
from oodscen._cli.places import KnownFacts, scenes_of
from oodscen._cli.progress import tracked
from oodscen._io.files import replace, writing
from oodscen._io.study_files import refuse_inside
from oodscen._members import using
from oodscen._parallel.processes import Processes
from oodscen.data._catalogue import Catalogue
from oodscen.data._episode import ACTIONS
from oodscen.data._pairing import twin_id
from oodscen.data._scene import Scene
from oodscen.errors import MissingExtra, OodscenError
from oodscen.protocols import Simulator

_PART = 24
"""Number of scenes that a process writes in one go."""


@click.command()
@click.argument("place", metavar="STUDY|SCENES", type=PathName(exists=True, path_type=Path))
@click.option(
    "-o",
    "--out",
    type=PathName(file_okay=False, path_type=Path),
    required=True,
    help="Folder to write into.",
)
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
@run_seed_option
def export(
    place: Path,
    out: Path,
    limit: int | None,
    workers: int | None,
    simulator: str,
    seed: int | None,
    **choices: Any,
) -> None:
    """Write scenes and their ordinary drives (twins and demands) into a folder.

    The scenes are those of a study, or of a file with one scene per line. `openscenario` writes OpenSCENARIO XML with
    OpenDRIVE, `openlabel` tags of the operational design domain and behaviour, `osi` a trace of ground truth, `mcap`
    the same trace with its map in one file, `rerun` a recording for the Rerun viewer. Scenes that cannot be written,
    also as the ego has no lane for the action, are reported on standard error, and the exit code is then 1.
    """
    source = scenes_of(place, simulator)
    options = ExportOptions(
        **choices,
        simulator=source.simulator,
        seed=source.seed if seed is None else seed,
        reaction_s=source.reaction_s,
    )
    if options.form != "openscenario":
        refuse_idle(f"with --to {options.form}", "mode", "target", "ego", "logical")
    if options.form == "openlabel" or options.mode == "reactive":
        refuse_idle("without a replay", "action")
    require_extra(options.form)
    scenes, catalogue, facts = source.scenes[:limit], source.catalogue, source.facts
    if not options.twins:
        facts = facts._replace(demands={})
    refuse_inside(out)
    refuse_clashes(scenes, facts, options)
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
    claim_folder(out, scenes, catalogue, options.form)
    parts = [scenes[first : first + _PART] for first in range(0, len(scenes), _PART)]
    writers = [_Writer(part, catalogue, facts.of(part), out, options) for part in parts]
    count, faults = 0, list[str]()
    try:
        for written, failed in tracked(_results(writers, workers), "export", len(writers)):
            count += written
            faults += failed
    finally:
        list_written(out)
    for fault in faults:
        say(fault, err=True)
    say(f"{count} written into {out}, {len(faults)} failed", err=True)
    sys.exit(bool(faults))


def _results(writers: Sequence["_Writer"], workers: int | None) -> Iterator[tuple[int, list[str]]]:
    """Yield what the writers return, in processes if there are several."""
    count = min(workers or os.cpu_count() or 1, len(writers))
    if count < 2:
        yield from (writer.run() for writer in writers)
        return
    with Processes(count) as pool:
        for future in [pool.submit(writer.run) for writer in writers]:
            yield future.result()


@dataclass(frozen=True)
class _Writer:
    """Writes some scenes and their ordinary drives."""

    scenes: Sequence[Scene]
    catalogue: Catalogue
    facts: KnownFacts
    out: Path
    options: ExportOptions

    def run(self) -> tuple[int, list[str]]:
        """Return the number of drives written, and the faults of those that cannot be."""
        from oodscen import make_simulator

        count, faults = 0, list[str]()
        with using(make_simulator(self.options.simulator)) as simulator:
            for scene in self.scenes:
                for drive in self._drives(scene, simulator, faults):
                    with _listing(faults, drive.id):
                        self._write(drive, simulator)
                        count += 1
        return count, faults

    def _drives(self, scene: Scene, simulator: Simulator, faults: list[str]) -> list[Scene]:
        """Return a scene and its ordinary drives; the fault of a twin that cannot be made is listed."""
        from oodscen.interchange._recording import ordinary_twin

        drives = [scene, *self.facts.demands_of(scene)]
        if self.options.twins and not scene.is_ordinary:
            with _listing(faults, twin_id(scene.id)):
                seed = self.options.seed
                twin = ordinary_twin(scene, self.catalogue, seed=seed, simulator=simulator)
                drives.append(twin)
        return drives

    def _write(self, scene: Scene, simulator: Simulator) -> None:
        form = self.options.form
        if form == "openscenario":
            self._write_openscenario(scene, simulator)
        elif form == "openlabel":
            tags = scene.to_openlabel(self.catalogue)
            write(self.out / f"{scene.id}.json", json.dumps(tags, indent=2))
        elif form == "rerun":
            self._write_rerun(scene, simulator)
        else:
            trace = scene.to_osi(
                self.catalogue,
                action=self.options.action,
                seed=self.options.seed,
                container=form,
                simulator=simulator,
                reaction_s=self.options.reaction_s,
            )
            replace(self.out / f"{scene.id}.{form}", trace)

    def _write_rerun(self, scene: Scene, simulator: Simulator) -> None:
        from oodscen.interchange._traces.rerun_files import write_rerun

        options = self.options
        write_rerun(
            scene,
            simulator,
            self.out / f"{scene.id}.rrd",
            action=options.action,
            seed=options.seed,
            reaction_s=options.reaction_s,
        )

    def _write_openscenario(self, scene: Scene, simulator: Simulator) -> None:
        from oodscen.interchange._writing.logical import logical_file

        options, seed = self.options, self.options.seed
        file = scene.to_openscenario(
            self.catalogue,
            mode=options.mode,
            target=options.target,
            action=options.action,
            ego=options.ego,
            seed=seed,
            properties=self.facts(scene),
            simulator=simulator,
            reaction_s=options.reaction_s,
        )
        file.save(self.out)
        if not options.logical or scene.is_ordinary:
            return
        claims = self.facts.claims(scene)
        if options.mode == "reactive" and options.target != "carla-scenario-runner":
            logical = logical_file(file, scene, self.catalogue, claims, seed)
        else:
            logical = scene.to_openscenario(
                self.catalogue, mode="logical", claims=claims, seed=seed, simulator=simulator
            )
        if logical.beside:
            logical.save(self.out)


@contextmanager
def _listing(faults: list[str], name: str) -> Iterator[None]:
    """List an error about a drive, and go on; a missing package would fail every one."""
    try:
        yield
    except MissingExtra:
        raise
    except OodscenError as error:
        faults.append(f"{name}: {error}")
