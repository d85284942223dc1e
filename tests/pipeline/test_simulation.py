"""A simulation outside a study ends the same wherever it is stopped, and takes over nothing."""

import pytest

from oodscen._pipeline.jobs import Job
from oodscen._pipeline.simulation import EPISODES, SETTINGS, Simulation
from oodscen._pipeline.steps.scenes import REAR
from oodscen.errors import FolderTaken
from oodscen.protocols import Camera
from oodscen.study._store import Store
from oodscen.testing import example_scene

JOB = Job("flat", camera=Camera(64, 48))
SCENES = [example_scene().model_copy(update={"id": f"box-00{one}"}) for one in range(3)]


def files(folder):
    """Return the content of all files below a folder."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def simulated(folder, job=JOB, scenes=SCENES):
    """Return the ids of the episodes, in the order in which they were yielded."""
    store = Store(folder)
    with store.writing():
        simulation = Simulation(store, job, scenes, workers=0)
        return [one.id for one in (*simulation.run(), *simulation.run_behind())]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "out"
    assert simulated(folder) == 2 * [scene.id for scene in SCENES]
    return {path.relative_to(folder): data for path, data in files(folder).items()}


def restored(whole, folder):
    """Write the files of the whole simulation into a folder."""
    for path, data in whole.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(data)
    return {folder / path: data for path, data in whole.items()}


@pytest.mark.parametrize("lines", range(len(SCENES)))
def test_what_was_stopped_is_continued(whole, tmp_path, lines):
    wanted = restored(whole, tmp_path)
    text = (tmp_path / EPISODES).read_bytes().splitlines(keepends=True)
    (tmp_path / EPISODES).write_bytes(b"".join(text[:lines]) + text[lines][:40])
    (tmp_path / REAR).unlink()
    (tmp_path / "frames" / "box-000" / "last.jpg").write_bytes(b"torn")
    simulated(tmp_path)
    assert files(tmp_path) == wanted


def test_a_finished_one_is_left_alone_and_a_failed_scene_is_run_again(whole, tmp_path):
    wanted = restored(whole, tmp_path)
    simulated(tmp_path)
    assert files(tmp_path) == wanted
    text = (tmp_path / EPISODES).read_text()
    (tmp_path / EPISODES).write_text(text.replace('"status":"ok"', '"status":"failed"', 1))
    simulated(tmp_path)
    assert files(tmp_path) == wanted


@pytest.mark.parametrize(
    "other",
    [
        {"job": Job("flat", seed=1, camera=JOB.camera)},
        {"job": Job("flat")},
        {"scenes": SCENES[:2]},
        {"scenes": [SCENES[0].model_copy(update={"horizon_s": 7.0}), *SCENES[1:]]},
    ],
)
def test_another_simulation_is_refused(whole, tmp_path, other):
    before = restored(whole, tmp_path)
    with pytest.raises(FolderTaken):
        simulated(tmp_path, **other)
    assert files(tmp_path) == before


@pytest.mark.parametrize("name", [EPISODES, REAR, SETTINGS, "frames/x/last.jpg", "traces/x"])
def test_what_lies_there_is_not_taken_over(tmp_path, name):
    (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / name).write_text("{}")
    with pytest.raises(FolderTaken):
        simulated(tmp_path)
    assert [*files(tmp_path).values()] == [b"{}"]
