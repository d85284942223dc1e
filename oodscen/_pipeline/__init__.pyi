from .estimate import estimate as estimate
from .jobs import Outputs as Outputs
from .options import Progress as Progress
from .options import RunOptions as RunOptions
from .pipeline import Pipeline as Pipeline
from .run import run_study as run_study
