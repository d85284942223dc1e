"""The groups of texts that resemble one another, which are resampled together."""

from collections.abc import Sequence
from numbers import Integral

import numpy as np

from oodscen._numbers import said
from oodscen._words.text import path_name
from oodscen.data._scenario import Scenario
from oodscen.errors import UsageError

_LARGEST = 10**4_300
"""Bound of numbers that are labels, as Python writes no more digits."""


def group_name(label: object) -> str:
    """Return the name of a group: a label, a number, or the labels of a path.

    Raises:
        UsageError: If it is something else.
    """
    if isinstance(label, str):
        return label
    if isinstance(label, Integral) and not isinstance(label, bool) and abs(int(label)) < _LARGEST:
        return str(label)
    parts = list(label) if isinstance(label, Sequence | np.ndarray) else []
    if not parts or not all(isinstance(part, str) for part in parts):
        raise UsageError(
            f"each element of groups must be a label or a path of labels, not {said(label, 80)}"
        )
    return path_name(parts)


def paths_of(texts: Sequence[str | Scenario]) -> tuple[str, ...] | None:
    """Return the path of each text, for clustering; `None` unless all are scenarios with a path."""
    paths = [group_name(text.path) for text in texts if isinstance(text, Scenario) and text.path]
    return tuple(paths) if len(paths) == len(texts) else None
