"""Sweeps over many scenes in worker processes: picklable jobs go out, bytes come back."""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np

from oodscen._arguments import instance_of
from oodscen._entry_points import load_factory
from oodscen._files import temporary_folder
from oodscen._jpeg import to_jpeg
from oodscen._members import close, is_interruption, reason
from oodscen._processes import Processes, is_importable, is_script
from oodscen._redaction import redact
from oodscen._registry import make_simulator
from oodscen._seeding import stream
from oodscen.data._claim import Claim
from oodscen.data._episode import ACTIONS, MOMENTS, REACTIONS_S, Episode
from oodscen.data._pairing import demand_id, scene_of, twin_id
from oodscen.data._scene import Scene
from oodscen.driving._trace_table import to_parquet
from oodscen.errors import MissingExtra, OodscenError, RunStopped, SimulatorCrash, UsageError
from oodscen.protocols import Camera, Frame, Simulator
from oodscen.stages._annotations import FrameAnnotations, annotate
from oodscen.stages._decision_retiming import retime
from oodscen.stages._demands.demanding import draw_demand
from oodscen.stages._rerun import Rerunner
from oodscen.stages._restage import Attempt, Restaging, restage
from oodscen.stages._simulate import Simulated, simulate
from oodscen.stages._video import View, record
from oodscen.study._store import Store

CHUNK = 16
"""Maximum number of scenes per job. A job starts one simulator, and all its scenes share one map."""

NOISE = 2
"""Largest change of a colour value by the sensor's noise, of 255."""

Chunk = tuple[Scene, ...]
Work = TypeVar("Work")


@dataclass(frozen=True)
class Outputs:
    """Outputs to keep for every episode besides its record and frames."""

    traces: bool = False
    """Keep `traces/<scene>.parquet`: the ground truth of the approach and of every action."""
    annotations: bool = False
    """Keep `frames/<scene>/<moment>.json` with images of ids, classes and depth."""
    video: View | None = None
    """Keep `videos/<scene>.mp4`: the approach, then the first safe action."""


@dataclass(frozen=True)
class Job:
    """The settings of a worker that apply to all its scenes."""

    simulator: str
    """Registered name, or `module:attr`."""
    seed: int = 0
    outputs: Outputs = Outputs()
    twins: bool = False
    """Run every scene's ordinary twin right after it, while the map's scenery is built."""
    demands: bool = False
    """Make and run every scene's ordinary demand right after its twin."""
    protocol: Literal["ours", "paper"] = "ours"
    """Protocol as in `simulate`; frames of the paper's whole trace are named `whole-<moment>.jpg`."""
    restages: bool = False
    """Re-stage scenes whose hazard cannot be named at the decision, or in which all or none of the actions are
    safe."""
    camera: Camera = field(default_factory=Camera)
    """The camera of the frames."""
    moments: tuple[str, ...] = MOMENTS
    """The moments of the frames."""
    claims: Mapping[str, tuple[Claim, ...]] = field(default_factory=dict)
    """The claims of the texts by scenario, which no re-staged scene may contradict."""
    reaction: tuple[float, ...] = REACTIONS_S
    """Reaction times of the drivers who try every action, s."""
    horizon: float | None = None
    """Time for which an action is watched, s; the scenes' own if `None`."""
    is_rear: bool = False
    """Take only the picture from the rear window at the decision, `rear.jpg`, and try no action."""


@dataclass(frozen=True)
class SweepResult:
    """The result of one scene or ordinary drive."""

    episode: Episode
    frames: dict[str, bytes] = field(default_factory=dict)
    """JPEG data by moment."""
    files: dict[str, bytes] = field(default_factory=dict)
    """Further requested files, by path in the study."""
    restaged: Scene | None = None
    """The scene that was run instead of the given one."""
    tried: tuple[Attempt, ...] = ()
    """Other stagings that were tried without success."""
    demand: Scene | None = None
    """The scene, if this is the result of a demand."""

    def save(self, store: Store) -> None:
        """Write the frames and all further files to the paths that the episode names."""
        for moment, file in self.episode.frames.items():
            store.write(file, self.frames[moment])
        for file, data in self.files.items():
            store.write(file, data)


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


def run_chunk(job: Job, scenes: Sequence[Scene]) -> list[SweepResult]:
    """Run some scenes in one simulator, inside a worker.

    After a crash the remaining scenes run in a fresh simulator.
    """
    results: list[SweepResult] = []
    waiting = list(reversed(scenes))
    while waiting:
        simulator = make_simulator(job.simulator)
        try:
            while waiting:
                drives = _run_drives(job, simulator, waiting.pop())
                results += drives
                if any(drive.episode.error_type == SimulatorCrash.__name__ for drive in drives):
                    break
        finally:
            close(simulator)
    return results


def _run_drives(job: Job, simulator: Simulator, scene: Scene) -> list[SweepResult]:
    """Run a scene, its twin and its demand, as far as the job asks for them."""
    result, simulated = _run(job, simulator, scene)
    results = [result]
    if scene.is_ordinary:
        return results
    ran = result.restaged or scene
    decision_s = result.episode.decision_s
    if simulated is None or decision_s is None:
        return results + _failed_drives(job, result.episode)
    if job.twins:
        results.append(_run(job, simulator, ran.twin(decision_s))[0])
    if job.demands:
        results.append(_demand(job, simulator, ran, simulated))
    return results


def _demand(job: Job, simulator: Simulator, scene: Scene, simulated: Simulated) -> SweepResult:
    """Make and run the demand of a scene that was run."""
    name = demand_id(scene.id)

    def run() -> SweepResult:
        demand = draw_demand(scene, simulated, _rerunner(job, simulator))
        return replace(_result(job, simulator, *demand), demand=demand.scene)

    result = _guarded(job, name, run)
    return SweepResult(result) if isinstance(result, Episode) else result


def _failed_drives(job: Job, episode: Episode) -> list[SweepResult]:
    """Return the failed records of the ordinary drives of a scene that could not be run."""
    names = [twin_id(episode.id)] if job.twins else []
    names += [demand_id(episode.id)] if job.demands else []
    error = f"its scene could not be run: {episode.error}"
    return [
        SweepResult(episode.model_copy(update={"id": name, "scene_id": name, "error": error}))
        for name in names
    ]


def failed_episode(job: Job, name: str, error: Exception) -> Episode:
    """Return the failed record of an item."""
    return Episode(
        id=name,
        scene_id=name,
        status="failed",
        error=redact(str(error)),
        error_type=type(error).__name__,
        retryable=getattr(error, "retryable", False),
        simulator=job.simulator,
        seed=job.seed,
    )


def _guarded(job: Job, name: str, work: Callable[[], Work]) -> Work | Episode:
    """Return the result of some work on an item, or the item's failed record."""
    try:
        return work()
    except MissingExtra:
        raise
    except OodscenError as error:
        return failed_episode(job, name, error)
    except BaseException as error:
        if is_interruption(error):
            raise
        return failed_episode(job, name, SimulatorCrash(job.simulator, reason(error)))


def _run(job: Job, simulator: Simulator, scene: Scene) -> tuple[SweepResult, Simulated | None]:
    """Run one scene, and re-stage it if the job says so; `None` instead of a run that failed."""

    def run() -> tuple[SweepResult, Simulated]:
        simulated = simulate(
            scene,
            simulator,
            seed=job.seed,
            camera=job.camera.behind() if job.is_rear else job.camera,
            actions=() if job.is_rear else ACTIONS,
            traces=job.outputs.traces,
            protocol=job.protocol,
            reaction=job.reaction,
            horizon=job.horizon,
            moments=("last",) if job.is_rear else job.moments,
        )
        restaging = Restaging(scene, simulated)
        if job.restages and not scene.is_ordinary:
            restaging = _improve(job, simulator, scene, simulated)
        result = _result(job, simulator, restaging.scene, restaging.simulated)
        changed = restaging.scene if restaging.scene is not scene else None
        return replace(result, restaged=changed, tried=restaging.tried), restaging.simulated

    outcome = _guarded(job, scene.id, run)
    return (SweepResult(outcome), None) if isinstance(outcome, Episode) else outcome


def _result(job: Job, simulator: Simulator, scene: Scene, simulated: Simulated) -> SweepResult:
    """Return the result of a run, with its pictures and files."""
    extra = _extra_files(job, simulator, scene, simulated)
    prefix = "whole-" if job.protocol == "paper" else ""
    frames: dict[str, bytes] = {}
    files: dict[str, str] = {}
    for moment, frame in simulated.frames.items():
        view = "rear" if job.is_rear else moment
        frames[moment] = to_jpeg(with_sensor_noise(frame, scene.id, view).rgb)
        files[moment] = f"frames/{scene.id}/{view if job.is_rear else prefix + moment}.jpg"
    written = extra | {files[moment]: data for moment, data in frames.items()}
    sha256 = {name: hashlib.sha256(data).hexdigest() for name, data in sorted(written.items())}
    changes = {"frames": files, "files": tuple(sorted(extra)), "file_sha256": sha256}
    return SweepResult(simulated.episode.model_copy(update=changes), frames, extra)


def _improve(job: Job, simulator: Simulator, scene: Scene, simulated: Simulated) -> Restaging:
    """Return the scene, re-staged if its hazard cannot be named or its choice does not matter, and its run."""
    restaging = Restaging(scene, simulated)
    rerunner, claims = _rerunner(job, simulator), job.claims.get(scene.scenario_id, ())
    if restaging.simulated.episode.is_below_floor:
        restaging = retime(scene, simulated, rerunner, claims)
    if not restaging.simulated.episode.is_decidable:
        second = restage(restaging.scene, restaging.simulated, rerunner, claims)
        restaging = _joined(restaging, second)
    return restaging


def _joined(first: Restaging, second: Restaging) -> Restaging:
    """Return the second of two re-stagings, with the attempts and the change of the first."""
    change = first.simulated.episode.restaged
    if change and second.scene is not first.scene:
        second = second.described(f"{change}; {second.simulated.episode.restaged}")
    return second._replace(tried=first.tried + second.tried)


def _rerunner(job: Job, simulator: Simulator) -> Rerunner:
    return Rerunner(simulator, job.seed, job.outputs.traces, job.camera, job.reaction)


def _extra_files(
    job: Job, simulator: Simulator, scene: Scene, simulated: Simulated
) -> dict[str, bytes]:
    """Return the requested outputs besides the frames, by path in the study."""
    files: dict[str, bytes] = {}
    catalogue = simulator.catalogue()
    if job.outputs.traces:
        files[f"traces/{scene.id}.parquet"] = to_parquet(simulated.to_arrow())
    if job.outputs.annotations:
        for moment, frame in simulated.frames.items():
            state = simulated.state_of(moment)
            annotations = annotate(frame, state, scene, catalogue, job.camera)
            classes = FrameAnnotations.semantic_map(frame, state, scene, catalogue, job.camera)
            for name, data in annotations.encoded(moment, frame, classes).items():
                files[f"frames/{scene.id}/{name}"] = data
    if job.outputs.video:
        action = next(iter(simulated.episode.safe_set), None)
        with temporary_folder() as folder:
            path = Path(folder, "video.mp4")
            record(
                scene,
                simulator,
                path,
                driver=action,
                view=job.outputs.video,
                seed=job.seed,
                camera=job.camera,
            )
            files[f"videos/{scene.id}.mp4"] = path.read_bytes()
    return files


def with_sensor_noise(frame: Frame, item: str, moment: str) -> Frame:
    """Return a frame with a sensor's noise, which depends on the item and the moment alone.

    Without it the first frames of a scene and of its ordinary drive can be the same bytes. A server that
    caches, or a reader that remembers, would tell from them which drives belong together.
    """
    noise = stream(0, "sensor-noise", item, moment).integers(
        -NOISE, NOISE, size=frame.rgb.shape, dtype=np.int16, endpoint=True
    )
    return replace(frame, rgb=np.clip(frame.rgb + noise, 0, 255).astype(np.uint8))


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
                    yield from _failed_drives(job, failed.episode)
