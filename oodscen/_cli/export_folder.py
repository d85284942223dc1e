"""The options of `export`, and the folder that it writes into: it replaces only files of earlier exports."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from oodscen._cli.places import KnownFacts
from oodscen._io.files import read_utf8, replace
from oodscen.data._catalogue import Catalogue
from oodscen.data._pairing import demand_id, is_ordinary, twin_id
from oodscen.data._scene import Scene
from oodscen.errors import FolderTaken, OodscenError, UsageError

if TYPE_CHECKING:
    from oodscen.interchange._writing.scenario import Target

Format = Literal["openscenario", "openlabel", "osi", "mcap", "rerun"]
LIST = "oodscen-export.txt"
"""File that lists what exports have written into its folder."""
_HEAD = "Files of oodscen export. Another export replaces those that are listed, and no others."
_SUFFIXES = {
    "openscenario": ("xosc", "logical.xosc", "deterministic.xosc", "stochastic.xosc"),
    "openlabel": ("json",),
    "osi": ("osi",),
    "mcap": ("mcap",),
    "rerun": ("rrd",),
}
"""Suffixes of the files of a scene: of the scene itself, then of its ranges."""


@dataclass(frozen=True)
class ExportOptions:
    """The choices of an export."""

    form: Format
    mode: Literal["replay", "reactive"]
    target: "Target"
    action: str
    ego: bool
    twins: bool
    logical: bool
    seed: int
    simulator: str
    """Name of the simulator in which scenes are run."""
    reaction_s: float
    """Time from the decision until the ego acts, s."""


def refuse_clashes(scenes: Sequence[Scene], facts: KnownFacts, options: ExportOptions) -> None:
    """Refuse an export that would, with these options, write two drives of scenes or their demands into one file.

    Raises:
        UsageError: If two files would have one name; the message names both drives.
    """
    owners: dict[str, str] = {}
    suffix, *logical = _SUFFIXES[options.form]
    for scene in scenes:
        drives = [(scene.id, f"the scene {scene.id!r}")]
        drives += [(demand.id, f"the demand {demand.id!r}") for demand in facts.demands_of(scene)]
        if options.twins and not scene.is_ordinary:
            drives.append((twin_id(scene.id), f"the twin of the scene {scene.id!r}"))
        files = [(f"{name}.{suffix}", owner) for name, owner in drives]
        if options.logical:
            files += [
                (f"{name}.{end}", f"the ranges of {owner}")
                for name, owner in drives
                if not is_ordinary(name)
                for end in logical
            ]
        for file, owner in files:
            if file in owners:
                raise UsageError(f"{owners[file]} and {owner} would both be written to {file}")
            owners[file] = owner


def require_extra(form: Format) -> None:
    """Refuse a format whose package is missing.

    Raises:
        MissingExtra: If it is not installed.
    """
    if form == "mcap":
        from oodscen.interchange._traces.mcap_files import mcap_library

        mcap_library()
    elif form == "rerun":
        from oodscen.interchange._traces.rerun_files import rerun_library

        rerun_library()


def claim_folder(out: Path, scenes: Sequence[Scene], catalogue: Catalogue, form: Format) -> None:
    """List the files that an export may write, before it writes them.

    Args:
        out: The folder, which exists.
        scenes: The scenes; their ordinary drives may be written as well.
        catalogue: The catalogue of their maps.
        form: The format.

    Raises:
        FolderTaken: If it holds files of these names that no export has written.
    """
    names = {
        f"{name}.{suffix}"
        for scene in scenes
        for name in (scene.id, twin_id(scene.id), demand_id(scene.id))
        for suffix in _SUFFIXES[form]
    }
    listed = _listed(out)
    there = {path.name for path in out.iterdir()}
    taken = (names & there) - listed
    if form == "openscenario":
        for name, content in _roads(scenes, catalogue):
            if name in there - listed and _content(out / name) != content:
                taken.add(name)
            names.add(name)
    if taken:
        raise FolderTaken(str(out), sorted(taken))
    _write_list(out, listed | names)


def list_written(out: Path) -> None:
    """Take the names off the list that no export has written: a file of that name is another's."""
    names = {name for name in _listed(out) if (out / name).exists()}
    _write_list(out, names)


def _write_list(out: Path, names: Iterable[str]) -> None:
    replace(out / LIST, "\n".join([_HEAD, *sorted(names), ""]).encode())


def _listed(out: Path) -> set[str]:
    """Return the names that earlier exports have listed."""
    if not (out / LIST).exists():
        return set()
    head, *names = read_utf8(out / LIST, "list of exports").splitlines() or [""]
    if head != _HEAD:
        raise FolderTaken(str(out), [LIST])
    return {name for name in names if name}


def _roads(scenes: Iterable[Scene], catalogue: Catalogue) -> Iterable[tuple[str, bytes]]:
    """Yield the names and contents of the maps; those that cannot be read are reported by scene."""
    from oodscen.interchange._writing.roads import road_file

    for scene in {scene.map: scene for scene in scenes}.values():
        with suppress(OodscenError):
            yield road_file(scene, catalogue)


def _content(path: Path) -> bytes | None:
    """Return a file's bytes; `None` if it has none to be read."""
    try:
        return path.read_bytes()
    except OSError:
        return None
