"""Baselines: texts of ordinary driving, against which OOD-ness is measured.

`ordinary_driving()` is the corpus that is shipped; `load_baseline(file)` reads one of your own.
"""

from oodscen.baselines.baseline import Baseline, load_baseline
from oodscen.baselines.ordinary import ordinary_driving
from oodscen.baselines.texts import Record, check_texts, read_records

__all__ = [
    "Baseline",
    "Record",
    "check_texts",
    "load_baseline",
    "ordinary_driving",
    "read_records",
]
