from .estimate import estimate as estimate
from .options import Progress as Progress
from .options import RunOptions as RunOptions
from .pipeline import Pipeline as Pipeline
from .run import run_study as run_study
from .sweep import Outputs as Outputs
