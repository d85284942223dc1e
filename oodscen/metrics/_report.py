"""The results of `Metrics` other than OOD-ness and diversity."""

from collections.abc import Iterator
from typing import Any, ClassVar, Literal

from pydantic import Field

from oodscen.data._base import Data
from oodscen.metrics._detection.calibration import Calibration
from oodscen.metrics._detection.guard import OffTopicFlags
from oodscen.metrics._detection.separation import Auroc
from oodscen.metrics._diversity import Diversity
from oodscen.metrics._oodness import Definition, Measure, Oodness
from oodscen.statistics._resampling import Interval


class Band(Data):
    """The texts of a set whose OOD-ness lies between two bounds (Remark 1 of the paper).

    The upper bound excludes far-fetched texts, the lower bound ordinary ones.
    """

    noun: ClassVar[str] = "band"

    low: float | None
    """`None` without a lower bound."""
    high: float | None
    """`None` without an upper bound."""
    texts: tuple[str, ...]
    """The texts inside the band, bounds included, in their order."""
    indices: tuple[int, ...]
    """Their indices in the set."""
    scores: tuple[float, ...]
    """OOD-ness of every text of the set."""
    below: int
    """Number of texts that are more ordinary than `low`."""
    above: int
    """Number of texts that are further out than `high`."""


class GroupScore(Data):
    """The OOD-ness of the texts of one path."""

    noun: ClassVar[str] = "group score"

    n: int
    oodness: float


class ControlCheck(Data):
    """A set's OOD-ness against that of the bundled ordinary control sentences (*frozen*).

    These are worded like the texts of scenario authors and describe nothing unusual. If a set's AUROC is near
    0.5,
    this measure cannot tell the set from them, however far from the baseline it lies.
    """

    noun: ClassVar[str] = "control check"

    mean: float
    """OOD-ness of the ordinary controls."""
    n: int
    auroc: Auroc
    """AUROC of the set against the ordinary controls."""


class Report(Data):
    """All figures of one set of texts, with the data needed to reproduce them.

    Can also be read like a mapping: `report["oodness"]["mean"]`, `dict(report)`.
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
    """SHA-256 of the baseline's texts."""
    seed: int
    """Seed of the bootstrap."""
    groups: dict[str, GroupScore] = Field(default_factory=dict)
    """Scores by path, if the texts have one."""
    calibration: Calibration | None = None
    """OOD-ness relative to held-out baseline texts, by the same definition or detector."""
    control: ControlCheck | None = None
    """The set against ordinary sentences in the controls' style."""
    off_topic: OffTopicFlags | None = None
    """Texts that are not about driving a car; see `oodscen.metrics._detection.guard` for the error rates."""
    band: Band | None = None
    """The filter that the texts passed, if one was requested; `n` counts the texts inside."""

    def __str__(self) -> str:
        oodness, diversity = self.oodness, self.diversity
        lines = [
            f"{self.n} texts against {self.N} of {self.baseline} by {self.encoder}",
            f"OOD-ness ({oodness.definition})  {_figure(oodness.mean, oodness.interval)}",
            f"diversity, nearest     {_figure(diversity.nearest, diversity.nearest_interval)}",
            f"diversity, pairwise    {_figure(diversity.pairwise, diversity.pairwise_interval)}",
        ]
        if self.calibration is not None:
            lines.append(
                f"among held-out baseline texts: median percentile {self.calibration.median_percentile:.0f}, "
                f"{self.calibration.share_below_5_percent:.0%} with conformal p <= 0.05"
            )
        if self.control is not None:
            lines.append(
                f"ordinary controls      {self.control.mean:+.3f}; AUROC against them "
                f"{self.control.auroc.value:.2f}{_range(self.control.auroc)}"
            )
        if self.off_topic is not None and self.off_topic.flagged:
            lines.append(
                f"{len(self.off_topic.flagged)} texts do not look like driving a car "
                f"(places {', '.join(map(str, self.off_topic.flagged[:10]))})"
            )
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


def _range(found: Auroc) -> str:
    return "" if found.low is None else f" [{found.low:.2f}, {found.high:.2f}]"


class BaselineBatch(Data):
    """OOD-ness of random batches of the baseline against the rest of it.

    This is the paper's reference for the score of ordinary text (-0.953 there). Near-duplicates in the
    baseline push it towards -1.
    """

    noun: ClassVar[str] = "baseline batch"

    mean: float
    """Mean over the repeats."""
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
    """97.5 % of the differences. Shows the effect of the draw; not a confidence interval."""
    p_value: float | None = None
    """For OOD-ness only: two-sided, by permutation, or by sign flips if the sets are matched pairs."""


class Comparison(Data):
    """A comparison of two sets of texts at equal size, by repeated subsampling."""

    noun: ClassVar[str] = "comparison"

    size: int
    """Texts drawn from each set in each repeat."""
    repeats: int
    n_a: int
    n_b: int
    is_paired: bool = False
    """True if the i-th texts of both belong together; the test is of their differences."""
    oodness: Contrast
    nearest: Contrast
    """Diversity by the nearest text."""
    pairwise: Contrast
    """Diversity by the mean over pairs."""
    encoder: str
    baseline: str
    seed: int
    N: int = 0
    """Number of baseline texts."""
    definition: Measure = "tabulated"
    """Definition of OOD-ness."""

    def __str__(self) -> str:
        lines = [
            f"{self.n_a} and {self.n_b} texts, {self.repeats} draws of {self.size} from either, "
            f"against {self.N} of {self.baseline} by {self.encoder}"
        ]
        for label, found in (
            ("OOD-ness", self.oodness),
            ("diversity, nearest", self.nearest),
            ("diversity, pairwise", self.pairwise),
        ):
            test = "" if found.p_value is None else f"  p = {found.p_value:.4f}"
            lines.append(
                f"{label:20} {found.a:+.3f}  {found.b:+.3f}  difference {found.difference:+.3f}{test}"
            )
        return "\n".join(lines)


class Selection(Data):
    """The most diverse texts among the candidates; see `oodscen.metrics._selection`."""

    noun: ClassVar[str] = "selection"

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


class Variety(Data):
    """Further measures of one set; none is comparable between sets of different size."""

    noun: ClassVar[str] = "variety"

    n: int
    vendi: float
    """Effective number of different texts, in [1, n]."""
    remote_clique: float | None
    """Mean distance over pairs, in [0, 2]; `None` for one text."""
    compression_ratio: float
    """Higher is more repetitive."""
    distinct_1: float | None
    distinct_2: float | None
    """Share of distinct words, and of distinct pairs of words, in (0, 1]."""
    encoder: str


class SetDistance(Data):
    """The distance between two sets as a whole; means over draws of equal size."""

    noun: ClassVar[str] = "distance of two sets"

    mmd: float
    """Squared maximum mean discrepancy, unbiased: about 0 for two draws of one source."""
    mmd_spread: float
    """Standard deviation over the draws."""
    frechet: float
    """Fréchet distance; comparable at the same `size` only."""
    frechet_spread: float
    size: int
    repeats: int
    n_a: int
    n_b: int
    encoder: str
    seed: int
