"""Assets of the catalogue for the entities of an OpenSCENARIO file."""

import re

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.interchange._reading.tree import Element
from oodscen.interchange._writing.entities import classified
from oodscen.interchange._writing.properties import PREFIX

_BODIES = ("Vehicle", "Pedestrian", "MiscObject")
_TYPICAL = {
    "car": "car",
    "van": "van",
    "truck": "truck",
    "bus": "bus",
    "bicycle": "cyclist",
    "pedestrian": "adult",
}
"""Assets for categories, where the catalogue has them and their sizes agree."""
_ALIKE_M = 2.0
"""Difference of length and width together up to which sizes agree, m."""


def nearest_asset(entity: Element, catalogue: Catalogue) -> Asset | None:
    """Return the asset nearest to a scenario object, or `None` after recording that it has none."""
    body = next((child for child in entity.children() if child.name in _BODIES), None)
    if body is None:
        entity.leave_out("is not a vehicle, pedestrian or object")
        return None
    body.touch()
    name = body.get("name")
    if (called := catalogue.by_name.get(name)) is not None:
        return called
    category = _category(body)
    candidates = _candidates(body, category, catalogue)
    if not candidates:
        body.leave_out(f"the catalogue has nothing like a {category or body.name}")
        return None
    size = body.first("BoundingBox", "Dimensions")
    words = set(re.findall(r"[a-z]+", f"{name} {entity.get('name')}".lower()))

    def unlikeness(asset: Asset) -> tuple[bool, bool, float]:
        difference_m = 0.0
        if size is not None:
            length_m, width_m = size.number("length"), size.number("width")
            difference_m = abs(length_m - asset.length) + abs(width_m - asset.width)
        names = (asset.id, *asset.names)
        has_its_word = not words.isdisjoint(word for known in names for word in known.split("_"))
        agrees = difference_m < _ALIKE_M or body.name == "Pedestrian"
        is_typical = agrees and _TYPICAL.get(category) in names
        return not has_its_word, not is_typical, round(difference_m, 1)

    return min(candidates, key=unlikeness)


def state_of(entity: Element, asset: Asset) -> str:
    """Return the state that a property of an export gives a scenario object; empty is the asset's first."""
    bodies = (child for child in entity.children() if child.name in _BODIES)
    for holder in next(bodies).all("Properties", "Property"):
        if holder.element.get("name") == f"{PREFIX}state":
            holder.settle()
            state = holder.get("value")
            if state in asset.states:
                return "" if state == asset.states[0] else state
            holder.note(f"{asset.id} has no state {state[:40]!r}")
    return ""


def _category(body: Element) -> str:
    attribute = f"{body.name[0].lower()}{body.name[1:]}Category"
    if body.name == "Pedestrian":
        return body.word(attribute, "pedestrian", "animal", "wheelchair")
    return body.get(attribute)


def _candidates(body: Element, category: str, catalogue: Catalogue) -> list[Asset]:
    """Return the assets of a body's category, or else those of its kind after recording that it has another."""
    of_kind = [asset for asset in catalogue.assets if classified(asset)[0] == body.name]
    of_category = [asset for asset in of_kind if classified(asset)[1] == category]
    if of_kind and not of_category:
        body.note(f"the catalogue has no {category}; another {body.name} stands for it")
    return of_category or of_kind
