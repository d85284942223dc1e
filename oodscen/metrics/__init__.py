"""Metrics of sets of texts: OOD-ness against a baseline, and diversity.

`Metrics(encoder, baseline)` computes both in the definition that the paper prints and in the one that
its table fits; `docs/metrics.md` sets them side by side.
"""

from oodscen.metrics.diversity import Diversity
from oodscen.metrics.metrics import Metrics
from oodscen.metrics.oodness import Definition, Neighbour, Oodness
from oodscen.metrics.report import Band, BaselineBatch, Comparison, Contrast, GroupScore, Report
from oodscen.metrics.score import score_file
from oodscen.metrics.statistics import Interval

__all__ = [
    "Band",
    "BaselineBatch",
    "Comparison",
    "Contrast",
    "Definition",
    "Diversity",
    "GroupScore",
    "Interval",
    "Metrics",
    "Neighbour",
    "Oodness",
    "Report",
    "score_file",
]
