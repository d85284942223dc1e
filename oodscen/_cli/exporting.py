"""The claim of a folder that `export` writes into: it replaces only files of earlier exports."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from oodscen._files import read_utf8, replace
from oodscen.data._catalogue import Catalogue
from oodscen.data._pairing import demand_id, twin_id
from oodscen.data._scene import Scene
from oodscen.errors import FolderTaken, OodscenError

LIST = "oodscen-export.txt"
"""File that lists what exports have written into its folder."""
_HEAD = "Files of oodscen export. Another export replaces those that are listed, and no others."
_SUFFIXES = {
    "openscenario": ("xosc", "logical.xosc", "deterministic.xosc", "stochastic.xosc"),
    "openlabel": ("json",),
    "rerun": ("rrd",),
}
"""Suffixes of the files of a scene; of other formats the suffix is the format's name."""


def claim_folder(out: Path, scenes: Sequence[Scene], catalogue: Catalogue, form: str) -> None:
    """List the files that an export may write, before it writes them.

    Args:
        out: The folder, which exists.
        scenes: The scenes; their ordinary drives may be written as well.
        catalogue: The catalogue of their maps.
        form: The format.

    Raises:
        FolderTaken: If it is a study's, or holds files of these names that no export has written.
    """
    _refuse_study(out)
    names = {
        f"{name}.{suffix}"
        for scene in scenes
        for name in (scene.id, twin_id(scene.id), demand_id(scene.id))
        for suffix in _SUFFIXES.get(form, (form,))
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
        raise FolderTaken(str(out), sorted(taken)[:5])
    text = "\n".join([_HEAD, *sorted(listed | names), ""])
    replace(out / LIST, text.encode())


def _refuse_study(out: Path) -> None:
    """Refuse a study's folder and its parts; a folder of one's own in it is none of them."""
    from oodscen.study._files import is_own

    place = out.resolve()
    if (place / "study.json").exists():
        raise FolderTaken(str(out), ["study.json"])
    for parent in place.parents:
        part = place.relative_to(parent).parts[0]
        if is_own(part) and (parent / "study.json").exists():
            raise FolderTaken(str(parent), [part])


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

    for scene in {one.map: one for one in scenes}.values():
        with suppress(OodscenError):
            yield road_file(scene, catalogue)


def _content(path: Path) -> bytes | None:
    """Return a file's bytes; `None` if it has none to be read."""
    try:
        return path.read_bytes()
    except OSError:
        return None
