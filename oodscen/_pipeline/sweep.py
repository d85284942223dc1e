"""Sweeps over many scenes in worker processes: picklable jobs go out, bytes come back."""

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, as_completed
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Literal

from oodscen._conformance import reason
from oodscen._files import temporary_folder
from oodscen._processes import Processes, is_importable, is_script
from oodscen._registry import find, make_simulator
from oodscen.data._claim import Claim
from oodscen.data._episode import Episode
from oodscen.data._scene import Scene
from oodscen.data._twins import twin_id
from oodscen.driving._trace_table import to_parquet
from oodscen.errors import MissingExtra, OodscenError, SimulatorCrash, UsageError
from oodscen.protocols import Camera, Frame, Simulator
from oodscen.stages._annotations import annotate, encode_annotations, semantic_map
from oodscen.stages._decision_retiming import retimed
from oodscen.stages._restage import Attempt, Restaging, restaged
from oodscen.stages._simulate import Simulated, simulate
from oodscen.stages._video import View, record
from oodscen.study._store import Store

CHUNK = 16
"""Maximum number of scenes per job. A job starts one simulator, and all its scenes share one map."""

JPEG_QUALITY = 90

Chunk = tuple[Scene, ...]


@dataclass(frozen=True)
class Extras:
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
    extras: Extras = Extras()
    twins: bool = False
    """Run every scene's ordinary twin right after it, while the map's scenery is built."""
    protocol: Literal["ours", "paper"] = "ours"
    """Protocol as in `simulate`; frames of the paper's whole trace are named `whole-<moment>.jpg`."""
    restages: bool = False
    """Re-stage scenes whose hazard cannot be named at the decision, or in which all or none of the actions are
    safe."""
    camera: Camera = field(default_factory=Camera)
    """The camera of the frames."""
    claims: Mapping[str, tuple[Claim, ...]] = field(default_factory=dict)
    """The claims of the texts by scenario, which no re-staged scene may contradict."""


@dataclass(frozen=True)
class SweepResult:
    """The result of one scene or twin."""

    episode: Episode
    frames: dict[str, bytes] = field(default_factory=dict)
    """JPEG data by moment."""
    files: dict[str, bytes] = field(default_factory=dict)
    """Further requested files, by path in the study."""
    restaged: Scene | None = None
    """The scene that was run instead of the given one."""
    tried: tuple[Attempt, ...] = ()
    """Other stagings that were tried without success."""

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
        RunStopped: When no process can be started.
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
            pool.submit(find, "simulator", simulator).result()


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
                scene = waiting.pop()
                result = _run(job, simulator, scene)
                results.append(result)
                broke_down = result.episode.error_type == SimulatorCrash.__name__
                if job.twins and not scene.is_twin:
                    if result.episode.decision_s is None:
                        results.append(SweepResult(_twin_of_none(result.episode)))
                    else:
                        waiting.append((result.restaged or scene).twin(result.episode.decision_s))
                if broke_down:
                    break
        finally:
            with suppress(Exception):
                simulator.close()
    return results


def _twin_of_none(episode: Episode) -> Episode:
    """Return the failed record of a twin whose scene could not be run."""
    name = twin_id(episode.id)
    error = f"its scene could not be run: {episode.error}"
    return episode.model_copy(update={"id": name, "scene_id": name, "error": error})


def failed_episode(job: Job, scene: Scene, error: Exception) -> Episode:
    """Return the failed record of a scene."""
    return Episode(
        id=scene.id,
        scene_id=scene.id,
        status="failed",
        error=str(error),
        error_type=type(error).__name__,
        retryable=getattr(error, "retryable", False),
        simulator=job.simulator,
        seed=job.seed,
    )


def _run(job: Job, simulator: Simulator, scene: Scene) -> SweepResult:
    try:
        given, tried = scene, tuple[Attempt, ...]()
        simulated = simulate(
            scene,
            simulator,
            seed=job.seed,
            camera=job.camera,
            traces=job.extras.traces,
            protocol=job.protocol,
        )
        if job.restages and not scene.is_twin:
            scene, simulated, tried = _improved(job, simulator, scene, simulated)
        extra = _extra_files(job, simulator, scene, simulated)
    except MissingExtra:
        raise
    except OodscenError as error:
        return SweepResult(failed_episode(job, scene, error))
    except (Exception, SystemExit) as error:
        crash = SimulatorCrash(job.simulator, reason(error))
        return SweepResult(failed_episode(job, scene, crash))
    frames = {moment: to_jpeg(frame) for moment, frame in simulated.frames.items()}
    prefix = "whole-" if job.protocol == "paper" else ""
    files = {moment: f"frames/{scene.id}/{prefix}{moment}.jpg" for moment in frames}
    written = extra | {files[moment]: data for moment, data in frames.items()}
    named = {
        "frames": files,
        "files": tuple(sorted(extra)),
        "file_sha256": {
            name: hashlib.sha256(data).hexdigest() for name, data in sorted(written.items())
        },
    }
    changed = scene if scene is not given else None
    return SweepResult(simulated.episode.model_copy(update=named), frames, extra, changed, tried)


def _improved(job: Job, simulator: Simulator, scene: Scene, simulated: Simulated) -> Restaging:
    """Return the scene, re-staged if its hazard cannot be named or its choice does not matter, and its run."""
    found = Restaging(scene, simulated)
    for stage in (retimed, restaged):
        episode = found.simulated.episode
        if episode.is_below_floor if stage is retimed else not episode.is_decidable:
            better = stage(
                found.scene,
                found.simulated,
                simulator,
                job.seed,
                job.extras.traces,
                job.camera,
                job.claims.get(scene.scenario_id, ()),
            )
            if episode.restaged and better.scene is not found.scene:
                better = _described(
                    better, f"{episode.restaged}; {better.simulated.episode.restaged}"
                )
            found = better._replace(tried=found.tried + better.tried)
    return found


def _described(found: Restaging, how: str) -> Restaging:
    """Return a re-staging with another description of the change."""
    episode = found.simulated.episode.model_copy(update={"restaged": how})
    return found._replace(simulated=replace(found.simulated, episode=episode))


def _extra_files(
    job: Job, simulator: Simulator, scene: Scene, simulated: Simulated
) -> dict[str, bytes]:
    """Return the requested outputs besides the frames, by path in the study."""
    files: dict[str, bytes] = {}
    catalogue = simulator.catalogue()
    if job.extras.traces:
        files[f"traces/{scene.id}.parquet"] = to_parquet(simulated.to_arrow())
    if job.extras.annotations:
        for moment, frame in simulated.frames.items():
            state = simulated.state_of(moment)
            notes = annotate(frame, state, scene, catalogue, job.camera)
            classes = semantic_map(frame, state, scene, catalogue, job.camera)
            for name, data in encode_annotations(moment, frame, notes, classes).items():
                files[f"frames/{scene.id}/{name}"] = data
    if job.extras.video:
        action = next(iter(simulated.episode.safe_set), None)
        with temporary_folder() as folder:
            path = Path(folder, "video.mp4")
            record(
                scene,
                simulator,
                path,
                driver=action,
                view=job.extras.video,
                seed=job.seed,
                camera=job.camera,
            )
            files[f"videos/{scene.id}.mp4"] = path.read_bytes()
    return files


def to_jpeg(frame: Frame, quality: int = JPEG_QUALITY) -> bytes:
    """Encode a frame's colours as JPEG."""
    try:
        import cv2
    except ImportError:
        raise MissingExtra("writing frames", "pybullet", "opencv-python-headless") from None
    _, data = cv2.imencode(".jpg", frame.rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    return data.tobytes()


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
    futures = {executor.submit(run_chunk, job, chunk): chunk for chunk in chunks}
    try:
        for future in as_completed(futures):
            try:
                results = future.result()
            except BrokenExecutor:
                lost.append(futures[future])
                continue
            yield from results
    finally:
        for future in futures:
            future.cancel()


def _recover(job: Job, scenes: Iterable[Scene]) -> Iterator[SweepResult]:
    """Retry scenes one at a time after their process died; one that kills its own process fails."""
    with Processes(1) as pool:
        for scene in scenes:
            try:
                yield from pool.submit(run_chunk, job, (scene,)).result()
            except BrokenExecutor as error:
                crash = SimulatorCrash(job.simulator, str(error), retryable=True)
                dead = SweepResult(failed_episode(job, scene, crash))
                yield dead
                if job.twins and not scene.is_twin:
                    yield SweepResult(_twin_of_none(dead.episode))
