"""Pictures of the metrics as matplotlib figures: distributions, diversity over the size, a map.

Needs the extra `plots`. Figures are made without pyplot, so that no global state changes and no window opens.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from oodscen._seeding import stream
from oodscen.errors import MissingExtra, UsageError
from oodscen.metrics._diversity import mean_nearest, mean_pairwise
from oodscen.metrics._vectors.axes import principal_axes
from oodscen.metrics._vectors.similarity import Vectors

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = ("#0b5fa5", "#c8501e", "#3a8a4d", "#8a4fa0", "#7a7a7a", "#b8901e")
T = TypeVar("T", bound=Any)
Named = Mapping[str, Sequence[float] | NDArray[np.float64]]


def distributions(sets: Named, label: str = "OOD-ness") -> "Figure":
    """Draw one smoothed distribution per set over a common axis, with its values and mean.

    Args:
        sets: Scores by the name of the set, at least one each; drawn from top to bottom.
        label: Label of the axis.
    """
    known = {name: np.asarray(values, np.float64) for name, values in _filled(sets).items()}
    figure, axes = _figure(1.2 + 0.75 * len(known))
    everything = np.concatenate(list(known.values()))
    margin = max(float(np.ptp(everything)) * 0.08, 0.02)
    grid = np.linspace(everything.min() - margin, everything.max() + margin, 400)
    for place, values in enumerate(known.values()):
        base, colour = -float(place), _COLOURS[place % len(_COLOURS)]
        height = _density(values, grid)
        axes.fill_between(grid, base, base + 0.8 * height, color=colour, alpha=0.35, linewidth=0)
        axes.plot(
            values, np.full(len(values), base - 0.06), "|", color=colour, markersize=5, alpha=0.6
        )
        mean = float(values.mean())
        axes.plot([mean, mean], [base, base + 0.8], color=colour, linewidth=1.5)
        axes.text(mean, base + 0.83, f"{mean:.3f}", color=colour, ha="center", fontsize=8)
    axes.set_yticks([-float(place) for place in range(len(known))])
    axes.set_yticklabels([f"{name}\nn = {len(values)}" for name, values in known.items()])
    axes.set_ylim(-len(known) + 0.7, 1.1)
    axes.set_xlim(grid[0], grid[-1])
    axes.set_xlabel(label)
    return figure


def size_curve(sets: Mapping[str, Vectors], *, repeats: int = 20, seed: int = 0) -> "Figure":
    """Draw both diversities of random subsets of growing size; shows why only equal sizes compare.

    Args:
        sets: [n, d] vectors of unit length by the name of the set, at least two rows each.
        repeats: Subsets per size; the band is their standard deviation.
        seed: Seed of the subsets.
    """
    figure, axes = _figure(4.2)
    for place, (name, vectors) in enumerate(_filled(sets).items()):
        if len(vectors) < 2:
            raise UsageError(f"the set {name!r} has one text, and diversity needs two")
        steps = np.unique(np.geomspace(2, len(vectors), 12).round().astype(int))
        draws = stream(seed, "size-curve", name)
        curve = np.array([_diversities(vectors, int(size), repeats, draws) for size in steps])
        colour = _COLOURS[place % len(_COLOURS)]
        for kind, style in ((0, "-"), (1, "--")):
            mean, spread = curve[:, kind, 0], curve[:, kind, 1]
            label = f"{name}, {('nearest', 'pairwise')[kind]}"
            axes.plot(steps, mean, style, color=colour, label=label)
            axes.fill_between(
                steps, mean - spread, mean + spread, color=colour, alpha=0.15, linewidth=0
            )
    axes.set_xscale("log")
    axes.set_xlabel("number of texts")
    axes.set_ylabel("diversity")
    axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def embedding_map(sets: Mapping[str, Vectors], *, reference: str | None = None) -> "Figure":
    """Draw all texts on the first two principal axes of one set.

    Distances on the map are not those of the space: its two axes hold only the share of variance on their labels.

    Args:
        sets: [n, d] vectors by the name of the set.
        reference: The set that determines the axes, e.g. the baseline; by default all sets together.
    """
    known = _filled(sets)
    if reference is not None and reference not in known:
        raise UsageError(f"there is no set {reference!r} among {', '.join(known)}")
    base = np.concatenate(list(known.values())) if reference is None else known[reference]
    mean, axes_, share = principal_axes(base)
    figure, axes = _figure(5.0)
    for place, (name, vectors) in enumerate(known.items()):
        points = (vectors - mean) @ axes_.T
        small = len(points) > 500
        axes.scatter(
            points[:, 0],
            points[:, 1],
            s=6 if small else 16,
            alpha=0.25 if small else 0.8,
            color="#a8a8a8" if name == reference else _COLOURS[place % len(_COLOURS)],
            label=f"{name} ({len(points)})",
            linewidths=0,
            zorder=1 if name == reference else 2,
        )
    axes.set_xlabel(f"first principal axis ({share[0]:.0%} of the variance)")
    axes.set_ylabel(f"second ({share[1]:.0%})")
    axes.legend(frameon=False, fontsize=8)
    return figure


def _figure(height: float) -> tuple["Figure", Any]:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtra("pictures of the metrics", "plots", "matplotlib") from None
    figure = Figure(figsize=(7.2, height), layout="constrained", dpi=110)
    axes = figure.add_subplot()
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="x", color="#e4e4e4", linewidth=0.8)
    axes.set_axisbelow(True)
    return figure, axes


def _filled(sets: Mapping[str, T]) -> Mapping[str, T]:
    if not sets or not all(len(values) for values in sets.values()):
        raise UsageError("there is no set to draw, or one is empty")
    return sets


def _density(values: NDArray[np.float64], grid: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a Gaussian kernel density of values, with Silverman's bandwidth, scaled to a height of 1."""
    width = 1.06 * float(values.std()) * len(values) ** -0.2
    width = max(width, float(grid[-1] - grid[0]) / 150.0)
    height = np.exp(-0.5 * np.square((grid[:, None] - values) / width)).sum(axis=1)
    return np.asarray(height / height.max(), np.float64)


def _diversities(
    vectors: Vectors, size: int, repeats: int, draws: np.random.Generator
) -> list[tuple[float, float]]:
    found = []
    for _ in range(1 if size == len(vectors) else repeats):
        part = vectors[draws.permutation(len(vectors))[:size]]
        found.append((-mean_nearest(part), -mean_pairwise(part)))
    both = np.array(found)
    return list(zip(both.mean(axis=0).tolist(), both.std(axis=0).tolist(), strict=True))
