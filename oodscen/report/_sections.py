"""Further parts of the page: the place, title, data and template of each."""

from collections.abc import Callable, Mapping
from typing import Any, Literal, NamedTuple

from oodscen.errors import OodscenError
from oodscen.report import _parts as parts
from oodscen.report._load import Material
from oodscen.report._made import made_to_order
from oodscen.report._simulators import simulators
from oodscen.report._text_metrics import pictures
from oodscen.study._study import Study

Place = Literal[
    "shortcuts", "drives", "undecided", "metrics", "growth", "pruning", "made", "coverage"
]


class PagePart(NamedTuple):
    """A part of the page with its own template."""

    place: Place
    """Section of the page."""
    title: str
    template: str
    """Name of the file in `templates/parts`, without its ending."""
    data: Callable[[Study, Material], Mapping[str, Any] | None]
    """Takes the study and the material read from it, and returns the template's variables; `None` if the study
    has nothing to show.
    """


PARTS: tuple[PagePart, ...] = (
    PagePart(
        "shortcuts",
        "Shortcuts: rare or ordinary without understanding",
        "shortcuts",
        parts.shortcuts,
    ),
    PagePart("drives", "Driving stacks", "driving", parts.driving),
    PagePart("undecided", "Scenes that tell no actions apart", "undecided", parts.undecided),
    PagePart("metrics", "Pictures of the measures", "pictures", pictures),
    PagePart("growth", "How much is left to be found", "saturation", parts.saturated),
    PagePart("pruning", "What would bring paths back", "restoration", parts.restored),
    PagePart("pruning", "What another simulator would show", "simulators", simulators),
    PagePart("made", "What was made to order", "made", made_to_order),
    PagePart("coverage", "What the texts and scenes cover", "coverage", parts.covered),
)
"""Every part, in display order."""


class RenderedPart(NamedTuple):
    """One part as the page shows it."""

    title: str
    template: str
    data: Mapping[str, Any]
    error: str = ""


def collect_parts(study: Study, material: Material) -> dict[str, list[RenderedPart]]:
    """Return the data of every part by place; a broken file of the study becomes a note there."""
    places: dict[str, list[RenderedPart]] = {part.place: [] for part in PARTS}
    for part in PARTS:
        try:
            data = part.data(study, material)
        except OodscenError as error:
            places[part.place].append(RenderedPart(part.title, part.template, {}, str(error)))
            continue
        if data is not None:
            places[part.place].append(RenderedPart(part.title, part.template, data))
    return places
