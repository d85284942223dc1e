"""Metrics of sets of texts: OOD-ness against a baseline, and diversity.

`Metrics(encoder, baseline)` computes both by two definitions: the one that the paper prints, and the one
that fits its table. `docs/metrics.md` compares them.
"""

from oodscen.metrics._comparison import Comparison, Contrast, SetDistance
from oodscen.metrics._detection.calibration import Calibration
from oodscen.metrics._detection.detectors import DETECTORS
from oodscen.metrics._detection.guard import OffTopicFlags
from oodscen.metrics._diversity import Diversity
from oodscen.metrics._metrics import Metrics
from oodscen.metrics._oodness import Definition, Measure, Neighbour, Oodness
from oodscen.metrics._report import BaselineBatch, ControlCheck, GroupScore, Report
from oodscen.metrics._score import score_file, table_of_file
from oodscen.metrics._selection import Band, Selection
from oodscen.metrics._table import Table, paper_table
from oodscen.metrics._variety import Variety
from oodscen.statistics._auroc import Auroc, auroc
from oodscen.statistics._intervals import Interval

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
