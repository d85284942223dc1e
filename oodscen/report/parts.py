"""Further parts of the page, each made by a function of its own from what a study holds.

A part is found by name when the page is written, so that a study without it, or an installation
without what draws it, gives the page without that part.
"""

import importlib
from collections.abc import Callable
from typing import NamedTuple

from markupsafe import Markup

from oodscen.errors import OodscenError
from oodscen.report.reading import Material
from oodscen.study import Study

Draw = Callable[[Study, Material], Markup]


class Part(NamedTuple):
    """A place for something that another module draws."""

    place: str
    """Section of the page: `drives`, `undecided`, `metrics`, `growth`, `pruning` or `coverage`."""
    title: str
    draw: str
    """`module:function`; the function takes the study and what was read of it, and returns markup
    (empty where the study has nothing to show). It must escape what models wrote."""


PARTS: tuple[Part, ...] = (
    Part("drives", "Driving stacks", "oodscen.report.driving:part"),
    Part("undecided", "Scenes that tell no actions apart", "oodscen.report.undecided:part"),
    Part("metrics", "Pictures of the measures", "oodscen.report.metric_pictures:part"),
    Part("growth", "How much is left to be found", "oodscen.report.further:saturation_part"),
    Part("pruning", "What would bring paths back", "oodscen.report.further:restoration_part"),
    Part("pruning", "What another simulator would show", "oodscen.report.simulators:part"),
    Part("coverage", "What the texts and scenes cover", "oodscen.trees.report:part"),
)
"""Every part, in the order in which they are shown."""


class Drawn(NamedTuple):
    """One part as the page shows it."""

    title: str
    markup: Markup
    error: str = ""


def drawn(study: Study, found: Material) -> dict[str, list[Drawn]]:
    """Draw every part that is there, by place."""
    places: dict[str, list[Drawn]] = {part.place: [] for part in PARTS}
    for part in PARTS:
        draw = _function(part.draw)
        if draw is None:
            continue
        try:
            markup = draw(study, found)
        except (OodscenError, ArithmeticError, LookupError, TypeError, ValueError) as error:
            places[part.place].append(
                Drawn(part.title, Markup(""), str(error) or type(error).__name__)
            )
            continue
        if markup:
            places[part.place].append(Drawn(part.title, markup))
    return places


def _function(name: str) -> Draw | None:
    module, _, attribute = name.partition(":")
    try:
        found: Draw | None = getattr(importlib.import_module(module), attribute, None)
    except ImportError:
        return None
    return found
