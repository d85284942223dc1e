"""Metrics of sets of texts: OOD-ness against a baseline, and diversity.

`Metrics(encoder, baseline)` computes both in the definition that the paper prints and in the one that
its table fits; `docs/metrics.md` sets them side by side.
"""

from oodscen.metrics.calibration import Calibration
from oodscen.metrics.detectors import DETECTORS
from oodscen.metrics.diversity import Diversity
from oodscen.metrics.guard import OffTopicFlags
from oodscen.metrics.metrics import Metrics
from oodscen.metrics.oodness import Definition, Measure, Neighbour, Oodness
from oodscen.metrics.report import (
    Band,
    BaselineBatch,
    Comparison,
    Contrast,
    ControlCheck,
    GroupScore,
    Report,
    Selection,
    SetDistance,
    Variety,
)
from oodscen.metrics.score import score_file, table_of_file
from oodscen.metrics.separation import Auroc, auroc
from oodscen.metrics.statistics import Interval
from oodscen.metrics.table import Table, paper_table

__all__ = [
    "DETECTORS",
    "Auroc",
    "Band",
    "BaselineBatch",
    "Calibration",
    "Comparison",
    "Contrast",
    "ControlCheck",
    "Definition",
    "Diversity",
    "GroupScore",
    "Interval",
    "Measure",
    "Metrics",
    "Neighbour",
    "OffTopicFlags",
    "Oodness",
    "Report",
    "Selection",
    "SetDistance",
    "Table",
    "Variety",
    "auroc",
    "paper_table",
    "score_file",
    "table_of_file",
]
