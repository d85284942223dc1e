"""XML elements with attributes of plain values."""

import numpy as np
from lxml import etree

Element = etree._Element
Value = str | int | float | bool

_DECIMALS = 6
"""Decimals of a number: micrometres and microradians."""


def child(parent: Element, tag: str, **attributes: Value) -> Element:
    """Append an element to a parent and return it."""
    return etree.SubElement(
        parent, tag, {name: written(value) for name, value in attributes.items()}
    )


def within(parent: Element, *tags: str) -> Element:
    """Append a chain of nested elements without attributes and return the innermost."""
    for tag in tags:
        parent = etree.SubElement(parent, tag)
    return parent


def written(value: Value) -> str:
    """Return the text of an attribute; numbers have at most six decimals and no exponent."""
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, float):
        text = f"{value:.{_DECIMALS}f}".rstrip("0").rstrip(".")
        return "0" if text in ("-0", "") else text
    return str(value)
