"""Scenes from OpenSCENARIO XML files: our own exactly, those of others as far as the vocabulary goes."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._sight.placement import staging_issues
from oodscen.errors import Issue, UsageError
from oodscen.interchange._reading.assembly import assembled_scene
from oodscen.interchange._reading.exports import exported_scene
from oodscen.interchange._reading.identifiers import scene_identifier
from oodscen.interchange._reading.leftovers import leftovers
from oodscen.interchange._reading.tree import OpenScenarioFile

if TYPE_CHECKING:
    from oodscen.protocols import LLM

_MAJOR, _MINORS = "1", ("0", "1", "2", "3")
"""Versions of OpenSCENARIO XML that are read."""


@dataclass(frozen=True, repr=False)
class ImportedScene(Brief):
    """A scene that was read from an OpenSCENARIO file, with what it lacks."""

    scene: Scene
    omissions: tuple[Issue, ...] = ()
    """The parts of the file that are not in the scene, with line and element, and the faults of the scene."""


@checked
def read_openscenario(
    path: str | Path,
    catalogue: Catalogue,
    *,
    road: str | None = None,
    hazards: Sequence[str] = (),
    ego: str | None = None,
    llm: "LLM | None" = None,
) -> ImportedScene:
    """Read an OpenSCENARIO XML 1.x file.

    An unchanged file of `Scene.to_openscenario` gives back its scene, unless the road file beside it was changed. Of
    other files come the road, the entities, where and how fast they start, the weather, and one behaviour for each
    entity; what is left out is listed.

    Args:
        path: The file.
        catalogue: The catalogue whose assets and behaviours the scene uses.
        road: A map of the catalogue or an `.xodr` file, in place of the file's own; not for an unchanged export.
        hazards: Names of the entities that are unusual; without them, `llm` is asked. Not for an unchanged export.
        ego: Name of the entity that is the ego; without it, its name tells. Not for an unchanged export.
        llm: The model that names the unusual entities; without one, the first that acts is taken.

    Raises:
        DataError: If the file is malformed or not version 1.x, with the line and the element, or has no such entity.
        UsageError: If a map, hazards or an ego are named for an unchanged export.
        UnknownComponent: If there is no such map.
        LLMError: If the model cannot be reached, or its answer cannot be used.
    """
    tree = OpenScenarioFile(path)
    exported = exported_scene(tree, catalogue) if _check_version(tree) else None
    if exported is not None:
        if road is not None or hazards or ego is not None:
            raise UsageError(
                f"{path} is an unchanged export, which gives back its scene with its own map, hazard and ego: name "
                "none of them, or change them in the scene"
            )
        return ImportedScene(exported, tuple(staging_issues(exported, catalogue)))
    scene = assembled_scene(tree, catalogue, road, hazards, ego, llm)
    issues = [*tree.omissions, *leftovers(tree), *staging_issues(scene, catalogue)]
    return ImportedScene(scene, tuple(issues))


def foresee(path: str | Path, catalogue: Catalogue) -> tuple[str, bool]:
    """Return the id of the scene that a file gives, and whether the file is an unchanged export.

    Raises:
        DataError: If the file is malformed or not version 1.x.
    """
    tree = OpenScenarioFile(path)
    exported = exported_scene(tree, catalogue) if _check_version(tree) else None
    if exported is None:
        return scene_identifier(tree.path.stem), False
    return exported.id, True


def _check_version(tree: OpenScenarioFile) -> bool:
    """Refuse another major version, note an unknown minor one, and return whether it is known.

    Raises:
        DataError: If the file is not OpenSCENARIO XML 1.x.
    """
    header = tree.header()
    major, minor = (header.get(name).strip() for name in ("revMajor", "revMinor"))
    if major != _MAJOR:
        raise header.fault(f"version {major[:20]!r} is not read; 1.0 to 1.3 are", "revMajor")
    if not re.fullmatch("[0-9]+", minor):
        raise header.fault(f"{minor[:20]!r} is no minor version; 1.0 to 1.3 are read", "revMinor")
    if minor not in _MINORS:
        header.note(f"version 1.{minor[:20]} is unknown and read as 1.3")
    return minor in _MINORS
