"""Everything that a study measures of its texts, with the data behind the report's pictures of the metrics.

`measurements` computes it while the texts are available, so that drawing a report needs neither an encoder
nor the baseline.
"""

from collections.abc import Mapping, Sequence
from typing import Annotated, Final, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from oodscen import _paper as paper
from oodscen._seeding import stream
from oodscen.data._base import Data
from oodscen.data._issues import same_length
from oodscen.data._scenario import Scenario
from oodscen.encoders._similarity import Vectors
from oodscen.metrics._diversity import Diversity, mean_nearest, mean_pairwise
from oodscen.metrics._groups import paths_of
from oodscen.metrics._metrics import Metrics
from oodscen.metrics._oodness import Measure
from oodscen.metrics._rarity.estimates import Rarity
from oodscen.metrics._rarity.exposure import TreeRarity
from oodscen.metrics._report import BaselineBatch, MetricsReport
from oodscen.metrics._vectors.axes import principal_axes
from oodscen.statistics._auroc import Auroc, auroc_interval

BEST: Final[Measure] = "events"
"""The detector that separates the controls best; see `docs/metrics.md`."""

_SHOWN = 400
"""Points or scores of a set that a picture shows at most."""
_SIZES = 9
_REPEATS = 8
_LARGEST = 1000
"""Sizes, subsets of a size, and largest size of the curves of diversity."""


_Similarity = Annotated[float, Field(ge=-1.1, le=1.1)]
"""A mean of cosine similarities that the curves show with either sign, rounding included."""


class OodnessPicture(Data):
    """OOD-ness of texts known to be ordinary."""

    control: tuple[float, ...]
    """The ordinary controls."""
    held_out: tuple[float, ...]
    """Texts of the baseline, scored without their like."""


class DetectorScores(Data):
    """The scores of one set by a detector."""

    mean: float
    per_text: tuple[float, ...]
    auroc: Auroc
    """Against the ordinary controls."""


class DetectorPicture(Data):
    """Scores by the best detector."""

    name: str
    control: tuple[float, ...]
    """The ordinary controls."""
    sets: dict[str, DetectorScores]


class SizeCurve(Data):
    """Both diversities of random subsets, by their size."""

    sizes: tuple[int, ...]
    nearest: tuple[_Similarity, ...]
    pairwise: tuple[_Similarity, ...]

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        same_length(sizes=len(self.sizes), nearest=len(self.nearest), pairwise=len(self.pairwise))
        return self


class MapPicture(Data):
    """Points on the first two principal axes of the baseline."""

    share: tuple[float, ...]
    """Share of the variance that each axis holds."""
    points: dict[str, tuple[tuple[float, float], ...]]
    """At most 400 of each set."""


class Pictures(Data):
    """The data for the report's pictures of the metrics."""

    oodness: OodnessPicture
    detector: DetectorPicture
    curves: dict[str, SizeCurve]
    """By set of at least two texts, `baseline` first."""
    map: MapPicture


class BaselineUsed(BaseModel):
    """The baseline that a study was measured against.

    Not a `Data`, because its field would hide the method `digest`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    N: int
    digest: str


class Measurements(Data):
    """The content of a study's `metrics.json`."""

    encoder: str
    baseline: BaselineUsed
    sets: dict[str, MetricsReport]
    """By size for the diverse tree, and `simulatable` for all texts of the other."""
    baseline_batch: BaselineBatch
    baseline_diversity: Diversity
    pictures: Pictures
    paths: TreeRarity | None = None
    """Rarity of the diverse tree's leaves by their labels; `None` in older studies."""
    asked: Rarity | None = None
    """Rarity of the simulatable texts by the study's `rarity_llm`, with tokens and cost; `None` without one."""
    made_from: str = ""
    """Digest of the texts, and of the diverse tree's labels."""

    @model_validator(mode="after")
    def _draws_every_set(self) -> Self:
        for field, drawn, needed in (
            ("pictures.detector.sets", self.pictures.detector.sets, {*self.sets}),
            ("pictures.map.points", self.pictures.map.points, {*self.sets, "baseline"}),
        ):
            if missing := sorted(needed - {*drawn}):
                raise ValueError(f"{field} lacks {missing[0]!r}")
        return self


def measurements(
    metrics: Metrics,
    sets: Mapping[str, Sequence[Scenario]],
    leaves: Mapping[str, str] | None = None,
) -> Measurements:
    """Return everything that a study measures of its sets of texts; empty sets are left out.

    Texts of one path are resampled together. `leaves` are the labels of the diverse tree's leaves by id.
    """
    filled = {name: texts for name, texts in sets.items() if texts}
    paths = None
    if leaves:
        paths = TreeRarity(leaves=tuple(leaves), rarity=metrics.rarity([*leaves.values()]))
    return Measurements(
        encoder=metrics.encoder.name,
        baseline=BaselineUsed(
            name=metrics.baseline.name,
            N=len(metrics.baseline),
            digest=metrics.baseline.digest(),
        ),
        sets={name: metrics.report(texts) for name, texts in filled.items()},
        baseline_batch=metrics.baseline_batch(min(paper.BATCH, max(1, len(metrics.baseline) // 2))),
        baseline_diversity=metrics.baseline_diversity(),
        pictures=picture_data(metrics, filled),
        paths=paths,
    )


def picture_data(metrics: Metrics, sets: Mapping[str, Sequence[str | Scenario]]) -> Pictures:
    """Return the data for the report's pictures of the metrics; every set needs at least one text."""
    vectors = {"baseline": metrics.baseline_vectors}
    vectors |= {name: metrics.vectors(texts) for name, texts in sets.items()}
    control = np.array(metrics.control_scores(BEST))
    held_out = np.array(metrics.held_out_scores())
    return Pictures(
        oodness=OodnessPicture(
            control=_rounded(np.array(metrics.control_scores())),
            held_out=_rounded(_sample(held_out, metrics.seed, "held-out")),
        ),
        detector=DetectorPicture(
            name=BEST,
            control=_rounded(control),
            sets={name: _detected(metrics, texts, control) for name, texts in sets.items()},
        ),
        curves={
            name: _curve(rows, metrics.seed, name)
            for name, rows in vectors.items()
            if len(rows) > 1
        },
        map=_map(vectors, metrics.seed),
    )


def size_curve(
    rows: Vectors, seed: int, name: str, *, count: int, repeats: int, most: int
) -> tuple[list[int], NDArray[np.float64], NDArray[np.float64]]:
    """Return both diversities of random subsets of growing size.

    Args:
        rows: [n, d], at least two rows of unit length.
        seed: Seed of the subsets.
        name: Name of the set, for its stream of draws.
        count: Number of sizes, at equal ratios from 2 on.
        repeats: Subsets per size; the whole set is taken once.
        most: The largest size.

    Returns:
        The sizes, and means and standard deviations [2, sizes], to the nearest text and over all pairs.
    """
    sizes = np.unique(np.geomspace(2, min(len(rows), most), count).round().astype(int)).tolist()
    draws = stream(seed, "size-curve", name)
    means, spreads = [], []
    for size in sizes:
        times = 1 if size == len(rows) else repeats
        parts = [rows[draws.permutation(len(rows))[:size]] for _ in range(times)]
        diversities = [(-mean_nearest(part), -mean_pairwise(part)) for part in parts]
        means.append(np.mean(diversities, axis=0))
        spreads.append(np.std(diversities, axis=0))
    return sizes, np.array(means).T, np.array(spreads).T


def _detected(
    metrics: Metrics, texts: Sequence[str | Scenario], control: NDArray[np.float64]
) -> DetectorScores:
    values = np.array(metrics.oodness(texts, BEST).per_text)
    return DetectorScores(
        mean=float(values.mean()),
        per_text=_rounded(values),
        auroc=auroc_interval(control, values, paths_of(texts), seed=metrics.seed),
    )


def _curve(rows: Vectors, seed: int, name: str) -> SizeCurve:
    sizes, (nearest, pairwise), _ = size_curve(
        rows, seed, name, count=_SIZES, repeats=_REPEATS, most=_LARGEST
    )
    return SizeCurve(sizes=tuple(sizes), nearest=_rounded(nearest), pairwise=_rounded(pairwise))


def _map(vectors: Mapping[str, Vectors], seed: int) -> MapPicture:
    mean, axes, share = principal_axes(vectors["baseline"])
    points = {}
    for name, rows in vectors.items():
        coordinates = (_sample(rows, seed, "map", name) - mean) @ axes.T
        points[name] = tuple((round(float(x), 3), round(float(y), 3)) for x, y in coordinates)
    return MapPicture(share=_rounded(share), points=points)


def _sample(rows: np.ndarray, seed: int, *keys: str) -> np.ndarray:
    """Return the rows that a picture shows, in their order: all, or a random sample of them."""
    if len(rows) <= _SHOWN:
        return rows
    return rows[np.sort(stream(seed, "pictures", *keys).permutation(len(rows))[:_SHOWN])]


def _rounded(values: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(value), 4) for value in values)
