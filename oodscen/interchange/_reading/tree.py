"""The tree of an OpenSCENARIO file with its parameters and catalogue references resolved."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

from lxml import etree

from oodscen._files import read_regular
from oodscen.driving._roads.document import MAX_BYTES, Document, name_of
from oodscen.errors import DataError, Issue
from oodscen.interchange._reading.expressions import substituted

Scope = Mapping[str, str]

NOUN = "OpenSCENARIO file"
_LARGEST = 1e9
_DEEPEST = 6
"""Maximum number of catalogue references within each other."""
_MAX_CATALOGUES = 200
_MAX_REFERENCES = 20_000
"""Maximum number of catalogue references that are followed in one file, repetitions included."""


class ScenarioTree:
    """One file, the catalogues that it names, and the elements that a scene cannot hold."""

    def __init__(self, path: str | Path) -> None:
        """Read the file.

        Raises:
            DataError: If it is not an OpenSCENARIO file, or too large or deep.
        """
        self.path = Path(path)
        data = read_regular(path, NOUN, limit=MAX_BYTES)
        element = Document(str(path), "OpenSCENARIO").parse(data).element
        self.omissions: list[Issue] = []
        self._catalogues: dict[str, etree._Element] | None = None
        self._followed = 0
        self.root = Node(self, element, {})
        if self.root.first("Storyboard") is None:
            raise self.root.fault("has no Storyboard: it is a catalogue or a distribution")

    def entry(self, reference: "Node", depth: int) -> "Node":
        """Return the catalogue entry that a reference names, with its parameters assigned.

        Raises:
            DataError: If there is no such catalogue or entry.
        """
        if depth > _DEEPEST:
            raise reference.fault(f"catalogue references are nested more than {_DEEPEST} deep")
        self._followed += 1
        if self._followed > _MAX_REFERENCES:
            raise reference.fault(f"more than {_MAX_REFERENCES} catalogue references are followed")
        name = reference.get("entryName")
        found = self._entries().get(name)
        if found is None:
            raise reference.fault(f"no catalogue has an entry {name[:60]!r}")
        given = {}
        for one in reference.element.iter():
            if name_of(one) == "ParameterAssignment":
                assigned = Node(self, one, reference.scope)
                given[one.get("parameterRef", "").lstrip("$")] = assigned.get("value")
        declared = declarations(found)
        return Node(self, found, {**reference.scope, **declared, **given}, depth + 1, given)

    def _entries(self) -> dict[str, etree._Element]:
        """Return the entries of all catalogues beside the file, by name."""
        if self._catalogues is None:
            self._catalogues = {}
            for folder in self._folders():
                for path in sorted(folder.glob("*.xosc"))[:_MAX_CATALOGUES]:
                    self._catalogues.update(_entries_of(path))
        return self._catalogues

    def _folders(self) -> Iterator[Path]:
        for one in self.root.element.iter():
            if name_of(one) == "Directory":
                folder = self.path.parent / Node(self, one, self.root.scope).get("path")
                if folder.is_dir():
                    yield folder


def _entries_of(path: Path) -> dict[str, etree._Element]:
    try:
        root = Document(str(path), "OpenSCENARIO").parse(
            read_regular(path, "catalogue", limit=MAX_BYTES)
        )
    except DataError:
        return {}  # References to it fail as missing entries.
    found = {}
    for catalogue in root.all("Catalog"):
        for entry in catalogue.element:
            if isinstance(entry.tag, str) and entry.get("name"):
                found[entry.get("name", "")] = entry
    return found


def declarations(element: etree._Element) -> dict[str, str]:
    """Return the parameters that an element declares itself, by name, as written."""
    return {
        one.get("name", ""): one.get("value", "")
        for child in element
        if name_of(child) == "ParameterDeclarations"
        for one in child
        if name_of(one) == "ParameterDeclaration"
    }


class Node:
    """One element with the parameters that hold there; references read as what they refer to."""

    __slots__ = ("depth", "element", "scope", "tree")

    def __init__(
        self,
        tree: ScenarioTree,
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
        return f"line {self.element.sourceline}: {self.name}"

    def fault(self, message: str, attribute: str = "") -> DataError:
        """Return the error that refuses the file for a fault here."""
        where = f"{self.where} @{attribute}" if attribute else self.where
        return DataError(NOUN, [Issue(where, message)], source=str(self.tree.path))

    def leave_out(self, why: str) -> None:
        """Record that a scene cannot hold this element."""
        issue = Issue(self.where, why)
        if issue not in self.tree.omissions:
            self.tree.omissions.append(issue)

    def get(self, name: str, default: str = "") -> str:
        """Return an attribute with its parameters replaced.

        Raises:
            DataError: If a parameter is unknown or cyclic.
        """
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
            value = float(text)
        except ValueError:
            value = math.nan
        if not abs(value) <= _LARGEST:
            raise self.fault(f"{text[:40]!r} is not a number within +-1e9", name)
        return value

    def children(self) -> Iterator["Node"]:
        """Yield the child elements, with catalogue references resolved."""
        for one in self.element:
            if not isinstance(one.tag, str):
                continue
            node = Node(self.tree, one, self.scope, self.depth)
            yield self.tree.entry(node, self.depth) if node.name == "CatalogReference" else node

    def first(self, *names: str) -> "Node | None":
        """Return the first element at the end of a chain of names, or `None`."""
        found: Node | None = self
        for name in names:
            if found is None:
                return None
            found = next((one for one in found.children() if one.name == name), None)
        return found

    def all(self, *names: str) -> list["Node"]:
        """Return the elements at the end of a chain of names, in order."""
        found = [self]
        for name in names:
            found = [one for parent in found for one in parent.children() if one.name == name]
        return found

    def within(self, name: str) -> Iterator["Node"]:
        """Yield all descendants of a name, references resolved."""
        for one in self.children():
            if one.name == name:
                yield one
            yield from one.within(name)
