"""Baselines: texts of ordinary driving, the reference for OOD-ness.

`ordinary_driving()` is the bundled corpus; `load_baseline(file)` reads your own.
`load_controls(split)` and `load_off_topic(split)` return texts for testing a measure.
"""

from oodscen.baselines._baseline import Baseline, load_baseline
from oodscen.baselines._controls import Control, load_controls
from oodscen.baselines._duplicates import Duplicate, NearDuplicates, near_duplicates
from oodscen.baselines._embedded import open_embeddings, write_embeddings
from oodscen.baselines._handwritten import handwritten_driving
from oodscen.baselines._off_topic import OffTopic, load_off_topic
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.baselines._texts import Record, check_texts, read_records

__all__ = [
    "Baseline",
    "Control",
    "Duplicate",
    "NearDuplicates",
    "OffTopic",
    "Record",
    "check_texts",
    "handwritten_driving",
    "load_baseline",
    "load_controls",
    "load_off_topic",
    "near_duplicates",
    "open_embeddings",
    "ordinary_driving",
    "read_records",
    "write_embeddings",
]
