from ._config import StudyConfig as StudyConfig
from ._store import Store as Store
from ._study import TABLES as TABLES
from ._study import TREES as TREES
from ._study import Study as Study
