"""Sweeps: processes change no byte, a bad scene or a dead process costs only its own items."""

import os
import subprocess
import sys
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from dataclasses import replace

import cv2
import numpy as np
import pytest

from oodscen import Study, StudyConfig
from oodscen._pipeline import run_study
from oodscen._pipeline.jobs import Job, Outputs
from oodscen._pipeline.sweep import sweep
from oodscen.data._episode import MOMENTS
from oodscen.errors import MissingExtra, RunStopped, StudyError, UsageError
from oodscen.protocols import Camera
from oodscen.stages._pictures.annotations import FrameAnnotations
from oodscen.study._store import Store
from oodscen.testing._scenes import example_scene
from tests.pipeline.quick import SMALL

CAMERA = Camera(width=160, height=120)
JOB = Job("flat", camera=CAMERA)


def scenes(count):
    return [example_scene().model_copy(update={"id": f"s-{number:03d}"}) for number in range(count)]


def by_id(results):
    return {result.episode.id: result for result in results}


@pytest.fixture(scope="module")
def here():
    return by_id(sweep(JOB, scenes(5)))


def test_every_scene_comes_back_with_decodable_frames(here):
    assert set(here) == {scene.id for scene in scenes(5)}
    for name, result in here.items():
        assert result.episode.status == "ok"
        assert tuple(result.frames) == MOMENTS
        picture = cv2.imdecode(np.frombuffer(result.frames["last"], np.uint8), cv2.IMREAD_COLOR)
        assert picture.shape == (CAMERA.height, CAMERA.width, 3)
        assert result.episode.frames["last"] == f"frames/{name}/last.jpg"


def test_processes_and_executors_change_no_byte(here):
    assert by_id(sweep(JOB, scenes(5), workers=2)) == here
    with ThreadPoolExecutor(2) as pool:
        assert by_id(sweep(JOB, scenes(5), executor=pool)) == here


class Failing(Executor):
    """Answers every job with the same thing."""

    def __init__(self, answer):
        self.answer = answer

    def submit(self, function, /, *arguments, **named):
        return self.answer


def future(result=None, error=None):
    made = Future()
    if error is None:
        made.set_result(result)
    else:
        made.set_exception(error)
    return made


@pytest.mark.parametrize(
    "answer",
    [
        *(None, "no future"),
        *(future(), future("garbage"), future([]), future(["garbage"])),
        *(future(error=ValueError("lost worker")), future(error=CancelledError())),
    ],
    ids=range(8),
)
def test_an_executor_that_fails_stops_the_sweep(answer):
    with pytest.raises(RunStopped, match="the executor failed"):
        list(sweep(JOB, scenes(2), executor=Failing(answer)))


def test_results_of_other_scenes_are_not_taken(here):
    with pytest.raises(RunStopped, match="of other scenes: s-000"):
        list(sweep(JOB, scenes(2)[1:], executor=Failing(future([here["s-000"]]))))


def test_an_executor_that_is_shut_down_leaves_the_study_stopped(tmp_path):
    pool = ThreadPoolExecutor(1)
    pool.shutdown()
    with pytest.raises(RunStopped, match="after shutdown"):
        run_study(tmp_path, SMALL, executor=pool)
    assert Study.open(tmp_path).info["status"] == "stopped"


def test_a_function_for_progress_that_raises_leaves_the_study_stopped(tmp_path):
    def progress(*arguments):
        raise ZeroDivisionError("1/0")

    with pytest.raises(ZeroDivisionError):
        run_study(tmp_path, SMALL, progress=progress)
    info = Study.open(tmp_path).info
    assert (info["status"], info["stopped"]) == ("stopped", "ZeroDivisionError: 1/0")


def test_a_picture_to_the_rear_is_taken_at_the_decision_and_nothing_else(here):
    (scene,) = scenes(1)
    (result,) = sweep(replace(JOB, is_rear=True), [scene])
    assert result.episode.frames == {"last": f"frames/{scene.id}/rear.jpg"}
    assert result.episode.trace_sha256 == here[scene.id].episode.trace_sha256
    assert result.episode.actions == {}
    assert result.frames["last"] != here[scene.id].frames["last"]


def test_what_else_is_asked_for_comes_as_files(here, tmp_path):
    job = replace(JOB, outputs=Outputs(traces=True, annotations=True, video="bird"))
    (result,) = sweep(job, scenes(1))
    store = Store(tmp_path)
    store.prepare()
    result.save(store)
    names = set(result.episode.files)
    assert {"traces/s-000.parquet", "videos/s-000.mp4", "frames/s-000/last.json"} <= names
    assert all((tmp_path / name).stat().st_size > 100 for name in names)
    table = Study(tmp_path).trace("s-000").to_pandas()
    available = [k for k, v in result.episode.actions.items() if not v.unavailable]
    assert list(table["phase"].unique()) == ["approach", *available]
    kept = table[(table["phase"] == "stop") & (table["id"] == "box")]
    assert kept["gap_m"].min() == pytest.approx(result.episode.actions["stop"].margin_m, abs=1e-3)
    notes = FrameAnnotations.load(tmp_path / "frames/s-000/last.json")
    assert notes.actors[0].visible_px == result.episode.visible["last"]["box"]
    plain = here["s-000"].episode
    fewer = {"files": (), "file_sha256": plain.file_sha256}
    assert result.episode.model_copy(update=fewer) == plain
    assert result.episode.file_sha256.items() > plain.file_sha256.items()
    with pytest.raises(StudyError):
        Study(tmp_path).trace("s-001")


def test_a_refused_scene_is_a_failed_episode_and_the_rest_goes_on(here):
    bad = example_scene().model_copy(update={"id": "bad", "map": "nowhere"})
    results = by_id(sweep(JOB, [bad, *scenes(2)]))
    assert results["bad"].episode.status == "failed"
    assert "nowhere" in results["bad"].episode.error
    assert results["bad"].episode.error_type == "SceneError"
    assert results["s-001"] == here["s-001"]


def test_a_dead_process_costs_only_the_scene_that_killed_it(tmp_path, monkeypatch, here):
    (tmp_path / "deadly_simulator.py").write_text(
        "import os, signal\n"
        "from oodscen.testing._flat import FlatSimulator\n\n\n"
        "class Deadly(FlatSimulator):\n"
        "    def reset(self, scene, seed):\n"
        "        if scene.id == 's-001':\n"
        "            os._exit(7)\n"
        "        return super().reset(scene, seed)\n\n"
        "    def draw(self, camera):\n"
        "        if self.world.scene.id == 's-002':\n"
        "            os.kill(os.getpid(), signal.SIGKILL)\n"
        "        return super().draw(camera)\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.syspath_prepend(str(tmp_path))
    job = replace(JOB, simulator="deadly_simulator:Deadly")
    results = by_id(sweep(job, scenes(3), workers=1))
    for name in ("s-001", "s-002"):
        assert results[name].episode.status == "failed"
        assert "process died" in results[name].episode.error
        assert results[name].episode.error_type == "SimulatorCrash"
        assert results[name].episode.retryable
    assert results["s-000"].episode == here["s-000"].episode


@pytest.mark.parametrize("change", ["'id', '../../s'", "'horizon_s', 9.5"])
def test_a_simulator_that_changes_its_scene_fails_there_alone(tmp_path, monkeypatch, here, change):
    (tmp_path / "changing_simulator.py").write_text(
        "from oodscen.testing._flat import FlatSimulator\n\n\n"
        "class Changing(FlatSimulator):\n"
        "    name = 'Changing'\n\n"
        "    def reset(self, scene, seed):\n"
        "        state = super().reset(scene, seed)\n"
        "        if scene.id == 's-000':\n"
        f"            object.__setattr__(scene, {change})\n"
        "        return state\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "changing_simulator", raising=False)
    given = scenes(2)
    job = replace(JOB, simulator="changing_simulator:Changing", outputs=Outputs(traces=True))
    results = by_id(sweep(job, given))
    assert given == scenes(2)
    assert results["s-000"].episode.status == "failed"
    assert "Changing changed the scene" in results["s-000"].episode.error
    assert results["s-001"].episode.trace_sha256 == here["s-001"].episode.trace_sha256


def test_a_broken_simulator_is_replaced_and_the_rest_goes_on(tmp_path, monkeypatch, here):
    (tmp_path / "breaking_simulator.py").write_text(
        "from oodscen.testing._flat import FlatSimulator\n\n\n"
        "class Breaking(FlatSimulator):\n"
        "    is_broken = False\n\n"
        "    def step(self, control):\n"
        "        self.is_broken |= self.world.scene.id == 's-001' and self.world.time > 0.5\n"
        "        if self.is_broken:\n"
        "            raise RuntimeError('Not connected to physics server.')\n"
        "        return super().step(control)\n\n"
        "    def close(self):\n"
        "        if self.is_broken:\n"
        "            raise RuntimeError('Not connected to physics server.')\n"
        "        super().close()\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    results = by_id(sweep(replace(JOB, simulator="breaking_simulator:Breaking"), scenes(4)))
    failed = results["s-001"].episode
    assert (failed.status, failed.error_type) == ("failed", "SimulatorCrash")
    assert "physics server" in failed.error
    for name in ("s-000", "s-002", "s-003"):
        assert results[name].episode == here[name].episode


def test_what_is_not_installed_ends_the_sweep(tmp_path, monkeypatch):
    (tmp_path / "lacking_simulator.py").write_text(
        "from oodscen.errors import MissingExtra\n"
        "from oodscen.testing._flat import FlatSimulator\n\n\n"
        "class Lacking(FlatSimulator):\n"
        "    def load(self, corridor, scene, seed):\n"
        "        raise MissingExtra('a simulator', 'lacking', 'nothing')\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(MissingExtra):
        list(sweep(Job(simulator="lacking_simulator:Lacking"), scenes(1)))


UNGUARDED = """
from oodscen._pipeline.jobs import Job
from oodscen._pipeline.sweep import sweep
from oodscen.testing import example_scene

for result in sweep(Job("flat", is_rear=True), [example_scene()], workers=2):
    print(result.episode.status)
"""


def ran(*order, **more):
    """Run a script in which no kernel is worth loading what compiles it."""
    return subprocess.run(
        [sys.executable, *order],
        capture_output=True,
        text=True,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        **more,
    )


def test_scripts_need_no_main_guard(tmp_path):
    (tmp_path / "script.py").write_text(UNGUARDED)
    assert ran(tmp_path / "script.py").stdout == "ok\n"
    assert ran("-", input=UNGUARDED, cwd=tmp_path).stdout == "ok\n"


OWN = """
from oodscen import StudyConfig
from oodscen._pipeline import run_study
from oodscen.testing._flat import FlatSimulator

class Mine(FlatSimulator):
    pass

run_study("out", StudyConfig.quick(simulator="own:Mine", encoder="hash"), workers=2)
"""


def test_a_script_that_is_its_own_simulator_is_refused_before_any_work(tmp_path):
    (tmp_path / "own.py").write_text(OWN)
    done = ran("own.py", cwd=tmp_path)
    assert done.returncode == 1
    assert "UsageError" in done.stderr
    assert "if __name__ == '__main__':" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_simulator_of_the_script_itself_is_refused_before_any_work(tmp_path):
    config = StudyConfig.quick(simulator="__main__:Mine")
    with pytest.raises(UsageError, match="module of its own"):
        run_study(tmp_path / "out", config, workers=2)
    with pytest.raises(UsageError, match="module of its own"):
        next(sweep(Job("__main__:Mine"), scenes(1), workers=1))
    assert not (tmp_path / "out").exists()


def test_scenes_whose_process_died_are_run_again_by_the_same_command(tmp_path, monkeypatch):
    (tmp_path / "fragile_simulator.py").write_text(
        "import os\n"
        "from pathlib import Path\n"
        "from oodscen.testing._flat import FlatSimulator\n\n\n"
        "class Fragile(FlatSimulator):\n"
        "    def step(self, control):\n"
        f"        if Path({str(tmp_path / 'bad')!r}).exists():\n"
        "            os._exit(9)\n"
        "        return super().step(control)\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    config = SMALL.model_copy(update={"simulator": "fragile_simulator:Fragile"})
    (tmp_path / "bad").touch()
    study = run_study(tmp_path / "out", config, workers=1)
    assert study.info["status"] == "incomplete"
    assert all(line["retryable"] for line in study.failures("episodes"))
    (tmp_path / "bad").unlink()
    study = run_study(tmp_path / "out", config)
    assert study.info["status"] == "success"
    assert {verdict.status for verdict in study.verdicts} == {"ok"}
