"""XML elements with attributes of plain values."""

import numpy as np
from lxml import etree

Element = etree._Element
Value = str | int | float | bool

_DATE = "2026-01-01T00:00:00"
"""Date in every header: the same scene gives the same bytes."""
_DECIMALS = 6
"""Decimals of a number: micrometres and microradians."""


def document(road: str) -> Element:
    """Return a document that refers to the file of a road, without its header."""
    root = etree.Element("OpenSCENARIO")
    child(root, "CatalogLocations")
    child(child(root, "RoadNetwork"), "LogicFile", filepath=road)
    return root


def file_header(root: Element, minor: int, description: str) -> Element:
    """Insert the header of version 1.`minor` before everything else, and return it."""
    header = etree.Element("FileHeader")
    values = (("revMajor", 1), ("revMinor", minor), ("date", _DATE), ("description", description))
    for name, value in (*values, ("author", "oodscen")):
        header.set(name, attribute_text(value))
    root.insert(0, header)
    return header


def to_bytes(root: Element) -> bytes:
    """Return a document as an indented file; the document is indented in place."""
    etree.indent(root)
    return etree.tostring(root, encoding="UTF-8", xml_declaration=True)


def child(parent: Element, tag: str, **attributes: Value) -> Element:
    """Append an element to a parent and return it."""
    return etree.SubElement(
        parent, tag, {name: attribute_text(value) for name, value in attributes.items()}
    )


def within(parent: Element, *tags: str) -> Element:
    """Append a chain of nested elements without attributes and return the innermost."""
    for tag in tags:
        parent = etree.SubElement(parent, tag)
    return parent


def attribute_text(value: Value) -> str:
    """Return the text of an attribute; numbers have at most six decimals and no exponent."""
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, float):
        text = f"{value:.{_DECIMALS}f}".rstrip("0").rstrip(".")
        return "0" if text in ("-0", "") else text
    return str(value)
