"""The properties of a test in the JUnit file: what it drove, and how that ended."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from oodscen._words.text import printable

if TYPE_CHECKING:
    from oodscen.pytest_plugin._driving import Drive

Properties = list[tuple[str, object]]
"""Names and values, as pytest keeps them."""


def drive_properties(drive: "Drive") -> Properties:
    """Return the figures and pictures of a test's drives, in order."""
    pictures = {id(driven.result): driven.pictures for driven in drive.drives}
    properties: Properties = []
    for result in drive.results:
        prefix = "oodscen.twin" if result.is_twin else "oodscen.drive"
        properties += [
            (f"{prefix}.driver", result.driver),
            (f"{prefix}.safe", str(result.passed).lower()),
            (f"{prefix}.min_ttc_s", result.min_ttc_s),
            (f"{prefix}.progress", result.progress),
            *(("oodscen.picture", str(path)) for path in pictures.get(id(result), ())),
        ]
    return properties


def with_properties(before: Iterable[tuple[str, object]], added: Properties) -> Properties:
    """Return the properties of a test with others, which replace those of the same names; `None` is left out."""
    names = {name for name, _ in added}
    others = [(name, value) for name, value in before if name not in names]
    return [*others, *((name, _text(value)) for name, value in added if value is not None)]


def _text(value: object) -> str:
    return printable(f"{value:g}" if isinstance(value, float) else str(value))
