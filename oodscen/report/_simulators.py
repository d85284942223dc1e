"""The part of the page that compares the study's simulator with others."""

from collections.abc import Mapping
from typing import Any

from oodscen._io.study_files import CATALOGUES
from oodscen.report._load import Material
from oodscen.report._tolerant_reader import make_printable
from oodscen.stages._prune.side_by_side import CatalogueComparison, CatalogueTally, Side
from oodscen.study._study import Study

_KINDS = {
    "vehicle": "vehicles",
    "cyclist": "cyclists",
    "pedestrian": "pedestrians",
    "animal": "animals",
    "object": "loose objects",
    "work_zone": "roadwork equipment",
    "vegetation": "plants or fallen trees",
    "signal": "signals",
}
"""Names of the kinds that a catalogue lacks entirely."""
_MATCH_WORDS = {"full": "yes", "substitute": "with substitutes", "part": "in part", "none": "no"}
"""Answers of the page to whether a path can be simulated."""


def simulators(study: Study, material: Material) -> Mapping[str, Any] | None:
    """Return the template's variables for the comparison of simulators; `None` if the study has no pruned tree.

    They say which paths of the diverse tree each simulator can simulate, from `catalogues.json`.
    `oodscen prune TREE --catalogue A --catalogue B --json` prints that file. If a study lacks it, the page
    explains how to get it.

    Raises:
        DataError: If `catalogues.json` is malformed.
    """
    if study.store.has(CATALOGUES):
        return _compared(CatalogueComparison.load(study.folder / CATALOGUES))
    if not {"diverse", "simulatable"} <= set(material.trees):
        return None
    return {
        "compared": False,
        "llm": material.config.get("llm") or "NAME",
        "simulator": material.config.get("simulator") or "SIMULATOR",
        "file": CATALOGUES,
    }


def _compared(compared: CatalogueComparison) -> dict[str, Any]:
    return {
        "compared": True,
        "tallies": compared.tallies,
        "absent": {tally.catalogue: _absent(tally) for tally in compared.tallies},
        # The first catalogue is that of the study's own simulator.
        "dropped": {
            name: make_printable(_dropped(compared, number))
            for number, name in enumerate(compared.catalogues[1:], start=1)
        },
        "everything": make_printable(compared.rows()),
    }


def _absent(tally: CatalogueTally) -> str:
    """Name the kinds that a simulator lacks entirely, each with the number of dropped paths that need it."""
    kinds = [_kind(name, tally) for name in tally.absent]
    return " and ".join(filter(None, (", ".join(kinds[:-1]), *kinds[-1:])))


def _kind(name: str, tally: CatalogueTally) -> str:
    ranking = tally.restoration
    needed = sum(whole.helps for whole in ranking.categories if whole.category == name)
    for addition in ranking.single:
        if any(added.kind == "weather" and added.name == name for added in addition.additions):
            needed += addition.helps
    text = f"no {_KINDS.get(name, name)}"
    return f"{text} (needed by {needed} of the dropped)" if needed else text


def _dropped(compared: CatalogueComparison, number: int) -> list[dict[str, str]]:
    """Return the paths that one simulator drops, with the reasons and the study's own decisions."""
    return [
        {
            "path": " › ".join(line.path[1:]),
            "reason": line.sides[number].reason,
            "study_decision": _fate(line.sides[0]),
        }
        for line in compared.lines
        if not line.sides[number].keep
    ]


def _fate(side: Side) -> str:
    text = _MATCH_WORDS[side.match] if side.match else "not judged"
    return f"{text}: {side.label}" if side.label else text
