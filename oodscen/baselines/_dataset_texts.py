"""Texts of public driving data sets, and issues where a file deviates from its format."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from oodscen.baselines._texts import fault_of
from oodscen.errors import Issue


class DatasetText(NamedTuple):
    """One text of a data set."""

    kind: str
    """The kind of text: `scene`, `qa`, `command` ..."""
    text: str


TextsAndIssues = Iterator[DatasetText | Issue]


def members_of(value: Any, where: str, noun: str) -> Iterator[tuple[str, dict[str, Any] | Issue]]:
    """Yield the members of an object that are objects too, each with its place, or an issue."""
    if not isinstance(value, dict):
        fault = "is missing" if value is None else f"is {type(value).__name__}, not an object"
        yield where, Issue(where, fault)
        return
    for name, content in value.items():
        path = f"{where}.{name}".removeprefix(".")
        if isinstance(content, dict):
            yield path, content
        else:
            yield path, Issue(path, f"is {type(content).__name__}, not a {noun}")


def texts_of(kind: str, value: Any, where: str) -> TextsAndIssues:
    """Yield one text, or nothing if it is empty."""
    if value is None or (isinstance(value, str) and not value.strip()):
        return
    if fault := fault_of(value):
        yield Issue(where, fault)
    else:
        yield DatasetText(kind, " ".join(value.split()))
