"""The tree of an OpenSCENARIO file with its parameters and catalogue references resolved."""

import math
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from lxml import etree

from oodscen._io.files import read_regular
from oodscen._io.xml_numbers import double
from oodscen.driving._roads.document import MAX_BYTES, Document, name_of
from oodscen.errors import DataError, Issue
from oodscen.interchange._reading.expressions import Scope

NOUN = "OpenSCENARIO file"
_TRACES = (".osi", ".mcap")
"""Suffixes of traces of runs, which are no scenarios."""
_MAX_NUMBER = 1e9
_MAX_DEPTH = 6
"""Maximum number of catalogue references within each other."""
_MAX_CATALOGUES = 200
"""Maximum number of files that are read in one folder of catalogues."""
_MAX_REFERENCES = 20_000
"""Maximum number of catalogue references that are followed in one file, repetitions included."""


class OpenScenarioFile:
    """One file, the catalogues that it names, what was read of them, and what a scene cannot hold."""

    def __init__(self, path: str | Path) -> None:
        """Read the file.

        Raises:
            DataError: If it is not an OpenSCENARIO file, or too large or deep.
        """
        self.path = Path(path)
        if self.path.suffix.lower() in _TRACES:
            fault = "is a trace of a run, which `oodscen verdict` reads, not a scenario"
            raise DataError(NOUN, [Issue("", fault)], source=str(path))
        data = read_regular(path, NOUN, limit=MAX_BYTES)
        element = Document(str(path), "OpenSCENARIO").parse(data).element
        self.omissions: dict[Issue, None] = {}
        """Elements that a scene cannot hold, or that are read otherwise than written, in the order of reading."""
        self.attributes: set[tuple[etree._Element, str]] = set()
        """Attributes that were read."""
        self.touched: set[etree._Element] = set()
        """Elements that were read themselves or below."""
        self.settled: set[etree._Element] = set()
        """Elements that need no further note: they are listed as left out, or mean nothing here."""
        self.entered: dict[etree._Element, None] = {}
        """Catalogue entries that references were resolved to."""
        self._catalogues: _Catalogues | None = None
        self._followed = 0
        self.root = Element(self, element, Scope({}))
        if self.root.first("Storyboard") is None:
            raise self.root.fault("has no Storyboard: it is a catalogue or a distribution")

    def header(self) -> "Element":
        """Return the header.

        Raises:
            DataError: If there is none.
        """
        header = self.root.first("FileHeader")
        if header is None:
            raise self.root.fault("has no FileHeader")
        return header

    def missing(self, issue: Issue) -> DataError:
        """Return the error for the lack of what a scene must have, with all omissions, which may be its cause."""
        return DataError(NOUN, [issue, *self.omissions], source=str(self.path))

    def entry(self, reference: "Element", depth: int) -> "Element":
        """Return the catalogue entry that a reference names, with its parameters assigned.

        Raises:
            DataError: If there is no such catalogue or entry.
        """
        if depth > _MAX_DEPTH:
            raise reference.fault(f"catalogue references are nested more than {_MAX_DEPTH} deep")
        self._followed += 1
        if self._followed > _MAX_REFERENCES:
            raise reference.fault(f"more than {_MAX_REFERENCES} catalogue references are followed")
        element = self._entry(reference)
        assigned = self._assigned(reference)
        self.entered[element] = None
        return Element(self, element, reference.scope, depth + 1, assigned)

    def touch(self, element: etree._Element) -> None:
        """Record that an element is read, and with it that those around it are entered."""
        ancestor: etree._Element | None = element
        while ancestor is not None and ancestor not in self.touched:
            self.touched.add(ancestor)
            ancestor = ancestor.getparent()

    def _assigned(self, reference: "Element") -> dict[str, str]:
        """Return the parameters of a catalogue entry that a reference assigns."""
        assigned = {}
        for element in reference.element.iter():
            if name_of(element) == "ParameterAssignment":
                assignment = Element(self, element, reference.scope)
                assigned[assignment.get("parameterRef").lstrip("$")] = assignment.get("value")
        return assigned

    def _entry(self, reference: "Element") -> etree._Element:
        """Return the entry that a reference names."""
        if self._catalogues is None:
            self._catalogues = _Catalogues(self._folders())
        catalogue, name = reference.get("catalogName"), reference.get("entryName")
        elements = self._catalogues.entries.get((catalogue, name), [])
        if not elements:
            message = f"no catalogue {catalogue[:60]!r} has an entry {name[:60]!r}"
            raise reference.fault("; ".join([message, *self._catalogues.faults]))
        if len(elements) > 1:
            reference.note(
                f"the entry {name[:60]!r} occurs {len(elements)} times; the first counts"
            )
        if name_of(elements[0]) == "CatalogReference":
            raise reference.fault(f"the entry {name[:60]!r} is a reference itself")
        return elements[0]

    def _folders(self) -> Iterator[Path]:
        for element in self.root.element.iter():
            if name_of(element) == "Directory":
                yield self.path.parent / Element(self, element, self.root.scope).get("path")


class _Catalogues:
    """The entries of the catalogues in some folders."""

    def __init__(self, folders: Iterable[Path]) -> None:
        self.entries: dict[tuple[str, str], list[etree._Element]] = {}
        self.faults: list[str] = []
        """Reasons why folders and files could not be read."""
        for folder in dict.fromkeys(folder.resolve() for folder in folders):
            if not os.path.isdir(folder):  # False also for a name that is too long.
                self.faults.append(f"there is no folder {folder.name[:60]!r}")
                continue
            paths = sorted(folder.glob("*.xosc"))
            for path in paths[:_MAX_CATALOGUES]:
                self._add(path)
            if len(paths) > _MAX_CATALOGUES:
                excess = len(paths) - _MAX_CATALOGUES
                self.faults.append(f"the last {excess} files in {folder.name[:60]!r} are not read")

    def _add(self, path: Path) -> None:
        try:
            data = read_regular(path, "catalogue", limit=MAX_BYTES)
            root = Document(str(path), "OpenSCENARIO").parse(data)
            root.element.getroottree().docinfo.URL = path.name
        except DataError as error:
            self.faults.append(f"{path.name} cannot be read: {error.issues[0].message[:200]}")
            return
        for catalogue in root.all("Catalog"):
            for entry in catalogue.element:
                if isinstance(entry.tag, str) and (name := entry.get("name")):
                    key = catalogue.element.get("name", ""), name
                    self.entries.setdefault(key, []).append(entry)


def declarations(element: etree._Element) -> dict[str, str]:
    """Return the parameters that an element declares itself, by name, as written."""
    return {
        declaration.get("name", ""): declaration.get("value", "")
        for child in element
        if name_of(child) == "ParameterDeclarations"
        for declaration in child
        if name_of(declaration) == "ParameterDeclaration"
    }


def where(element: etree._Element) -> str:
    """Return the line, the catalogue's file if it is in one, and the element, for messages."""
    file = f" of {element.base}" if element.base else ""
    return f"line {element.sourceline}{file}: {name_of(element)}"


class Element:
    """One element with the parameters that hold there; references read as what they refer to."""

    __slots__ = ("depth", "element", "scope", "tree")

    def __init__(
        self,
        tree: OpenScenarioFile,
        element: etree._Element,
        scope: Scope,
        depth: int = 0,
        assigned: Mapping[str, str] | None = None,
    ) -> None:
        self.tree = tree
        self.element = element
        self.scope = scope.within({**declarations(element), **(assigned or {})})
        self.depth = depth

    @property
    def name(self) -> str:
        """The element's name."""
        return name_of(self.element)

    @property
    def where(self) -> str:
        """The line and the element, for messages."""
        return where(self.element)

    def fault(self, message: str, attribute: str = "") -> DataError:
        """Return the error that refuses the file for a fault here."""
        path = f"{self.where} @{attribute}" if attribute else self.where
        return DataError(NOUN, [Issue(path, message)], source=str(self.tree.path))

    def leave_out(self, reason: str) -> None:
        """Record that a scene cannot hold this element."""
        self.note(reason)
        self.settle()

    def note(self, message: str) -> None:
        """Record that this element is read otherwise than it is written."""
        self.tree.omissions[Issue(self.where, message)] = None

    def touch(self) -> "Element":
        """Record that this element is read, and return it."""
        self.tree.touch(self.element)
        return self

    def settle(self) -> None:
        """Record that this element and those in it need no further note."""
        self.tree.touch(self.element)
        self.tree.settled.add(self.element)

    def get(self, name: str, default: str = "") -> str:
        """Return an attribute with its parameters replaced.

        Raises:
            DataError: If a parameter is unknown or cyclic.
        """
        self.tree.touch(self.element)
        self.tree.attributes.add((self.element, name))
        text = self.element.get(name)
        if text is None:
            return default
        try:
            return self.scope.substituted(text)
        except ValueError as error:
            raise self.fault(str(error), name) from None

    def number(self, name: str, default: float | None = None) -> float:
        """Return a finite attribute.

        Raises:
            DataError: If it is missing without a default, or no number.
        """
        text = self.get(name)
        if not text and default is not None:
            return default
        try:
            value = double(text)
        except ValueError:
            value = math.inf
        if abs(value) > _MAX_NUMBER:
            raise self.fault(f"{text[:40]!r} is not a number within +-1e9", name)
        return value

    def integer(self, name: str) -> int:
        """Return an integer attribute.

        Raises:
            DataError: If it is missing, or no integer.
        """
        value = self.number(name)
        if not value.is_integer():
            raise self.fault(f"{value:g} is not an integer", name)
        return int(value)

    def is_true(self, name: str) -> bool:
        """Return whether an attribute is true; a missing one is not."""
        return self.word(name, "false", "true", "0", "1") in ("true", "1")

    def word(self, name: str, usual: str, *others: str) -> str:
        """Return an attribute that is one of some words: the usual one if it is missing, or unknown and noted."""
        word = self.get(name).strip() or usual
        if word in (usual, *others):
            return word
        self.note(f"{name}={word[:40]!r} is read as {usual!r}")
        return usual

    def bounded(self, value: float, low: float, high: float, quantity: str) -> float:
        """Return the value between two limits that is nearest to one of this element, and note a difference.

        `quantity` begins the note: "a speed of".
        """
        nearest = min(max(value, low), high)
        if nearest != value:
            self.note(f"{quantity} {value:g} is read as {nearest:g}")
        return nearest

    def children(self) -> Iterator["Element"]:
        """Yield the child elements, with catalogue references resolved."""
        for element in self.element:
            if not isinstance(element.tag, str):
                continue
            node = Element(self.tree, element, self.scope, self.depth)
            yield self.tree.entry(node, self.depth) if node.name == "CatalogReference" else node

    def first(self, *names: str) -> "Element | None":
        """Return the first element at the end of a chain of names, or `None`."""
        element: Element | None = self
        for name in names:
            if element is None:
                return None
            element = next((child for child in element.children() if child.name == name), None)
        return None if element is None else element.touch()

    def all(self, *names: str) -> list["Element"]:
        """Return the elements at the end of a chain of names, in order."""
        elements = [self]
        for name in names:
            elements = [
                child for parent in elements for child in parent.children() if child.name == name
            ]
        return [element.touch() for element in elements]

    def within(self, name: str) -> Iterator["Element"]:
        """Yield all descendants of a name, references resolved."""
        for child in self.children():
            if child.name == name:
                yield child.touch()
            yield from child.within(name)
