"""The work of a process on one job: scenes are run, re-staged and recorded, each with its ordinary drives."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from oodscen._io.files import temporary_folder
from oodscen._io.jpeg import to_jpeg
from oodscen._members import close, is_interruption, reason
from oodscen._pipeline.jobs import Job, SweepResult
from oodscen._registry import make_simulator
from oodscen._seeding import stream
from oodscen._words.redaction import redact
from oodscen.data._episode import ACTIONS, Episode
from oodscen.data._pairing import demand_id, twin_id
from oodscen.data._scene import Scene
from oodscen.driving._trace_table import to_bytes
from oodscen.errors import MissingExtra, OodscenError, SimulatorCrash
from oodscen.protocols import Frame, Simulator
from oodscen.stages._demands.demanding import draw_demand
from oodscen.stages._pictures.annotations import FrameAnnotations, annotate
from oodscen.stages._pictures.video import record
from oodscen.stages._restaging.decision_retiming import retime
from oodscen.stages._restaging.rerun import Rerunner
from oodscen.stages._restaging.restage import Restaging, restage
from oodscen.stages._simulate import Simulated, simulate

Work = TypeVar("Work")

NOISE = 2
"""Largest change of a colour value by the sensor's noise, of 255."""


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
        return results + failed_drives(job, result.episode)
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


def failed_drives(job: Job, episode: Episode) -> list[SweepResult]:
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
        files[f"traces/{scene.id}.parquet"] = to_bytes(simulated.to_arrow(), ".parquet")
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
