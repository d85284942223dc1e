"""Many scenes in many processes: picklable jobs go out, bytes come back."""

import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field

from oodscen.episode import Episode
from oodscen.errors import MissingExtra, SceneError, SimulatorError
from oodscen.protocols import Frame, Simulator
from oodscen.registry import make_simulator
from oodscen.scene import Scene
from oodscen.simulation import simulate

CHUNK = 4
"""Scenes per job: one simulator is started for each job."""

JPEG_QUALITY = 90


@dataclass(frozen=True)
class Job:
    """What a worker must know besides the scenes."""

    simulator: str
    """Registered name, or `module:attr`."""
    seed: int = 0


@dataclass(frozen=True)
class SweepResult:
    """What comes back for one scene."""

    episode: Episode
    frames: dict[str, bytes] = field(default_factory=dict)
    """JPEG by moment."""


def sweep(
    job: Job,
    scenes: Sequence[Scene],
    *,
    workers: int = 1,
    executor: Executor | None = None,
) -> Iterator[SweepResult]:
    """Run scenes and yield results as they finish, in any order.

    A scene that fails is an episode with its error. When a worker process dies, the scenes that
    it took with it are run once more, each in a process of its own.

    Args:
        job: What the workers must know.
        scenes: What to run.
        workers: Local processes; 1 runs here.
        executor: Used instead of local processes.
    """
    chunks = [tuple(scenes[i : i + CHUNK]) for i in range(0, len(scenes), CHUNK)]
    if executor is not None:
        yield from _collect(executor, job, chunks, [])
        return
    if workers <= 1:
        for chunk in chunks:
            yield from run_chunk(job, chunk)
        return
    lost: list[Scene] = []
    with _processes(min(workers, max(1, len(chunks)))) as pool:
        yield from _collect(pool, job, chunks, lost)
    for scene in lost:
        with _processes(1) as pool:
            again: list[Scene] = []
            yield from _collect(pool, job, [(scene,)], again)
        for dead in again:
            yield SweepResult(failed_episode(job, dead, "the simulator's process died"))


def run_chunk(job: Job, scenes: Sequence[Scene]) -> list[SweepResult]:
    """Run some scenes in one simulator; what a worker executes."""
    with make_simulator(job.simulator) as simulator:
        return [_run(job, simulator, scene) for scene in scenes]


def failed_episode(job: Job, scene: Scene, error: str) -> Episode:
    """Return the record of a scene that could not be run."""
    return Episode(
        id=scene.id,
        scene_id=scene.id,
        status="failed",
        error=error,
        simulator=job.simulator,
        seed=job.seed,
    )


def _run(job: Job, simulator: Simulator, scene: Scene) -> SweepResult:
    try:
        simulated = simulate(scene, simulator, seed=job.seed)
    except (SceneError, SimulatorError) as error:
        return SweepResult(failed_episode(job, scene, str(error)))
    frames = {moment: to_jpeg(frame) for moment, frame in simulated.frames.items()}
    files = {moment: f"frames/{scene.id}/{moment}.jpg" for moment in frames}
    return SweepResult(simulated.episode.model_copy(update={"frames": files}), frames)


def to_jpeg(frame: Frame, quality: int = JPEG_QUALITY) -> bytes:
    """Encode a frame's colours."""
    try:
        import cv2
    except ImportError:
        raise MissingExtra("writing frames", "pybullet", "opencv-python-headless") from None
    _, data = cv2.imencode(".jpg", frame.rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    return data.tobytes()


def _collect(
    executor: Executor, job: Job, chunks: Sequence[tuple[Scene, ...]], lost: list[Scene]
) -> Iterator[SweepResult]:
    futures = {executor.submit(run_chunk, job, chunk): chunk for chunk in chunks}
    for future in as_completed(futures):
        try:
            results = future.result()
        except BrokenExecutor:
            lost.extend(futures[future])
            continue
        yield from results


def _processes(count: int) -> ProcessPoolExecutor:
    """Return processes that inherit no threads and no simulator."""
    return ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"))
