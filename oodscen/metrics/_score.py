"""Scores a file of texts; implements the command `oodscen score`."""

from pathlib import Path
from typing import TYPE_CHECKING

from oodscen.baselines._texts import Record, read_records
from oodscen.errors import UsageError
from oodscen.metrics._oodness import Definition
from oodscen.metrics._report import MetricsReport

if TYPE_CHECKING:
    from oodscen.metrics._metrics import Metrics


def score_records(
    metrics: "Metrics",
    path: str | Path,
    *,
    band: tuple[float, float] | None = None,
    definition: Definition = "tabulated",
) -> MetricsReport:
    """Return the report of the texts in a file; see `Metrics.score_file`."""
    records = read_records(path)
    texts = [record.text for record in records]
    if band is None:
        return metrics.report(texts, _groups(records), definition=definition)
    kept = metrics.band(texts, *band, definition=definition)
    if not kept.texts:
        told = [value for value in kept.scores if value is not None]
        raise UsageError(
            f"none of the {len(texts)} texts has an OOD-ness in [{band[0]}, {band[1]}]; "
            f"theirs lie in [{min(told):.3f}, {max(told):.3f}]"
        )
    records = [records[index] for index in kept.indices]
    report = metrics.report(kept.texts, _groups(records), definition=definition)
    return report.model_copy(update={"band": kept})


def _groups(records: list[Record]) -> tuple[str, ...] | None:
    labels = tuple(record.group for record in records if record.group is not None)
    return labels if len(labels) == len(records) else None
