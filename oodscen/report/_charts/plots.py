"""Pictures of the metrics for files and notebooks: distributions, diversity over the size, a map.

The report draws the same pictures from the figures of a study. Needs the extra `plots`.
"""

from collections.abc import Mapping, Sequence, Sized
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked
from oodscen._numbers import said, whole_number
from oodscen._words.text import text_fault
from oodscen.encoders._similarity import Vectors
from oodscen.errors import UsageError
from oodscen.metrics._measurements import size_curve
from oodscen.metrics._vectors.axes import principal_axes
from oodscen.report._charts.sets import (
    Cloud,
    DrawnSizeCurve,
    HistogramRow,
    cloud_map,
    histogram,
    size_curves,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

T = TypeVar("T", bound=Any)
Named = Mapping[str, Sequence[float] | NDArray[np.float64]]

PlotKind = Literal["distribution", "size_curve", "map"]

_SIZES = 12
_MOST_REPEATS = 10_000
_LARGEST = 1e12
"""Largest number that can be drawn: beyond, ticks of an axis lie closer than numbers do."""
_UNIT_ERROR = 1e-3
"""Permitted difference of a vector's length from 1, as of vectors in half precision."""


@checked
def plot(
    sets: Mapping[str, Any],
    kind: PlotKind = "distribution",
    *,
    label: str = "OOD-ness",
    repeats: int = 20,
    seed: int = 0,
    reference: str | None = None,
) -> "Figure":
    """Draw sets of texts, by their scores or by their vectors.

    - `distribution`: the distribution of one set of scores per row over a common axis, with its mean.
    - `size_curve`: both diversities of random subsets of growing size; shows why only equal sizes compare.
    - `map`: all texts on the first two principal axes of one set. Distances on the map are not those of the
      space: its two axes hold only the share of variance below it.

    Args:
        sets: By the name of the set: scores for a distribution, drawn from top to bottom; otherwise [n, d]
            vectors, for a size curve of unit length and at least two rows each.
        kind: The picture.
        label: Name of the scores of a distribution.
        repeats: Subsets per size of a size curve; the band is their standard deviation.
        seed: Seed of the subsets.
        reference: The set that determines the axes of a map, e.g. the baseline; by default all sets together.

    Raises:
        UsageError: If a set cannot be drawn in this way, there is no such kind or reference, or a reference is
            given that plays no part.
    """
    if reference is not None and kind != "map":
        raise UsageError(f"a {kind.replace('_', ' ')} has no reference; only a map does")
    for name in sets:
        if fault := text_fault(name):
            raise UsageError(f"the name of a set, {said(name)}, {fault}")
    if fault := text_fault(label):
        raise UsageError(f"the label {fault}")
    if kind == "distribution":
        return _distributions(sets, label)
    if kind == "size_curve":
        return _size_curve(sets, repeats=repeats, seed=seed)
    return _embedding_map(sets, reference=reference)


def _distributions(sets: Named, label: str) -> "Figure":
    scores = {name: _numbers(name, values, 1) for name, values in _filled(sets).items()}
    strips = [
        HistogramRow(name, values.tolist(), float(np.mean(values)))
        for name, values in scores.items()
    ]
    return histogram(strips, quantity=label).figure()


def _size_curve(sets: Mapping[str, Vectors], *, repeats: int, seed: int) -> "Figure":
    whole_number("repeats", repeats, 1, _MOST_REPEATS)
    curves = []
    for name, values in _filled(sets).items():
        vectors = _numbers(name, values, 2)
        if len(vectors) < 2:
            raise UsageError(f"the set {name!r} has one text, and diversity needs two")
        if (np.abs(np.linalg.norm(vectors, axis=1) - 1.0) > _UNIT_ERROR).any():
            raise UsageError(f"the set {name!r} must be vectors of unit length for a size curve")
        sizes, means, spreads = size_curve(
            vectors, seed, name, count=_SIZES, repeats=repeats, most=len(vectors)
        )
        rims = zip((means - spreads).tolist(), (means + spreads).tolist(), strict=True)
        curves.append(DrawnSizeCurve(name, sizes, means.tolist(), list(rims)))
    return size_curves(curves, colour=1).figure()


def _embedding_map(sets: Mapping[str, Vectors], *, reference: str | None) -> "Figure":
    vectors = {name: _numbers(name, values, 2) for name, values in _filled(sets).items()}
    if len({values.shape[1] for values in vectors.values()}) > 1:
        raise UsageError("the vectors of the sets have different lengths")
    if reference is not None and reference not in vectors:
        raise UsageError(f"there is no set {reference!r} among {', '.join(vectors)}")
    base = np.concatenate(list(vectors.values())) if reference is None else vectors[reference]
    mean, axes, share = principal_axes(base)
    order = sorted(vectors, key=lambda name: name != reference)
    clouds = [Cloud(name, ((vectors[name] - mean) @ axes.T).tolist()) for name in order]
    return cloud_map(clouds, share.tolist(), colour=1 if reference is None else 0).figure()


def _numbers(name: str, values: Any, axes: int) -> NDArray[Any]:
    """Return a set as an array of finite numbers.

    Raises:
        UsageError: If it is anything else.
    """
    try:
        given = np.asarray(values)
        is_sound = given.dtype.kind in "iuf" and given.ndim == axes and given.size > 0
    except (TypeError, ValueError):
        is_sound = False
    if is_sound:
        # In the given type the limit may be infinite, or the least number have no absolute value.
        with np.errstate(over="ignore"):
            numbers = given.astype(np.float64)
        is_sound = bool((np.abs(numbers) <= _LARGEST).all())
    if not is_sound:
        wanted = "scores" if axes == 1 else "vectors, [n, d]"
        limit = f"all of them finite numbers up to {_LARGEST:g}"
        raise UsageError(f"the set {name!r} must be {wanted}, {limit}")
    return given if given.dtype == np.float32 else numbers


def _filled(sets: Mapping[str, T]) -> Mapping[str, T]:
    if not sets or not all(isinstance(texts, Sized) and len(texts) for texts in sets.values()):
        raise UsageError("there is no set to draw, or one is empty")
    return sets
