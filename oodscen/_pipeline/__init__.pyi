from .context import Progress as Progress
from .estimate import estimate as estimate
from .pipeline import Pipeline as Pipeline
from .run import run_study as run_study
from .sweep import Extras as Extras
