"""The options of a run that do not belong to its study's identity."""

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field

from oodscen._pipeline.jobs import Outputs
from oodscen._progress import Progress as Progress
from oodscen._progress import silent
from oodscen.llm._accounting import Ledger
from oodscen.llm._remote.limits import Limits
from oodscen.protocols import LLM
from oodscen.tree._scenario_tree import ScenarioTree


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options that may differ between a run and its continuation."""

    workers: int = 0
    """Simulation processes; 0 simulates in this process."""
    executor: Executor | None = None
    """Runs the simulation jobs instead of local processes."""
    progress: Progress = silent
    """Called after every finished item."""
    models: Mapping[str, LLM] = field(default_factory=dict)
    """Models to use for names in the configuration."""
    outputs: Outputs = field(default_factory=Outputs)
    """Further outputs to keep for each newly simulated episode."""
    limits: Limits = field(default_factory=Limits)
    """Caps, prices and concurrency of the models."""
    ledger: Ledger = field(default_factory=Ledger)
    """Keeps running totals of the calls."""
    tree: ScenarioTree | None = None
    """The tree to begin with, if the configuration says that one is given; a begun study has it."""
    retry: bool = False
    """Redo all failed items; otherwise only those marked as retryable."""
