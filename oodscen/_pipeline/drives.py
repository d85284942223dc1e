"""Drives of stacks in worker processes: a stack that ends its process loses one scene, not the others."""

import atexit
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, as_completed
from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import lru_cache

from oodscen._members import close, using
from oodscen._pipeline.sweep import check_workers
from oodscen._processes import Processes
from oodscen._registry import driver_maker, make_simulator
from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import twin_id
from oodscen.data._scene import Scene
from oodscen.errors import OodscenError, RunStopped, UsageError
from oodscen.protocols import Simulator
from oodscen.stages._drive import MakeDriver, drive, failed_drive

MAKING_S = 60.0
"""Seconds in which a limited drive must at least be able to make its drivers and simulator."""

Results = list[DriveResult]
"""The drives of one driver in a scene and in its twin."""


@dataclass(frozen=True)
class DriveJob:
    """The settings of a worker that apply to all its drives."""

    drivers: tuple[str, ...]
    """Registered names, or `module:attr`."""
    simulator: str
    """Registered name, or `module:attr`."""
    seed: int = 0


def drive_all(
    job: DriveJob,
    scenes: Sequence[Scene],
    *,
    workers: int = 1,
    time_limit_s: float | None = None,
) -> Iterator[Results]:
    """Let every driver drive every scene and its ordinary twin; yield results as they finish.

    What a driver prints goes to standard error. If a process dies, the drives in it fail, and the others go on in
    a fresh one.

    Args:
        job: Settings for the workers.
        scenes: The scenes to drive.
        workers: Processes; 0 drives in this process, where debuggers work and a stack can end everything.
        time_limit_s: Seconds after which a scene whose drives have not ended fails; by default drives take as
            long as they need. With it, the making of drivers and simulator may take `MAKING_S`, or as long.

    Raises:
        UsageError: If there is no such driver or simulator, a driver cannot be made, or there is a time limit but
            no process to end.
        RunStopped: If no process can be started.
    """
    turns = [(driver, scene) for driver in job.drivers for scene in scenes]
    if workers <= 0:
        if time_limit_s is not None:
            raise UsageError("--time-limit ends processes; with --workers 0 there is none to end")
        yield from _drive_here(job, turns)
        return
    check_workers(job.simulator, workers, None)
    with Processes(workers) as pool:
        if time_limit_s is not None:
            pool.limit_s = max(time_limit_s, MAKING_S)
        try:
            pool.submit(_prepare, job).result()
        except BrokenExecutor as error:
            named = ", ".join(map(repr, job.drivers))
            raise UsageError(f"the driver {named} cannot be made: {error}") from None
        pool.limit_s = time_limit_s
        futures = {pool.submit(_drive_one, job, *turn): turn for turn in turns}
        for future in as_completed(futures):
            try:
                yield future.result()
            except RunStopped:
                raise
            except (BrokenExecutor, OodscenError) as error:
                yield _failed(*futures[future], error)


def _drive_here(job: DriveJob, turns: Sequence[tuple[str, Scene]]) -> Iterator[Results]:
    with redirect_stdout(sys.stderr):
        makers = {name: driver_maker(name) for name in job.drivers}
    with using(make_simulator(job.simulator)) as simulator:
        for name, scene in turns:
            with redirect_stdout(sys.stderr):
                found = drive([scene], makers[name], simulator, name=name, seed=job.seed)
            yield found


def _prepare(job: DriveJob) -> None:
    """Make the drivers and the simulator of a job, so that errors appear before any drive."""
    _tools(job)


@lru_cache(maxsize=1)
def _tools(job: DriveJob) -> tuple[Simulator, Mapping[str, MakeDriver]]:
    """Return the simulator of this worker and the makers of its drivers."""
    os.dup2(sys.stderr.fileno(), 1)
    makers = {name: driver_maker(name) for name in job.drivers}
    simulator = make_simulator(job.simulator)
    atexit.register(close, simulator)
    return simulator, makers


def _drive_one(job: DriveJob, name: str, scene: Scene) -> Results:
    """Drive a scene and its twin, inside a worker."""
    simulator, makers = _tools(job)
    return drive([scene], makers[name], simulator, name=name, seed=job.seed)


def _failed(name: str, scene: Scene, error: Exception) -> Results:
    """Return the failed results of a scene and its twin."""
    dead = [failed_drive(one, name, error) for one in (scene.id, twin_id(scene.id))]
    return [one.model_copy(update={"made_from": scene.digest()}) for one in dead]
