r"""Selection of texts: those inside a band of OOD-ness or rarity, and n of them by variety or by exposure.

    max-min         greedy: the next text is the one whose nearest chosen text is farthest. Within a factor
                    of 2 of the best smallest distance (Gonzalez, 1985). Prefers the rim: outliers come first.
    determinantal   greedy maximum a posteriori of a determinantal point process with the cosines as kernel: the
                    next text adds most volume (Chen, Zhang and Zhou, *Fast greedy MAP inference for
                    determinantal point process*, 2018). Spans directions; once as many texts as dimensions
                    are chosen, it falls back to max-min.

    commonest       by exposure: the texts that drivers meet most often, by the offline rarity.
    rarest          against exposure. Neither ever chooses a text without a rarity.

All are deterministic. For variety the first text is the one farthest from the mean of all, and ties go to the
first in order. Time grows with n times the number of candidates, memory with the number of
candidates times the smaller of n and d. Duplicates of a chosen text are taken last.

Pitfall: off-topic text and gibberish are the most diverse of all. Apply a band, and the guard, first.
"""

import math
from collections.abc import Sequence
from numbers import Real
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from oodscen._numbers import finite_number
from oodscen.data._base import Data
from oodscen.encoders._similarity import TIE, Vectors
from oodscen.errors import UsageError
from oodscen.metrics._oodness import Measure
from oodscen.metrics._rarity.estimates import estimate_texts

if TYPE_CHECKING:
    from oodscen.metrics._vectors.space import BaselineSpace

Method = Literal["max-min", "determinantal", "commonest", "rarest"]
BandMeasure = Measure | Literal["rarity"]
_NO_VOLUME = np.float32(1e-5)
"""Squared length of a residual up to which its row adds no volume."""


class Band(Data):
    """The texts of a set whose OOD-ness lies between two bounds (Remark 1 of the paper).

    The upper bound excludes far-fetched texts, the lower bound ordinary ones.
    """

    low: float | None
    """`None` without a lower bound."""
    high: float | None
    """`None` without an upper bound."""
    texts: tuple[str, ...]
    """The texts inside the band, bounds included, in their order."""
    indices: tuple[int, ...]
    """Their indices in the set."""
    scores: tuple[float | None, ...]
    """OOD-ness or rarity of every text of the set; `None` without a rarity."""
    below: int
    """Number of texts that are more ordinary than `low`."""
    above: int
    """Number of texts that are further out than `high`."""


class Selection(Data):
    """The chosen texts among the candidates; see `oodscen.metrics._selection`."""

    texts: tuple[str, ...]
    """The texts in the order of their selection; a longer selection starts with the same texts."""
    indices: tuple[int, ...]
    """Their indices among the candidates."""
    method: str
    low: float | None
    high: float | None
    inside: int
    """Number of candidates inside the band."""
    candidates: int


def band(
    space: "BaselineSpace", texts: Sequence[str], low: float, high: float, definition: BandMeasure
) -> Band:
    """Return the texts whose OOD-ness lies in [low, high]; see `Metrics.band`."""
    for name, bound, none in (("low", low, -math.inf), ("high", high, math.inf)):
        if not (isinstance(bound, Real) and bound == none):
            finite_number(name, bound)
    if not low <= high:
        raise UsageError(f"the band's lower bound {low} is above its upper bound {high}")
    values: Sequence[float | None]
    if definition == "rarity":
        values = _best_rarities(space, texts)
    else:
        values = space.scores(texts, definition).tolist()
    scored = [(index, value) for index, value in enumerate(values) if value is not None]
    inside = tuple(index for index, value in scored if low <= value <= high)
    return Band(
        low=None if low == -math.inf else low,
        high=None if high == math.inf else high,
        texts=tuple(texts[index] for index in inside),
        indices=inside,
        scores=tuple(values),
        below=sum(value < low for _, value in scored),
        above=sum(value > high for _, value in scored),
    )


def select(space: "BaselineSpace", inside: Band, n: int, method: Method) -> Selection:
    """Return n texts of a band by variety or by exposure; see `Metrics.select`.

    Raises:
        UsageError: If fewer lie inside, or fewer have a rarity.
    """
    if n > len(inside.indices):
        raise UsageError(
            f"{n} texts cannot be chosen: {len(inside.indices)} of {len(inside.scores)} lie inside the band; "
            "widen it, or choose fewer"
        )
    if method in ("commonest", "rarest"):
        chosen = _by_exposure(space, inside.texts, n, is_rarest=method == "rarest")
    else:
        chosen = most_diverse(space.vectors(inside.texts), n, method)
    return Selection(
        texts=tuple(inside.texts[index] for index in chosen),
        indices=tuple(inside.indices[index] for index in chosen),
        method=method,
        low=inside.low,
        high=inside.high,
        inside=len(inside.indices),
        candidates=len(inside.scores),
    )


def _by_exposure(
    space: "BaselineSpace", texts: Sequence[str], n: int, *, is_rarest: bool
) -> NDArray[np.int64]:
    """Return the indices of the n commonest or rarest texts, of texts met as often the first."""
    sign = -1.0 if is_rarest else 1.0
    ranked = sorted(
        (sign * log10_km, index)
        for index, log10_km in enumerate(_best_rarities(space, texts))
        if log10_km is not None
    )
    if len(ranked) < n:
        raise UsageError(f"{n} texts cannot be chosen: only {len(ranked)} have a rarity")
    return np.array([index for _, index in ranked[:n]], np.int64)


def _best_rarities(space: "BaselineSpace", texts: Sequence[str]) -> list[float | None]:
    return [rarity.best for rarity in estimate_texts(space, texts)[1]]


def most_diverse(vectors: Vectors, n: int, method: Method = "max-min") -> NDArray[np.int64]:
    """Return the indices of the n of [m, d] unit rows that differ most, in the order of their selection.

    Raises:
        UsageError: If there are fewer rows, or no such method.
    """
    if not 0 < n <= len(vectors):
        raise UsageError(f"{n} texts cannot be chosen from {len(vectors)}")
    if method not in ("max-min", "determinantal"):
        raise UsageError(
            f"unknown selection {method!r}: expected max-min, determinantal, commonest or rarest"
        )
    rows = np.ascontiguousarray(vectors, np.float32)
    first = _first_least(rows @ rows.mean(axis=0, dtype=np.float64).astype(np.float32))
    if method == "max-min":
        return _spread(rows, [first], n)
    return _spread(rows, _spanning(rows, first, n), n)


def _spread(rows: Vectors, chosen: list[int], n: int) -> NDArray[np.int64]:
    """Return the chosen rows followed by those that lie farthest from them, n in all."""
    indices: list[int] = []
    largest_cosine = np.full(len(rows), -np.inf, np.float32)
    while len(indices) < n:
        is_given = len(indices) < len(chosen)
        index = chosen[len(indices)] if is_given else _first_least(largest_cosine)
        indices.append(index)
        np.maximum(largest_cosine, rows @ rows[index], out=largest_cosine)
        largest_cosine[index] = np.inf
    return np.array(indices, np.int64)


def _spanning(rows: Vectors, first: int, n: int) -> list[int]:
    """Return rows chosen by the volume that each adds, until none adds any.

    The residual of every row, after projecting out the chosen rows, has the length that a Cholesky factor of the
    kernel has on its diagonal. Directions of d values thus replace its columns of m values.
    """
    most = min(n, rows.shape[1])
    residual = np.square(rows).sum(axis=1)
    directions = np.zeros((most, rows.shape[1]), np.float32)
    chosen: list[int] = []
    index = first
    while len(chosen) < most and (not chosen or residual[index] > _NO_VOLUME):
        basis = directions[: len(chosen)].astype(np.float64)
        direction = rows[index].astype(np.float64)
        # Twice, because one Gram-Schmidt pass loses rows that are nearly spanned.
        direction -= basis.T @ (basis @ direction)
        direction -= basis.T @ (basis @ direction)
        length = float(np.linalg.norm(direction))
        if chosen and length**2 <= _NO_VOLUME:
            residual[index] = 0.0
        else:
            directions[len(chosen)] = direction / (length or 1.0)  # A zero row may be the first.
            residual -= np.square(rows @ directions[len(chosen)])
            chosen.append(index)
        residual[chosen] = -np.inf
        index = _first_least(-residual)
    return chosen


def _first_least(values: NDArray[np.float32]) -> int:
    """Return the index of the least value, of values that differ only by rounding the first."""
    return int((values <= values.min() + TIE).argmax())
