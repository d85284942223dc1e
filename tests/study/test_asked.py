"""People, Inspect and data sets get the questions that a run asks."""

import shutil

import pytest

from oodscen import Study
from oodscen.data._pairing import is_ordinary, scene_of
from oodscen.study._asked import asked_drives
from oodscen.study._stale_verdicts import Tables
from tests.pipeline.quick import lines, rewrite


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
