"""What `Metrics` returns besides OOD-ness and diversity."""

from collections.abc import Iterator
from typing import Any, ClassVar, Literal

from pydantic import Field

from oodscen._data import Data
from oodscen.metrics.diversity import Diversity
from oodscen.metrics.oodness import Definition, Oodness
from oodscen.metrics.statistics import Interval


class Band(Data):
    """The texts of a set whose OOD-ness lies between two bounds (Remark 1 of the paper).

    The upper bound keeps out what is too far-fetched, the lower one what is too ordinary.
    """

    noun: ClassVar[str] = "band"

    low: float | None
    """`None` where there is no lower bound."""
    high: float | None
    """`None` where there is no upper bound."""
    texts: tuple[str, ...]
    """Those inside, bounds included, in their order."""
    indices: tuple[int, ...]
    """Their places in the set."""
    scores: tuple[float, ...]
    """OOD-ness of every text of the set."""
    below: int
    """How many texts are more ordinary than `low`."""
    above: int
    """How many texts are further out than `high`."""


class GroupScore(Data):
    """The OOD-ness of the texts of one path."""

    noun: ClassVar[str] = "group score"

    n: int
    oodness: float


class Report(Data):
    """All figures of one set of texts, with what is needed to repeat them.

    Reads like a mapping too: `report["oodness"]["mean"]`, `dict(report)`.
    """

    noun: ClassVar[str] = "metrics report"

    schema_version: Literal[1] = 1
    oodness: Oodness
    diversity: Diversity
    n: int
    """Number of texts."""
    N: int
    """Number of baseline texts."""
    encoder: str
    baseline: str
    """Name of the baseline."""
    baseline_digest: str
    """SHA-256 of its texts."""
    seed: int
    """Of the bootstrap."""
    groups: dict[str, GroupScore] = Field(default_factory=dict)
    """By path, where the texts have one."""
    band: Band | None = None
    """The filter that the texts passed, where one was asked for; `n` counts what is inside."""

    def __str__(self) -> str:
        oodness, diversity = self.oodness, self.diversity
        lines = [
            f"{self.n} texts against {self.N} of {self.baseline} by {self.encoder}",
            f"OOD-ness ({oodness.definition})  {_figure(oodness.mean, oodness.interval)}",
            f"diversity, nearest     {_figure(diversity.nearest, diversity.nearest_interval)}",
            f"diversity, pairwise    {_figure(diversity.pairwise, diversity.pairwise_interval)}",
        ]
        if self.band is not None:
            lines.insert(
                1,
                f"in the band [{self.band.low}, {self.band.high}]: {self.band.below} texts are below, "
                f"{self.band.above} above",
            )
        return "\n".join(lines)

    def keys(self) -> Iterator[str]:
        """Return the names of the fields."""
        return iter(type(self).model_fields)

    def __getitem__(self, key: str) -> Any:
        """Return one field as plain data."""
        return self.model_dump(mode="json", include={key})[key]


def _figure(value: float | None, interval: Interval | None) -> str:
    if value is None:
        return "none: one text has no other to differ from"
    return f"{value:+.3f}" + (f"  [{interval.low:+.3f}, {interval.high:+.3f}]" if interval else "")


class BaselineBatch(Data):
    """OOD-ness of random batches of the baseline against the rest of it.

    The paper's reference for what ordinary text scores (-0.953 there): near-duplicates in the
    baseline push it towards -1.
    """

    noun: ClassVar[str] = "baseline batch"

    mean: float
    """Over the repeats."""
    spread: float
    """Standard deviation over the repeats; 0 for one repeat."""
    per_repeat: tuple[float, ...]
    size: int
    repeats: int
    N: int
    """Size of the baseline; each batch is measured against N - size texts."""
    definition: Definition
    encoder: str
    baseline: str
    seed: int


class Contrast(Data):
    """One figure of two sets at equal size."""

    noun: ClassVar[str] = "contrast"

    a: float
    b: float
    difference: float
    """a - b."""
    low: float
    """2.5 % of the differences over the subsamples."""
    high: float
    """97.5 % of them. How much the draw matters; not a confidence interval."""


class Comparison(Data):
    """Two sets of texts compared at equal size, by repeated subsampling."""

    noun: ClassVar[str] = "comparison"

    size: int
    """Texts drawn from each set in each repeat."""
    repeats: int
    n_a: int
    n_b: int
    oodness: Contrast
    nearest: Contrast
    """Diversity by the nearest text."""
    pairwise: Contrast
    """Diversity by the mean over pairs."""
    encoder: str
    baseline: str
    seed: int
