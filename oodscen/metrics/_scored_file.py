"""The metrics of a file of texts."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from oodscen._numbers import said
from oodscen.baselines._reading import Record, read_records
from oodscen.errors import DataError, Issue, UsageError
from oodscen.metrics._oodness import Definition
from oodscen.metrics._rarity.rates import PublishedRate
from oodscen.metrics._report import MetricsReport
from oodscen.metrics._selection import Band
from oodscen.protocols import LLM

if TYPE_CHECKING:
    from oodscen.metrics._metrics import Metrics


def score_file(
    metrics: "Metrics",
    path: str | Path,
    *,
    band: tuple[float, float] | None,
    definition: Definition,
    llm: LLM | None,
    anchors: Sequence[PublishedRate] | None,
) -> MetricsReport:
    """Return rarity, OOD-ness and diversity of the texts in a file; see `Metrics.score_file`."""
    records = read_records(path)
    _check_groups(records, str(path))
    texts_inside = None
    if band is not None:
        texts_inside = _texts_inside(metrics, records, band, definition)
        records = [records[index] for index in texts_inside.indices]
    texts = [record.text for record in records]
    groups = [record.group for record in records if record.group is not None] or None
    report = metrics.report(texts, groups, definition=definition)
    update: dict[str, object] = {"band": texts_inside}
    if llm is not None or anchors is not None:
        update["rarity"] = metrics.rarity(texts, llm, groups=groups, anchors=anchors)
    return report.model_copy(update=update)


def _texts_inside(
    metrics: "Metrics",
    records: Sequence[Record],
    bounds: tuple[float, float],
    definition: Definition,
) -> Band:
    """Return the texts inside a band, at least one."""
    if len(bounds) != 2:
        raise UsageError(f"band must be its two bounds, not {said(bounds, 80)}")
    texts = [record.text for record in records]
    band = metrics.band(texts, *bounds, definition=definition)
    if not band.texts:
        scores = [score for score in band.scores if score is not None]
        raise UsageError(
            f"none of the {len(texts)} texts has an OOD-ness in [{bounds[0]}, {bounds[1]}]; "
            f"theirs lie in [{min(scores):.3f}, {max(scores):.3f}]"
        )
    return band


def _check_groups(records: Sequence[Record], path: str) -> None:
    """Refuse texts without a group beside others with one, whose intervals would ignore the groups.

    Raises:
        DataError: If there are any.
    """
    issues = [
        Issue(f"text {number}", "has no `path`, `leaf` or `group`, which others have")
        for number, record in enumerate(records, start=1)
        if record.group is None
    ]
    if len(issues) not in (0, len(records)):
        raise DataError("texts", issues, source=path)
