"""The tree of an OpenSCENARIO file with its parameters and catalogue references resolved."""

import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from lxml import etree

from oodscen._files import read_regular
from oodscen._xml_numbers import double
from oodscen.driving._roads.document import MAX_BYTES, Document, name_of
from oodscen.errors import DataError, Issue
from oodscen.interchange._reading.expressions import substituted

Scope = Mapping[str, str]

NOUN = "OpenSCENARIO file"
_TRACES = (".osi", ".mcap")
"""Suffixes of traces of runs."""
_LARGEST = 1e9
_DEEPEST = 6
"""Maximum number of catalogue references within each other."""
_MAX_CATALOGUES = 200
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
        """Elements with nothing more to tell: they are listed as left out, or mean nothing here."""
        self.entered: dict[etree._Element, None] = {}
        """Catalogue entries that references were resolved to."""
        self._catalogues: _Catalogues | None = None
        self._followed = 0
        self.root = Element(self, element, {})
        if self.root.first("Storyboard") is None:
            raise self.root.fault("has no Storyboard: it is a catalogue or a distribution")

    def entry(self, reference: "Element", depth: int) -> "Element":
        """Return the catalogue entry that a reference names, with its parameters assigned.

        Raises:
            DataError: If there is no such catalogue or entry.
        """
        if depth > _DEEPEST:
            raise reference.fault(f"catalogue references are nested more than {_DEEPEST} deep")
        self._followed += 1
        if self._followed > _MAX_REFERENCES:
            raise reference.fault(f"more than {_MAX_REFERENCES} catalogue references are followed")
        element = self._entry(reference)
        given = {}
        for one in reference.element.iter():
            if name_of(one) == "ParameterAssignment":
                assigned = Element(self, one, reference.scope)
                given[assigned.get("parameterRef").lstrip("$")] = assigned.get("value")
        self.entered[element] = None
        declared = declarations(element)
        return Element(self, element, {**reference.scope, **declared, **given}, depth + 1, given)

    def touch(self, element: etree._Element) -> None:
        """Record that an element is read, and with it that those around it are entered."""
        one: etree._Element | None = element
        while one is not None and one not in self.touched:
            self.touched.add(one)
            one = one.getparent()

    def _entry(self, reference: "Element") -> etree._Element:
        """Return the entry that a reference names."""
        if self._catalogues is None:
            self._catalogues = _Catalogues(self._folders())
        catalogue, name = reference.get("catalogName"), reference.get("entryName")
        elements = self._catalogues.entries.get((catalogue, name), [])
        if not elements:
            message = f"no catalogue {catalogue[:60]!r} has an entry {name[:60]!r}"
            raise reference.fault("; ".join([message, *self._catalogues.unread]))
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
    """The entries of the catalogues in some folders, and the files that could not be read."""

    def __init__(self, folders: Iterable[Path]) -> None:
        self.entries: dict[tuple[str, str], list[etree._Element]] = {}
        self.unread: list[str] = []
        for folder in dict.fromkeys(one.resolve() for one in folders):
            if not folder.is_dir():
                self.unread.append(f"there is no folder {folder.name[:60]!r}")
                continue
            for path in sorted(folder.glob("*.xosc"))[:_MAX_CATALOGUES]:
                self._add(path)

    def _add(self, path: Path) -> None:
        try:
            data = read_regular(path, "catalogue", limit=MAX_BYTES)
            root = Document(str(path), "OpenSCENARIO").parse(data)
            root.element.getroottree().docinfo.URL = path.name
        except DataError as error:
            self.unread.append(f"{path.name} cannot be read: {error.issues[0].message[:200]}")
            return
        for catalogue in root.all("Catalog"):
            for entry in catalogue.element:
                if isinstance(entry.tag, str) and (name := entry.get("name")):
                    key = catalogue.element.get("name", ""), name
                    self.entries.setdefault(key, []).append(entry)


def declarations(element: etree._Element) -> dict[str, str]:
    """Return the parameters that an element declares itself, by name, as written."""
    return {
        one.get("name", ""): one.get("value", "")
        for child in element
        if name_of(child) == "ParameterDeclarations"
        for one in child
        if name_of(one) == "ParameterDeclaration"
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
        assigned: Scope | None = None,
    ) -> None:
        self.tree = tree
        self.element = element
        self.scope: Scope = {**scope, **declarations(element), **(assigned or {})}
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
        where = f"{self.where} @{attribute}" if attribute else self.where
        return DataError(NOUN, [Issue(where, message)], source=str(self.tree.path))

    def leave_out(self, why: str) -> None:
        """Record that a scene cannot hold this element."""
        self.note(why)
        self.settle()

    def note(self, what: str) -> None:
        """Record that this element is read otherwise than it is written."""
        self.tree.omissions[Issue(self.where, what)] = None

    def touched(self) -> "Element":
        """Return this node after recording that it is read."""
        self.tree.touch(self.element)
        return self

    def settle(self) -> None:
        """Record that nothing more is to be told of this element and those in it."""
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
            return substituted(text, self.scope)
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
        if abs(value) > _LARGEST:
            raise self.fault(f"{text[:40]!r} is not a number within +-1e9", name)
        return value

    def integer(self, name: str, default: int | None = None) -> int:
        """Return an integer attribute.

        Raises:
            DataError: If it is missing without a default, or no integer.
        """
        value = self.number(name, default)
        if not value.is_integer():
            raise self.fault(f"{value:g} is not an integer", name)
        return int(value)

    def is_true(self, name: str) -> bool:
        """Return whether an attribute is true; a missing one is not."""
        return self.word(name, "false", "true", "0", "1") in ("true", "1")

    def word(self, name: str, usual: str, *others: str) -> str:
        """Return an attribute that is one of some words, the usual one if it is missing or, as recorded, unknown."""
        word = self.get(name).strip() or usual
        if word in (usual, *others):
            return word
        self.note(f"{name}={word[:40]!r} is read as {usual!r}")
        return usual

    def bounded(self, value: float, low: float, high: float, what: str) -> float:
        """Return the value nearest to one of this element that a scene can hold, and record that it differs."""
        kept = min(max(value, low), high)
        if kept != value:
            self.note(f"{what} {value:g} is read as {kept:g}")
        return kept

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
        return element and element.touched()

    def all(self, *names: str) -> list["Element"]:
        """Return the elements at the end of a chain of names, in order."""
        elements = [self]
        for name in names:
            elements = [
                child for parent in elements for child in parent.children() if child.name == name
            ]
        return [element.touched() for element in elements]

    def within(self, name: str) -> Iterator["Element"]:
        """Yield all descendants of a name, references resolved."""
        for child in self.children():
            if child.name == name:
                yield child.touched()
            yield from child.within(name)
