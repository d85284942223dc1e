"""People, Inspect and data sets get the questions that a run asks."""

import json
import shutil

import pytest
from click.testing import CliRunner

from oodscen import Study
from oodscen._cli import main
from oodscen._pipeline import RunOptions
from oodscen._pipeline.answering import take_rear_views
from oodscen.data._pairing import is_ordinary, scene_of
from oodscen.errors import DataError
from oodscen.judging._questions import naming_prompt
from oodscen.study._asked import asked_drives
from oodscen.study._stale_verdicts import Tables
from tests.pipeline.quick import lines, rewrite

parquet = pytest.importorskip("pyarrow.parquet")


@pytest.mark.parametrize("one_of", [min, max])
def test_scenes_that_are_not_judged_change_the_options_alike_everywhere(quick, tmp_path, one_of):
    out = shutil.copytree(quick, tmp_path / "out")
    leaves = {scenario.id: scenario.leaf for scenario in Study.open(out).scenarios}
    left_out = one_of(leaves.values())
    rows = lines(out, "episodes.jsonl")
    for row in rows:
        if row["sighting"] and leaves[scene_of(row["scene_id"])] == left_out:
            row["sighting"]["size_px"] = 3.0
    rewrite(out, "episodes.jsonl", rows)
    study = Study.open(out)
    drives, keys = asked_drives(study), Tables.of(study).rule([]).keys
    assert any(is_ordinary(drive.episode.scene_id) for drive in drives)
    assert [drive.key for drive in drives] == [keys.of(drive.episode, "ours") for drive in drives]


@pytest.fixture
def behind(quick, tmp_path):
    """A copy of a study whose questions show the view to the rear, which its first two drives have."""
    out = shutil.copytree(quick, tmp_path / "behind")
    record = json.loads((out / "study.json").read_text())
    record["config"]["rear_view"] = True
    (out / "study.json").write_text(json.dumps(record))
    (out / "verdicts.jsonl").unlink()  # Its answers are to questions without that view.
    study = Study.open(out)
    take_rear_views(study, [drive.episode for drive in asked_drives(study)[:2]], RunOptions())
    return Study.open(out)


def test_the_view_to_the_rear_is_asked_about_everywhere_if_the_study_shows_it(behind, tmp_path):
    first, second, third, *_ = asked_drives(behind)
    for drive in (first, second):
        prompt = naming_prompt(drive.shown)
        assert [image.name.rpartition("/")[2] for image in prompt.images()][-1] == "rear.jpg"
        assert "rear window" in prompt.question()
    with pytest.raises(DataError, match="no view to the rear; the same `oodscen run OUT` takes it"):
        _ = third.shown
    with pytest.raises(DataError, match="no view to the rear"):
        behind.publish(tmp_path / "data")
    take_rear_views(behind, behind.episodes, RunOptions())
    data = Study.open(behind.folder).publish(tmp_path / "data", validation=0.0).folder
    table = parquet.read_table(data / "data" / "questions" / "test.parquet").to_pylist()
    assert {len(row["images"]) for row in table} == {4}
    assert all("rear window" in row["question"] for row in table)
    scenes = json.loads((data / "drivelm" / "test.json").read_text())
    for scene in scenes.values():
        *early, last = scene["key_frames"].values()
        assert [set(frame["image_paths"]) for frame in early] == [{"CAM_FRONT"}] * 2
        assert (data / "drivelm" / last["image_paths"]["CAM_BACK"]).is_file()
        assert all(
            "rear window" in question["Q"] and "last frame" in question["Q"]
            for part in last["QA"].values()
            for question in part
        )


def test_a_quiz_shows_the_view_to_the_rear_if_the_study_does(behind):
    shown = {}
    for words in ((), ("--no-rear-view",)):
        found = CliRunner().invoke(main, ["quiz", str(behind.folder), *words])
        assert found.exit_code == 0, found.output
        page = (behind.folder / "quiz.html").read_text()
        shown[words] = page.count('"rear":"data:image/jpeg')
    assert shown == {(): len(asked_drives(behind)), ("--no-rear-view",): 0}
