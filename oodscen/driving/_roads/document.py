"""Parses untrusted XML: no entities, no network, and limits on size, depth and numbers."""

import re
from collections.abc import Iterator
from typing import Literal, NoReturn

from lxml import etree

from oodscen._io.xml_numbers import double
from oodscen.errors import DataError, Issue

MAX_BYTES = 32 * 1024 * 1024
MAX_DEPTH = 32
"""Largest nesting of elements."""
MAX_ELEMENTS = 1_000_000
_MAX_NUMBER = 1e7
"""Largest magnitude of a number, of whatever unit."""
_MAX_DIGITS = 64
_MAX_LANE_ID = 5
"""Most characters of a lane's id."""
_LANE_ID = re.compile(r"[ \t\r\n]*[+-]?[0-9]+[ \t\r\n]*")
_MAX_ISSUES = 100


class Document:
    """An XML file and its faults.

    A fault does not stop the search for more, unless nothing can be read after it.
    """

    def __init__(self, source: str, root: str = "OpenDRIVE") -> None:
        self.source = source
        self.root = root
        """Name of the root element, and of the format."""
        self.issues: list[Issue] = []

    def parse(self, data: bytes) -> "XmlNode":
        """Return the root element.

        Raises:
            DataError: If the bytes are not a file of this format, or too large or deep.
        """
        if len(data) > MAX_BYTES:
            self.fail("", f"the file has {len(data)} bytes; at most {MAX_BYTES} are read")
        parser = etree.XMLParser(
            resolve_entities=False,
            no_network=True,
            huge_tree=False,
            load_dtd=False,
            dtd_validation=False,
            remove_comments=True,
            remove_pis=True,
        )
        try:
            root = etree.fromstring(data, parser)
        except (etree.XMLSyntaxError, ValueError) as error:
            self.fail("", f"not well-formed XML: {str(error)[:200]}")
        if root.getroottree().docinfo.internalDTD is not None:
            self.fail("", "a document type declaration is not allowed")
        if _depth(root) > MAX_DEPTH:
            self.fail("", f"elements are nested more than {MAX_DEPTH} deep")
        if name_of(root) != self.root:
            self.fail("", f"the root element is {name_of(root)[:40]!r}, not {self.root!r}")
        count = sum(1 for _ in root.iter())
        if count > MAX_ELEMENTS:
            self.fail("", f"the file has {count} elements; at most {MAX_ELEMENTS} are read")
        return XmlNode(self, root, "")

    def error(self) -> DataError:
        """Return all recorded faults as one error."""
        return DataError(f"{self.root} file", self.issues, source=self.source)

    def fail(self, path: str, message: str) -> NoReturn:
        """Record a fault after which nothing can be read, and raise the error."""
        self.add(path, message)
        raise self.error()

    def add(self, path: str, message: str) -> None:
        """Record a fault; from the hundred-and-first on, faults are dropped."""
        if len(self.issues) < _MAX_ISSUES:
            self.issues.append(Issue(path, message))


class XmlNode:
    """One element of a file, which records faults at its place."""

    __slots__ = ("document", "element", "path")

    def __init__(self, document: Document, element: etree._Element, path: str) -> None:
        self.document = document
        self.element = element
        self.path = path

    def get(self, name: str, default: str = "", *, longest: int | None = None) -> str:
        """Return an attribute, cut to a length, or the default."""
        return self.element.get(name, default)[:longest]

    @property
    def label(self) -> str:
        """The element's id, shortened for a message."""
        return self.get("id", "?", longest=40)

    def fault(self, message: str, at: str = "") -> None:
        """Record a fault here, or at a place within, such as `@length`."""
        self.document.add(f"{self.path}{at}", message)

    def number(
        self, name: str, *, default: float | None = None, limit: float = _MAX_NUMBER
    ) -> float:
        """Return a finite attribute, or the default after recording a fault."""
        fallback = 0.0 if default is None else default
        text = self.element.get(name)
        if text is None:
            if default is None:
                self.fault("is missing", f"@{name}")
            return fallback
        try:
            if len(text) > _MAX_DIGITS:
                raise ValueError
            value = double(text)
        except ValueError:
            self.fault(f"{text[:40]!r} is not a number", f"@{name}")
            return fallback
        if abs(value) > limit:
            self.fault(f"{text[:40]} is not within +-{limit:g}", f"@{name}")
            return fallback
        return value

    def lane_id(self, name: str = "id") -> int | None:
        """Return an attribute that is a lane's id; record a fault if it is invalid."""
        text = self.element.get(name)
        if text is None:
            self.fault("is missing", f"@{name}")
        elif len(text) > _MAX_LANE_ID or not _LANE_ID.fullmatch(text):
            self.fault(f"{text[:40]!r} is not a lane id", f"@{name}")
        else:
            return int(text)
        return None

    def at(self, path: str) -> "XmlNode":
        """Return the same element with another path below its parent's."""
        return XmlNode(self.document, self.element, path)

    def all(self, *names: str, by: Literal["index", "id", "name"] = "index") -> list["XmlNode"]:
        """Return the elements at the end of a path of names, from this one's children down, in order.

        Messages tell elements of one name apart by their index or id.
        """
        elements = [self.element]
        for name in names:
            elements = [child for parent in elements for child in parent if name_of(child) == name]
        path = f"{self.path}/{'/'.join(names)}" if self.path else "/".join(names)
        nodes = []
        for index, element in enumerate(elements):
            node = XmlNode(self.document, element, path)
            if by != "name":
                node.path = f"{path}[{index if by == 'index' else node.label}]"
            nodes.append(node)
        return nodes

    def first(self, *names: str) -> "XmlNode | None":
        """Return the first element at the end of a path of names, or `None`."""
        return next(iter(self.all(*names, by="name")), None)

    def limited(
        self, nodes: list["XmlNode"], limit: int, things: str, at: str = ""
    ) -> list["XmlNode"]:
        """Return the nodes, which are things of this plural, up to the limit; record a fault if there are more."""
        if len(nodes) > limit:
            self.fault(f"{len(nodes)} {things}; at most {limit} are read", at)
        return nodes[:limit]


def name_of(element: etree._Element) -> str:
    """Return an element's name without its namespace."""
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def _depth(root: etree._Element) -> int:
    """Return the nesting depth of elements, without recursion."""
    level: Iterator[etree._Element]
    deepest, level = 0, iter([root])
    while members := list(level):
        deepest += 1
        if deepest > MAX_DEPTH:
            break
        level = (child for member in members for child in member)
    return deepest
