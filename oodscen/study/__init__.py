"""A run on disk: the folder that is both the result and the resume point."""

from oodscen.study.config import StudyConfig
from oodscen.study.context import Progress
from oodscen.study.estimate import estimate
from oodscen.study.pipeline import Pipeline
from oodscen.study.run import run_study
from oodscen.study.store import Store
from oodscen.study.study import TABLES, TREES, Study
from oodscen.study.sweep import Extras

__all__ = [
    "TABLES",
    "TREES",
    "Extras",
    "Pipeline",
    "Progress",
    "Store",
    "Study",
    "StudyConfig",
    "estimate",
    "run_study",
]
