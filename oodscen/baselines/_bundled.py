"""Records that ship with this package."""

from typing import Literal, TypeVar

from oodscen._io.files import bundled
from oodscen.data._base import Data

Split = Literal["tune", "frozen"]
"""Half of a set of texts: to choose settings, or to report results."""
Record = TypeVar("Record", bound=Data)


def bundled_records(kind: type[Record], name: str) -> tuple[Record, ...]:
    """Return the records of a file of JSON lines that ships with this package."""
    lines = bundled(name, "oodscen.baselines").rstrip("\n").split("\n")
    return tuple(kind.parse(line, source=name) for line in lines)
