"""Sweeps over many scenes in worker processes: picklable jobs go out, bytes come back."""

from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from contextlib import contextmanager, nullcontext
from itertools import chain
from typing import Any

from oodscen._arguments import instance_of
from oodscen._entry_points import load_factory
from oodscen._members import reason
from oodscen._parallel.processes import Processes, is_importable, is_script
from oodscen._pipeline.jobs import Job, SweepResult
from oodscen._pipeline.worker import failed_drives, failed_episode, run_chunk
from oodscen.data._pairing import scene_of
from oodscen.data._scene import Scene
from oodscen.errors import MissingExtra, RunStopped, SimulatorCrash, UsageError

CHUNK = 16
"""Maximum number of scenes per job. A job starts one simulator, and all its scenes share one map."""

Chunk = tuple[Scene, ...]


def sweep(
    job: Job,
    scenes: Sequence[Scene],
    *,
    workers: int = 0,
    executor: Executor | None = None,
) -> Iterator[SweepResult]:
    """Run scenes and yield results as they finish, in any order.

    A scene that fails, breaks the simulator or kills its process becomes a failed episode with its error; the
    others continue in a fresh simulator. When a worker process dies, the scenes it was running are retried
    once, one at a time.

    Args:
        job: Settings for the workers.
        scenes: The scenes to run.
        workers: Local processes; 0 runs in this process, where a scene that kills its process ends the sweep.
        executor: Used instead of local processes.

    Raises:
        UsageError: When local processes cannot import the simulator, or it is unknown.
        RunStopped: When no process can be started, or the executor fails.
    """
    check_workers(job.simulator, workers, executor)
    chunks = _chunks(scenes)
    if executor is None and workers <= 0:
        for chunk in chunks:
            yield from run_chunk(job, chunk)
        return
    lost: list[Chunk] = []
    if executor is not None:
        yield from _collect(executor, job, chunks, lost)
    else:
        with Processes(min(workers, max(1, len(chunks)))) as pool:
            yield from _collect(pool, job, chunks, lost)
    if lost:
        yield from _recover(job, chain.from_iterable(lost))


def check_workers(simulator: str, workers: int, executor: Executor | None) -> None:
    """Check before any work that local processes can run the simulator.

    Raises:
        UsageError: When they cannot import the simulator.
    """
    if workers <= 0 or executor is not None:
        return
    if not is_importable(simulator):
        raise UsageError(
            f"worker processes cannot import the simulator {simulator!r} from a script or notebook; put it into "
            "a module of its own and name it module:attr, or use workers=0"
        )
    with Processes(1) as pool:
        if is_script(simulator):
            pool.submit(load_factory, "simulator", simulator).result()


def _chunks(scenes: Sequence[Scene]) -> list[Chunk]:
    """Group the scenes by map, since building a map's scenery costs more than running a scene."""
    by_map: dict[str, list[Scene]] = {}
    for scene in scenes:
        by_map.setdefault(scene.map, []).append(scene)
    return [
        tuple(group[start : start + CHUNK])
        for group in by_map.values()
        for start in range(0, len(group), CHUNK)
    ]


def _collect(
    executor: Executor, job: Job, chunks: Sequence[Chunk], lost: list[Chunk]
) -> Iterator[SweepResult]:
    """Yield results as they finish, and collect the chunks whose process died."""
    faults = nullcontext if isinstance(executor, Processes) else _faults_of_executor
    futures: dict[Future[list[SweepResult]], Chunk] = {}
    try:
        with faults():
            for chunk in chunks:
                future = executor.submit(run_chunk, job, chunk)
                instance_of("a submitted job", future, Future)
                futures[future] = chunk
        for future in as_completed(futures):
            try:
                with faults():
                    results = _results_of(future.result(), futures[future])
            except BrokenExecutor:
                lost.append(futures[future])
                continue
            yield from results
    finally:
        for future in futures:
            future.cancel()


@contextmanager
def _faults_of_executor() -> Iterator[None]:
    """Raise what an executor raises by itself as `RunStopped`."""
    try:
        yield
    except (BrokenExecutor, MissingExtra, RunStopped):
        raise
    except Exception as error:
        raise RunStopped(
            f"the executor failed ({reason(error)}); the same call continues with another one"
        ) from error


def _results_of(results: Any, chunk: Chunk) -> list[SweepResult]:
    """Return what an executor gives for a chunk.

    Raises:
        UsageError: If these are not its results.
    """
    instance_of("the result", results, list)
    for result in results:
        instance_of("each result", result, SweepResult)
    returned = {scene_of(result.episode.id) for result in results}
    if returned != {scene_of(scene.id) for scene in chunk}:
        raise UsageError(
            f"the executor returned the results of other scenes: {', '.join(sorted(returned))}"
        )
    return list(results)


def _recover(job: Job, scenes: Iterable[Scene]) -> Iterator[SweepResult]:
    """Retry scenes one at a time after their process died; one that kills its own process fails."""
    with Processes(1) as pool:
        for scene in scenes:
            try:
                yield from pool.submit(run_chunk, job, (scene,)).result()
            except BrokenExecutor as error:
                crash = SimulatorCrash(job.simulator, str(error), retryable=True)
                failed = SweepResult(failed_episode(job, scene.id, crash))
                yield failed
                if not scene.is_ordinary:
                    yield from failed_drives(job, failed.episode)
