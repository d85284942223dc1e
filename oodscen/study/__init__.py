"""A run on disk: the folder that is both the result and the resume point."""

from oodscen.study.config import StudyConfig
from oodscen.study.store import Store
from oodscen.study.study import TABLES, TREES, Study

__all__ = ["TABLES", "TREES", "Store", "Study", "StudyConfig"]
