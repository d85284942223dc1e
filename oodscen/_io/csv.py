"""Python's CSV reader: its faults in plain words, and its limit."""

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

_LIMIT = Lock()
"""Held while the limit of the process is changed."""


@contextmanager
def fields_up_to(characters: int) -> Iterator[None]:
    """Read fields of at least so many characters; the limit belongs to the process, and is restored."""
    with _LIMIT:
        before = csv.field_size_limit()
        csv.field_size_limit(max(before, characters))
        try:
            yield
        finally:
            csv.field_size_limit(before)


def csv_fault(error: csv.Error) -> str:
    """Return what is wrong with a CSV file; the module's own words name a limit of its code and an end of data."""
    words = str(error)
    if "field limit" in words:
        return f"a field has more than {csv.field_size_limit():,} characters"
    return "a quote is not closed" if "end of data" in words else words
