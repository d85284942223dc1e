"""Further parts of the page, each drawn by its own function from the study's data."""

from collections.abc import Callable
from typing import NamedTuple

from markupsafe import Markup

from oodscen.errors import OodscenError
from oodscen.report import _driving as driving
from oodscen.report import _gaps as further
from oodscen.report import _simulators as simulators
from oodscen.report import _undecided as undecided
from oodscen.report._charts import metric_pictures
from oodscen.report._load import Material
from oodscen.study import Study
from oodscen.tree import _coverage_report as coverage

Draw = Callable[[Study, Material], Markup]


class Part(NamedTuple):
    """A part of the page that another module draws."""

    place: str
    """Section of the page: `drives`, `undecided`, `metrics`, `growth`, `pruning` or `coverage`."""
    title: str
    draw: Draw
    """Takes the study and the material read from it, and returns markup (empty if the study has nothing to
    show). It must escape text from models.
    """


PARTS: tuple[Part, ...] = (
    Part("drives", "Driving stacks", driving.part),
    Part("undecided", "Scenes that tell no actions apart", undecided.part),
    Part("metrics", "Pictures of the measures", metric_pictures.part),
    Part("growth", "How much is left to be found", further.saturation_part),
    Part("pruning", "What would bring paths back", further.restoration_part),
    Part("pruning", "What another simulator would show", simulators.part),
    Part("coverage", "What the texts and scenes cover", coverage.part),
)
"""Every part, in display order."""


class Drawn(NamedTuple):
    """One part as the page shows it."""

    title: str
    markup: Markup
    error: str = ""


def drawn(study: Study, found: Material) -> dict[str, list[Drawn]]:
    """Draw every part by place; a broken file of the study becomes a note there."""
    places: dict[str, list[Drawn]] = {part.place: [] for part in PARTS}
    for part in PARTS:
        try:
            one = Drawn(part.title, part.draw(study, found))
        except OodscenError as error:
            one = Drawn(part.title, Markup(""), str(error))
        if one.markup or one.error:
            places[part.place].append(one)
    return places
