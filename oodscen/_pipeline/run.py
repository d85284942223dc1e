"""Running a whole study in one call."""

from collections.abc import Mapping
from concurrent.futures import Executor
from pathlib import Path

from oodscen._arguments import checked
from oodscen._numbers import whole_number
from oodscen._pipeline.jobs import Outputs
from oodscen._pipeline.options import RunOptions
from oodscen._pipeline.pipeline import Pipeline
from oodscen._pipeline.sweep import check_workers
from oodscen._progress import Progress, reporting
from oodscen.llm._accounting import Ledger
from oodscen.llm._remote.limits import Limits
from oodscen.protocols import LLM
from oodscen.study._config import StudyConfig
from oodscen.study._study import Study
from oodscen.tree._scenario_tree import ScenarioTree


@checked
def run_study(
    out: str | Path,
    config: StudyConfig | None = None,
    *,
    workers: int = 0,
    executor: Executor | None = None,
    progress: Progress | bool | None = None,
    models: Mapping[str, LLM] | None = None,
    outputs: Outputs | None = None,
    limits: Limits | None = None,
    ledger: Ledger | None = None,
    tree: ScenarioTree | None = None,
    retry: bool = False,
) -> Study:
    """Run the whole paper into a folder, or continue a run that stopped.

    Args:
        out: The folder; created if it does not exist.
        config: What to run; by default the paper's numbers on the embedded defaults.
        workers: Simulation processes; 0 simulates in this process. Workers never import the calling script,
            so it needs no main guard, but a custom simulator must be in a module.
        executor: Runs the simulation jobs instead of local processes.
        progress: True for one progress bar per stage, which is a widget in a notebook; or a callable, called with
            the stage, the items done and their total after every finished item.
        models: Models to use for names in the configuration; other names are looked up by `make_llm`.
        outputs: Further outputs to keep for each newly simulated episode: traces, annotations, videos.
        limits: Caps, prices and concurrency of the models.
        ledger: Keeps running totals of the calls.
        tree: The tree to begin with, in place of one that the model grows; a begun study needs it no more.
        retry: Redo every failed item; otherwise only those that failed because no answer came.

    Raises:
        UsageError: For an unknown component, a missing extra, a simulator that workers cannot import, or a
            folder of another study.
        DataError: If the tree has no path and red teaming adds none, or a situation directly below its root.
        RunStopped: When a cap is reached or an endpoint is given up; running again continues.
        StudyError: When the folder cannot be written.
    """
    config = with_given_tree(config or StudyConfig(), tree, out)
    whole_number("workers", workers)
    check_workers(config.simulator, workers, executor)
    ledger = ledger or Ledger()
    with reporting(progress, ledger) as report_progress:
        options = RunOptions(
            workers=workers,
            executor=executor,
            progress=report_progress,
            models=models or {},
            outputs=outputs or Outputs(),
            limits=limits or Limits(),
            ledger=ledger,
            tree=tree,
            retry=retry,
        )
        return Pipeline(out, config, options).run()


def with_given_tree(config: StudyConfig, tree: ScenarioTree | None, out: str | Path) -> StudyConfig:
    """Return a configuration with the digest of the tree that is given, or was when the study in a folder began."""
    if tree is not None:
        digest: str | None = tree.digest()
    elif config.tree is None and (before := Study(out)).store.has("study.json"):
        digest = before.config.tree
    else:
        return config
    if digest == config.tree:
        return config
    return StudyConfig.parse({**config.model_dump(exclude_unset=True), "tree": digest})
