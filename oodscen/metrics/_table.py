"""The paper's table, with both definitions of each figure side by side."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from oodscen._arguments import checked
from oodscen._numbers import whole_number
from oodscen._seeding import stream
from oodscen.baselines._texts import check_texts
from oodscen.data._base import Data
from oodscen.data._scenario import Scenario

if TYPE_CHECKING:
    from oodscen.metrics._metrics import Metrics

SIZES = (10, 100, 1000)
"""Numbers of texts in the paper's table."""
_BATCH = 100
"""Texts of a batch of the baseline."""


class TableRow(Data):
    """One set of texts; means over random draws of its size."""

    label: str
    n: int
    tabulated: float
    printed: float
    nearest: float | None
    pairwise: float | None


class Table(Data):
    """The paper's table for any texts and baseline."""

    rows: tuple[TableRow, ...]
    N: int
    encoder: str
    baseline: str
    baseline_digest: str
    repeats: int
    seed: int

    def __str__(self) -> str:
        head = f"{'':24}{'n':>6}  {'OOD-ness':>10}{'':>10}  {'diversity':>10}"
        names = f"{'':24}{'':>6}  {'tabulated':>10}{'printed':>10}  {'nearest':>10}{'pairwise':>10}"
        lines = [f"against {self.N} of {self.baseline} by {self.encoder}", head, names]
        for row in self.rows:
            oodness = f"{row.tabulated:>+10.3f}{row.printed:>+10.3f}"
            diversity = f"{_figure(row.nearest):>10}{_figure(row.pairwise):>10}"
            lines.append(f"{row.label:24}{row.n:>6}  {oodness}  {diversity}")
        return "\n".join(lines)


def _figure(value: float | None) -> str:
    return "" if value is None else f"{value:+.3f}"


@checked
def paper_table(
    metrics: "Metrics",
    texts: Sequence[str | Scenario],
    *,
    sizes: Sequence[int],
    repeats: int,
) -> Table:
    """Return the paper's table; see `Metrics.paper_table`."""
    plain = check_texts(texts)
    whole_sizes = [whole_number("each size", size, 1) for size in sizes]
    smaller = [size for size in whole_sizes if size < len(plain)]
    return Table(
        rows=(
            *_baseline_rows(metrics, repeats),
            *(_row("texts, draws", metrics, plain, size, repeats) for size in smaller),
            _row("texts, all", metrics, plain, len(plain), 1),
        ),
        N=len(metrics.baseline),
        encoder=metrics.encoder.name,
        baseline=metrics.baseline.name,
        baseline_digest=metrics.baseline.digest(),
        repeats=repeats,
        seed=metrics.seed,
    )


def _baseline_rows(metrics: "Metrics", repeats: int) -> tuple[TableRow, TableRow]:
    batch = max(1, min(_BATCH, len(metrics.baseline) // 2))
    diversity = metrics.baseline_diversity()
    return (
        TableRow(
            label="baseline, batches",
            n=batch,
            tabulated=metrics.baseline_batch(batch, repeats).mean,
            printed=metrics.baseline_batch(batch, repeats, definition="printed").mean,
            nearest=None,
            pairwise=None,
        ),
        TableRow(
            label="baseline, all",
            n=len(metrics.baseline),
            tabulated=-1.0,
            printed=metrics.oodness(metrics.baseline.texts, "printed").mean,
            nearest=diversity.nearest,
            pairwise=diversity.pairwise,
        ),
    )


def _row(label: str, metrics: "Metrics", texts: Sequence[str], size: int, repeats: int) -> TableRow:
    """Return the means over random draws of a size."""
    draws = stream(metrics.seed, "paper-table", size)
    figures = []
    for _ in range(repeats):
        drawn = [texts[index] for index in draws.permutation(len(texts))[:size]]
        diversity = metrics.diversity(drawn)
        oodness = (metrics.oodness(drawn).mean, metrics.oodness(drawn, "printed").mean)
        figures.append((*oodness, diversity.nearest or 0.0, diversity.pairwise or 0.0))
    tabulated, printed, nearest, pairwise = np.mean(figures, axis=0).tolist()
    return TableRow(
        label=label,
        n=size,
        tabulated=tabulated,
        printed=printed,
        nearest=nearest if size > 1 else None,
        pairwise=pairwise if size > 1 else None,
    )
