"""Scores a file of texts; implements the command `oodscen score`."""

from pathlib import Path

from oodscen.baselines._baseline import Baseline
from oodscen.baselines._texts import Record, read_records
from oodscen.errors import UsageError
from oodscen.metrics._metrics import Metrics
from oodscen.metrics._oodness import Definition
from oodscen.metrics._report import Report
from oodscen.metrics._table import Table, paper_table
from oodscen.protocols import LLM, Encoder


def score_file(
    path: str | Path,
    *,
    baseline: str | Path | Baseline | None = None,
    encoder: Encoder | None = None,
    band: tuple[float, float] | None = None,
    definition: Definition = "tabulated",
    llm: LLM | None = None,
    anchors: str | Path | None = None,
    seed: int = 0,
) -> Report:
    """Return rarity, OOD-ness and diversity of the texts in a file.

    Args:
        path: Plain lines, JSON lines with `text` (and `path` or `leaf`, if known), a JSON list, or
            CSV with a column `text`.
        baseline: A baseline, or a file in one of these formats; by default the bundled baseline.
        encoder: By default all-MiniLM-L6-v2.
        band: Bounds of OOD-ness; only the texts inside are reported.
        definition: Definition of OOD-ness.
        llm: The model that estimates rarity; by default the shipped offline head.
        anchors: Rates that calibrate rarity; see `Metrics.rarity`.
        seed: Seed of the bootstrap.

    Raises:
        DataError: If a file cannot be read, or a line has no text.
        UsageError: If no text lies inside the band.
        EncoderError: If the encoder fails.
    """
    metrics = Metrics(encoder, baseline, seed=seed)
    report = score_records(metrics, path, band=band, definition=definition)
    if llm is None and anchors is None:
        return report
    texts = report.band.texts if report.band else [one.text for one in read_records(path)]
    return report.model_copy(update={"rarity": metrics.rarity(texts, llm, anchors=anchors)})


def score_records(
    metrics: Metrics,
    path: str | Path,
    *,
    band: tuple[float, float] | None = None,
    definition: Definition = "tabulated",
) -> Report:
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


def table_of_file(
    path: str | Path,
    *,
    baseline: str | Path | Baseline | None = None,
    encoder: Encoder | None = None,
    seed: int = 0,
) -> Table:
    """Return the paper's table for the texts in a file.

    Args:
        path: As for `score_file`.
        baseline: As for `score_file`, e.g. DriveLM's `v1_1_train_nus.json`.
        encoder: By default all-MiniLM-L6-v2.
        seed: Seed of the draws.

    Raises:
        DataError: If a file cannot be read, or a line has no text.
        EncoderError: If the encoder fails.
    """
    texts = [record.text for record in read_records(path)]
    return paper_table(Metrics(encoder, baseline, seed=seed), texts)


def _groups(records: list[Record]) -> tuple[str, ...] | None:
    labels = tuple(record.group for record in records if record.group is not None)
    return labels if len(labels) == len(records) else None
