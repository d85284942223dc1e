"""Parts of an OpenSCENARIO file from which nothing was read."""

from collections.abc import Iterator, Mapping

from lxml import etree

from oodscen._io.xml_numbers import double
from oodscen.driving._roads.document import name_of
from oodscen.errors import Issue
from oodscen.interchange._reading.tree import OpenScenarioFile, where

_SILENT = {
    "License",
    "CatalogLocations",
    "ParameterDeclarations",
    "BoundingBox",
    "Performance",
    "Axles",
}
"""Elements that say nothing of a scene, or only what its assets say."""
_PLAIN = {"FileHeader", "Vehicle", "Pedestrian", "MiscObject"}
"""Elements whose attributes say nothing of a scene, or only what its assets say."""
_OFF_GROUND = {"z", "p", "r", "dz"}
"""Attributes by which a body leaves the road's surface unless they are zero."""
_USUAL = {
    "conditionEdge": {"none", "rising"},
    "continuous": {"false"},
    "closed": {"false"},
    "animation": {"false"},
    "maximumExecutionCount": {"1"},
    "priority": {"overwrite", "override", "parallel"},
    "selectTriggeringEntities": {"false"},
    "routingAlgorithm": {"undefined"},
    "followingMode": {"position", "follow"},
    "dynamicsShape": {"linear", "sinusoidal", "cubic"},
    "wetness": {"dry"},
}
"""Values that change nothing in what is read, by attribute."""
_INTEGERS = {"integer", "int", "unsignedInt", "unsignedShort"}
_LONGEST_VALUE, _MAX_NOTED = 60, 6
"""Characters of a value, and attributes of an element, that a note has at most."""
_MAX_ATTRIBUTES = 100
"""Attributes of one element that are looked at: the standard has none with more, and each look-up takes longer."""


def leftovers(tree: OpenScenarioFile) -> Iterator[Issue]:
    """Yield the parts of a file that have not been read, and the faults of its parameters.

    Parts of one kind are one issue, at the first of them.
    """
    unread: dict[tuple[str, ...], list[Issue]] = {}
    for top in (tree.root.element, *tree.entered):
        for element, attributes in _unread(tree, top):
            issue = Issue(where(element), f"{_shortened(attributes)} is not read".lstrip())
            unread.setdefault((name_of(element), *attributes), []).append(issue)
        yield from _parameter_faults(top)
    for first, *others in unread.values():
        more = f", and so {len(others)} more" if others else ""
        yield Issue(first.path, first.message + more)


def _shortened(attributes: Mapping[str, str]) -> str:
    """Return some attributes as they are written, shortened."""
    words = [f"{name}={value[:_LONGEST_VALUE]!r}" for name, value in attributes.items()]
    if len(words) > _MAX_NOTED:
        words = [*words[:_MAX_NOTED], "..."]
    return ", ".join(words)


def _unread(
    tree: OpenScenarioFile, top: etree._Element
) -> Iterator[tuple[etree._Element, dict[str, str]]]:
    """Yield the elements that were not read, without attributes, and those with attributes that were not."""
    waiting = [top]
    while waiting:
        element = waiting.pop()
        if element in tree.settled or name_of(element) in _SILENT:
            continue
        attributes = _unread_attributes(tree, element)
        if element not in tree.touched:
            if attributes or len(element):
                yield element, {}
            continue
        if attributes:
            yield element, attributes
        waiting.extend(part for part in reversed(element) if isinstance(part.tag, str))


def _unread_attributes(tree: OpenScenarioFile, element: etree._Element) -> dict[str, str]:
    names = map(str, element.keys()[:_MAX_ATTRIBUTES])
    values = {name: element.get(name, "") for name in names}
    return {name: value for name, value in values.items() if _is_left(tree, element, name, value)}


def _is_left(tree: OpenScenarioFile, element: etree._Element, attribute: str, value: str) -> bool:
    """Return whether an attribute means something that was not read."""
    if attribute.startswith("{") or (element, attribute) in tree.attributes:
        return False
    if name_of(element) in _PLAIN or (attribute == "name" and name_of(element) != "Property"):
        return False
    if attribute in _OFF_GROUND:
        return not _is_zero(value)
    return value.strip() not in _USUAL.get(attribute, ())


def _is_zero(value: str) -> bool:
    try:
        return double(value) == 0.0
    except ValueError:
        return False


def _parameter_faults(top: etree._Element) -> Iterator[Issue]:
    """Yield the parameters that are declared twice, or whose type and value disagree."""
    for holder in top.iter():
        if name_of(holder) != "ParameterDeclarations":
            continue
        names = set()
        for declaration in holder:
            name = declaration.get("name", "") if isinstance(declaration.tag, str) else ""
            if not name:
                continue
            if name in names:
                fault = f"{name[:_LONGEST_VALUE]!r} is declared again; the last counts"
                yield Issue(where(declaration), fault)
            names.add(name)
            if declaration.get("parameterType") in _INTEGERS and _has_fraction(declaration):
                value = declaration.get("value", "")[:_LONGEST_VALUE]
                yield Issue(where(declaration), f"{value!r} is read though no integer")


def _has_fraction(declaration: etree._Element) -> bool:
    try:
        return not double(declaration.get("value", "0")).is_integer()
    except ValueError:
        return False  # Another parameter's value.
