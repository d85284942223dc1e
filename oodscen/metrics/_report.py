"""The report of one set of texts: all figures, with checks against the known pitfalls."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field

from oodscen._display import html_table
from oodscen._progress import Progress, silent
from oodscen._seeding import stream
from oodscen.baselines._baseline import Baseline
from oodscen.data._base import Data
from oodscen.metrics._detection.calibration import Calibration, calibrate
from oodscen.metrics._detection.guard import OffTopicFlags, is_calibrated
from oodscen.metrics._diversity import Diversity, diversity
from oodscen.metrics._oodness import Definition, Measure, Oodness, oodness, scores
from oodscen.metrics._rarity.estimates import Rarity, estimate_rarity
from oodscen.metrics._selection import Band
from oodscen.statistics._auroc import Auroc, auroc_interval
from oodscen.statistics._intervals import Interval

if TYPE_CHECKING:
    from oodscen.metrics._vectors.space import BaselineSpace


_MOST_NAMED = 10
"""Number of texts that are named as not about driving."""


class GroupScore(Data):
    """The OOD-ness of the texts of one path."""

    n: int
    oodness: float


class ControlCheck(Data):
    """A set's OOD-ness against that of the bundled ordinary control sentences (*frozen*).

    These are worded like the texts of scenario authors and describe nothing unusual. If a set's
    AUROC is near 0.5, this measure cannot tell the set from them, however far from the baseline it
    lies.
    """

    mean: float
    """OOD-ness of the ordinary controls."""
    n: int
    auroc: Auroc
    """AUROC of the set against the ordinary controls."""


class MetricsReport(Data):
    """All figures of one set of texts, with the data needed to reproduce them.

    Can also be read like a mapping: `report["oodness"]["mean"]`, `dict(report)`.
    """

    schema_version: Literal[2] = 2
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
    rarity: Rarity | None = None
    """Expected kilometres between two meetings with each kind: the headline. Offline unless a model was asked."""
    band: Band | None = None
    """The filter that the texts passed, if one was requested; `n` counts the texts inside."""

    @property
    def _compared(self) -> str:
        noun = "text" if self.n == 1 else "texts"
        return f"{self.n:,} {noun} against {self.N:,} of {self.baseline} by {self.encoder}"

    @property
    def _filtered(self) -> str:
        """The band of the texts in words; empty without one."""
        if self.band is None:
            return ""
        bounds = _bounds(self.band.low, self.band.high)
        return f"texts of the band {bounds}; below it: {self.band.below}, above: {self.band.above}"

    @property
    def _paper_figures(self) -> list[tuple[str, float | None, Interval | None]]:
        """The names, values and intervals of the paper's figures."""
        oodness, diversity = self.oodness, self.diversity
        return [
            (f"OOD-ness ({oodness.definition})", oodness.mean, oodness.interval),
            ("diversity, nearest", diversity.nearest, diversity.nearest_interval),
            ("diversity, pairwise", diversity.pairwise, diversity.pairwise_interval),
        ]

    def __str__(self) -> str:
        lines = [
            self._compared,
            *([self._filtered] if self.band else []),
            *([str(self.rarity)] if self.rarity else []),
            *(
                f"{name:21}  {_figure(value, interval)}"
                for name, value, interval in self._paper_figures
            ),
        ]
        if self.calibration is not None:
            lines.append(
                f"among held-out baseline texts: median percentile {self.calibration.median_percentile:.0f}, "
                f"{self.calibration.share_below_5_percent:.0%} with conformal p <= 0.05"
            )
        if self.control is not None:
            lines.append(
                f"ordinary controls      {self.control.mean:+.3f}; AUROC against them "
                f"{self.control.auroc.value:.2f}{_range(self.control.auroc.interval)}"
            )
        if self.off_topic is not None and self.off_topic.flagged:
            lines.append(_off_topic(self.off_topic.flagged))
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """Return the figures with their intervals as a table for notebooks."""
        rows = self._paper_figures
        if self.rarity is not None:
            rows.insert(0, ("rarity, median of log10 km", self.rarity.median, self.rarity.interval))
        if self.control is not None:
            auroc = self.control.auroc
            rows.append(("OOD-ness of the ordinary controls", self.control.mean, None))
            rows.append(("AUROC against the controls", auroc.value, auroc.interval))
        if self.calibration is not None:
            median = self.calibration.median_percentile
            rows.append(("median percentile among held-out baseline texts", median, None))
        if self.off_topic is not None:
            rows.append(("texts that are not about driving", len(self.off_topic.flagged), None))
        return html_table(
            (
                (
                    name,
                    _cell(value),
                    f"{interval.low:.3f} to {interval.high:.3f}" if interval else "",
                )
                for name, value, interval in rows
            ),
            head=("", "value", "interval"),
            caption="; ".join(filter(None, (self._compared, self._filtered))),
        )

    def __contains__(self, key: object) -> bool:
        return key in type(self).model_fields

    def keys(self) -> Iterator[str]:
        """Return the names of the fields."""
        return iter(type(self).model_fields)

    def __getitem__(self, key: str) -> Any:
        """Return one field as plain data."""
        return self.model_dump(mode="json", include={key})[key]


class BaselineBatch(Data):
    """OOD-ness of random batches of the baseline against the rest of it.

    This is the paper's reference for the score of ordinary text (-0.953 there). Near-duplicates in the
    baseline push it towards -1.
    """

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


def report(
    space: "BaselineSpace",
    texts: Sequence[str],
    clusters: Sequence[str] | None,
    definition: Measure,
    *,
    checks: bool,
    progress: Progress = silent,
) -> MetricsReport:
    """Return all figures of a set of texts; see `Metrics.report`."""
    total = 5 if checks else 2
    progress("metrics", 0, total)
    found = oodness(space, texts, clusters, definition)
    progress("metrics", 1, total)
    encoder = space.encoder.name
    differing = diversity(space.vectors(texts), encoder, clusters, seed=space.seed)
    progress("metrics", 2, total)
    calibration = control = flags = None
    if checks:
        calibration = _calibration(space, found)
        progress("metrics", 3, total)
        control = _control(space, found, clusters)
        progress("metrics", 4, total)
        if is_calibrated(encoder):
            flags = space.guard.flags(space.vectors(texts))
        progress("metrics", 5, total)
    return MetricsReport(
        oodness=found,
        diversity=differing,
        n=len(texts),
        N=len(space.baseline),
        encoder=encoder,
        baseline=space.baseline.name,
        baseline_digest=space.baseline.digest(),
        seed=space.seed,
        groups=_by_group(clusters, found.per_text),
        calibration=calibration,
        control=control,
        off_topic=flags,
        rarity=estimate_rarity(space, texts, clusters),
    )


def baseline_batch(
    space: "BaselineSpace", size: int, repeats: int, definition: Definition
) -> BaselineBatch:
    """Return the OOD-ness of random batches of the baseline; see `Metrics.baseline_batch`."""
    vectors = space.whole
    draws = stream(space.seed, "baseline-batch", size)
    found = []
    for _ in range(repeats):
        order = draws.permutation(len(vectors))
        batch, rest = vectors[order[:size]], vectors[order[size:]]
        found.append(float(scores(batch, rest, definition).mean()))
    return BaselineBatch(
        mean=float(np.mean(found)),
        spread=float(np.std(found, ddof=1)) if repeats > 1 else 0.0,
        per_repeat=tuple(found),
        size=size,
        repeats=repeats,
        N=len(vectors),
        definition=definition,
        encoder=space.encoder.name,
        baseline=space.baseline.name,
        seed=space.seed,
    )


def _calibration(space: "BaselineSpace", found: Oodness) -> Calibration | None:
    """Return where a set lies among held-out texts, if the baseline has texts to hold out."""
    if not isinstance(space.baseline, Baseline) or len(space.baseline) < 2:
        return None
    return calibrate(found.per_text, *space.held_out(found.definition))


def _control(
    space: "BaselineSpace", found: Oodness, clusters: Sequence[str] | None
) -> ControlCheck:
    ordinary, own = space.control_scores(found.definition), np.array(found.per_text)
    return ControlCheck(
        mean=float(ordinary.mean()),
        n=len(ordinary),
        auroc=auroc_interval(ordinary, own, clusters, seed=space.seed),
    )


def _by_group(clusters: Sequence[str] | None, values: Sequence[float]) -> dict[str, GroupScore]:
    if not clusters:
        return {}
    members: dict[str, list[float]] = {}
    for label, value in zip(clusters, values, strict=True):
        members.setdefault(label, []).append(value)
    return {
        label: GroupScore(n=len(found), oodness=math.fsum(found) / len(found))
        for label, found in members.items()
    }


def _bounds(low: float | None, high: float | None) -> str:
    """Return the bounds of a band in words."""
    if low is None:
        return "without bounds" if high is None else f"up to {high}"
    return f"from {low}" if high is None else f"from {low} to {high}"


def _off_topic(flagged: Sequence[int]) -> str:
    """Return the line about the texts that are not about driving, counted from 1."""
    count, named = len(flagged), ", ".join(str(index + 1) for index in flagged[:_MOST_NAMED])
    left = f" and {count - _MOST_NAMED} more" if count > _MOST_NAMED else ""
    subject, noun = ("text does", "text") if count == 1 else ("texts do", "texts")
    return f"{count} {subject} not look like driving a car ({noun} {named}{left})"


def _figure(value: float | None, interval: Interval | None) -> str:
    if value is None:
        return "none: one text has no other to differ from"
    return f"{value:+.3f}" + (f"  [{interval.low:+.3f}, {interval.high:+.3f}]" if interval else "")


def _cell(value: float | None) -> str:
    if value is None:
        return "–"
    return f"{value:.3f}" if isinstance(value, float) else str(value)


def _range(found: Interval | None) -> str:
    return "" if found is None else f" [{found.low:.2f}, {found.high:.2f}]"
