"""Drives of stacks in worker processes: a stack that ends its process loses one scene, not the others."""

import atexit
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, Future, as_completed
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product

from oodscen._members import close, using
from oodscen._parallel.processes import Processes, is_worker
from oodscen._pipeline.sweep import check_workers
from oodscen._registry import driver_maker, make_simulator
from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import twin_id
from oodscen.data._scene import Scene
from oodscen.errors import OodscenError, RunStopped, UsageError
from oodscen.protocols import Simulator
from oodscen.stages._drive import DrivePlan, MakeDriver, drive, failed_drive

MAKING_S = 60.0
"""Seconds in which a limited drive must at least be able to make its drivers and simulator."""

Results = list[DriveResult]
"""The drives of one driver in a scene and in its twin."""


@dataclass(frozen=True)
class DriveJob:
    """The settings of a worker that apply to all its drives."""

    driver: str
    """Registered name, or `module:attr`."""
    simulator: str
    """Registered name, or `module:attr`."""
    seed: int


def drive_all(
    drivers: Sequence[str],
    scenes: Sequence[Scene],
    simulator: str,
    seed: int,
    *,
    workers: int = 1,
    time_limit_s: float | None = None,
) -> Iterator[Results]:
    """Let every driver drive every scene and its ordinary twin; yield results as they finish.

    What a driver prints goes to standard error. Each has processes of its own, so that what it changes in them
    changes no other driver's drives. If a process dies, the drives in it fail, and the others go on in a fresh one.

    Args:
        drivers: Registered names, or `module:attr`.
        scenes: The scenes to drive.
        simulator: Registered name, or `module:attr`.
        seed: Seed of the simulator's random streams.
        workers: Processes; 0 drives in this process, where debuggers work and a stack can end everything.
        time_limit_s: Seconds after which a scene fails whose drives, with the making of their drivers, have not
            ended; by default drives take as long as they need. A process may take `MAKING_S`, or as long, to
            import and make the driver and the simulator before.

    Raises:
        UsageError: If there is no such driver or simulator, a driver cannot be made, or there is a time limit but
            no process to end.
        RunStopped: If no process can be started.
    """
    if workers <= 0:
        if time_limit_s is not None:
            raise UsageError("--time-limit ends processes; with --workers 0 there is none to end")
        yield from _drive_here(drivers, scenes, simulator, seed)
        return
    check_workers(simulator, workers, None)
    jobs = [DriveJob(driver, simulator, seed) for driver in drivers]
    making_s = None if time_limit_s is None else max(time_limit_s, MAKING_S)
    if len(jobs) > 1:
        with Processes(1, limit_s=making_s) as pool:
            for job in jobs:
                _finish(pool.submit(_prepare, job, None), job)
    for job in jobs:
        prepare = partial(_prepare, job, None if time_limit_s is None else scenes[:1])
        with Processes(
            workers, limit_s=time_limit_s, prepare=prepare, prepare_limit_s=making_s
        ) as pool:
            _finish(pool.submit(is_worker), job)
            futures = {pool.submit(_drive_one, job, scene): scene for scene in scenes}
            for future in as_completed(futures):
                try:
                    yield future.result()
                except RunStopped:
                    raise
                except Exception as error:
                    yield _failed_results(job.driver, futures[future], error)


def _drive_here(
    drivers: Sequence[str], scenes: Sequence[Scene], simulator: str, seed: int
) -> Iterator[Results]:
    makers = {name: driver_maker(name) for name in drivers}
    with using(make_simulator(simulator)) as shared:
        for name, scene in product(drivers, scenes):
            yield drive([scene], makers[name], shared, name=name, seed=seed)


def _finish(preparing: Future[object], job: DriveJob) -> None:
    """Wait until a driver was made, so that errors appear before any drive."""
    try:
        preparing.result()
    except BrokenExecutor as error:
        raise UsageError(f"the driver {job.driver!r} cannot be made: {error}") from None


def _prepare(job: DriveJob, rehearsed: Sequence[Scene] | None) -> None:
    """Make the simulator and the first driver of a worker.

    With a time limit, which is for drives and the making of their drivers, that driver is not kept, and scenes are
    rehearsed without one, as the first run of a simulator takes longer.
    """
    simulator, make = _simulator_and_maker(job)
    if rehearsed is None:
        return
    make()
    for scene in rehearsed:
        with suppress(OodscenError):
            DrivePlan(scene, simulator, job.seed)


@lru_cache(maxsize=1)
def _simulator_and_maker(job: DriveJob) -> tuple[Simulator, MakeDriver]:
    """Return the simulator of this worker and the maker of its drivers, which it makes once."""
    make = driver_maker(job.driver)
    simulator = make_simulator(job.simulator)
    atexit.register(close, simulator)
    return simulator, make


def _drive_one(job: DriveJob, scene: Scene) -> Results:
    """Drive a scene and its twin, inside a worker."""
    simulator, make = _simulator_and_maker(job)
    return drive([scene], make, simulator, name=job.driver, seed=job.seed)


def _failed_results(name: str, scene: Scene, error: Exception) -> Results:
    """Return the failed results of a scene and its twin."""
    failed = [failed_drive(drive_id, name, error) for drive_id in (scene.id, twin_id(scene.id))]
    return [result.model_copy(update={"made_from": scene.digest()}) for result in failed]
