"""Wording of judgements of branches: what shows a hazard, and what is missing for it."""

from collections.abc import Iterable, Sequence

from oodscen.author._reading.alternatives import small
from oodscen.author._realisation import NO_RECIPE, Realisation, all_missing
from oodscen.data._additions import Addition
from oodscen.prompts._digest import CatalogueDigest
from oodscen.tree._labels import MAX_LABEL

_KINDS = {
    "asset": ("asset", "assets"),
    "state": ("state", "states"),
    "behaviour": ("behaviour", "behaviours"),
    "weather": ("weather", "weather"),
    "map": ("map", "maps"),
}
"""Kinds of additions in the singular and plural, in the order in which a reason names them."""
_PLURALS = {"vegetation": "plants or fallen trees", "work_zone": "things of road works"}
"""Words for the assets of a category, where they are not the category with an s."""


def lacking_words(hidden: Sequence[Realisation], catalogue: CatalogueDigest) -> str:
    """Describe in a clause the missing items, and the categories of which the catalogue has no asset at all."""
    additions = all_missing(hidden)
    lists = [_lacking(kind, additions) for kind in _KINDS]
    lacking = " and ".join(filter(None, lists))
    offered = {asset.category for asset in catalogue.assets}
    asset_categories = dict.fromkeys(
        addition.category for addition in additions if addition.kind == "asset"
    )
    empty = [
        _PLURALS.get(category, f"{category}s")
        for category in asset_categories
        if category is not None and category not in offered
    ]
    text = f"the simulator lacks {lacking}" if lacking else ""
    if empty:
        text += f"; it has no {' and no '.join(empty)} at all"
    reasons = list(dict.fromkeys(realisation.why for realisation in hidden if realisation.why))
    if reasons:
        text += f"{', and ' if lacking else ''}{', and '.join(reasons)}"
    elif NO_RECIPE in additions:
        joint = ", and" if lacking else "everything it needs is there, but"
        text += f"{joint} the author does not know how to stage it recognisably"
    return text


def _lacking(kind: str, additions: Sequence[Addition]) -> str:
    """Name the missing items of one kind: `trench, deep water (assets)`."""
    named = [addition.words.split(": ", 1)[-1] for addition in additions if addition.kind == kind]
    if not named:
        return ""
    return f"{', '.join(named)} ({_KINDS[kind][len(named) > 1]})"


def hazard_words(realisations: Iterable[Realisation]) -> str:
    """Name the hazards of some realisations."""
    labels = dict.fromkeys(
        small(realisation.hazard.label)
        for realisation in realisations
        if realisation.hazard is not None
    )
    return " and ".join(labels)


def joined_labels(labels: Sequence[str]) -> tuple[str, int]:
    """Join as many labels as fit, in a form that the recogniser can split; return the text and their number."""
    text = labels[0]
    for number, label in enumerate(labels[1:], start=1):
        longer = f"{text}, or {small(label)}"
        if len(longer) > MAX_LABEL:
            return text, number
        text = longer
    return text, len(labels)
