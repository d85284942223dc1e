"""Parts of an OpenSCENARIO file from which nothing was read."""

from collections.abc import Iterator, Mapping

from lxml import etree

from oodscen._xml_numbers import double
from oodscen.driving._roads.document import name_of
from oodscen.errors import Issue
from oodscen.interchange._reading.tree import OpenScenarioFile, where

_SILENT = {
    "FileHeader",
    "CatalogLocations",
    "ParameterDeclarations",
    "Properties",
    "BoundingBox",
    "Performance",
    "Axles",
}
"""Elements that say nothing of a scene, or what an asset says in their place."""
_BODIES = {"Vehicle", "Pedestrian", "MiscObject"}
"""Elements whose attributes an asset stands for."""
_UPRIGHT = {"z", "p", "r", "dz"}
"""Attributes by which a body leaves the road's surface; zero is on it."""
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
_LONGEST, _MOST = 60, 6
"""Characters of a value, and attributes of an element, that a note has at most."""
_MOST_LOOKED_AT = 100
"""Attributes of one element that are looked at: the standard has none with more, and each look-up takes longer."""


def leftovers(tree: OpenScenarioFile) -> Iterator[Issue]:
    """Yield the parts of a file that have not been read, and what its parameters say twice.

    Parts of one kind are one issue, at the first of them.
    """
    kinds: dict[tuple[str, ...], list[Issue]] = {}
    for top in (tree.root.element, *tree.entered):
        for element, attributes in _unread(tree, top):
            issue = Issue(where(element), f"{_said(attributes)} is not read".lstrip())
            kinds.setdefault((name_of(element), *attributes), []).append(issue)
        yield from _declared(top)
    for first, *others in kinds.values():
        yield _and_more(first, len(others))


def _and_more(issue: Issue, count: int) -> Issue:
    return Issue(issue.path, f"{issue.message}, and so {count} more") if count else issue


def _said(attributes: Mapping[str, str]) -> str:
    """Return some attributes as they are written, shortened."""
    some = [f"{name}={value[:_LONGEST]!r}" for name, value in attributes.items()][:_MOST]
    return ", ".join([*some, "..."] if len(attributes) > _MOST else some)


def _unread(
    tree: OpenScenarioFile, top: etree._Element
) -> Iterator[tuple[etree._Element, dict[str, str]]]:
    """Yield the elements that were not read, and those of which these attributes were not."""
    waiting = [top]
    while waiting:
        element = waiting.pop()
        if element in tree.settled or name_of(element) in _SILENT:
            continue
        names = map(str, element.keys()[:_MOST_LOOKED_AT])
        said = ((name, element.get(name, "")) for name in names)
        attributes = {name: value for name, value in said if _is_left(tree, element, name, value)}
        if element not in tree.touched:
            if attributes or len(element):
                yield element, {}
            continue
        if attributes:
            yield element, attributes
        waiting.extend(one for one in reversed(element) if isinstance(one.tag, str))


def _is_left(tree: OpenScenarioFile, element: etree._Element, attribute: str, value: str) -> bool:
    """Return whether an attribute says something that was not read."""
    if attribute == "name" or attribute.startswith("{") or name_of(element) in _BODIES:
        return False
    if (element, attribute) in tree.attributes:
        return False
    if attribute in _UPRIGHT:
        return not _is_zero(value)
    return value.strip() not in _USUAL.get(attribute, ())


def _is_zero(value: str) -> bool:
    try:
        return double(value) == 0.0
    except ValueError:
        return False


def _declared(top: etree._Element) -> Iterator[Issue]:
    """Yield the parameters that are declared twice, or of which the type and the value disagree."""
    for holder in top.iter():
        if name_of(holder) != "ParameterDeclarations":
            continue
        names = set()
        for element in holder:
            name = element.get("name", "") if isinstance(element.tag, str) else ""
            if name and name in names:
                yield Issue(
                    where(element), f"{name[:_LONGEST]!r} is declared again; the last counts"
                )
            names.add(name)
            if name and element.get("parameterType") in _INTEGERS and _has_fraction(element):
                yield Issue(
                    where(element),
                    f"{element.get('value', '')[:_LONGEST]!r} is read though no integer",
                )


def _has_fraction(declaration: etree._Element) -> bool:
    try:
        return not double(declaration.get("value", "0")).is_integer()
    except ValueError:
        return False  # Another parameter's value.
