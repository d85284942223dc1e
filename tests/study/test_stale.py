"""Episodes that no longer belong to their scenes."""

import json
import shutil

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Study
from oodscen._cli import main
from oodscen.data._episode import Episode
from oodscen.data._pairing import demand_id, twin_id
from oodscen.study._stale import refuse_stale, stale_scenes
from tests.interchange.staging import SCENES

CHANGES = st.lists(st.sampled_from(["", "scene", "demand", "gone", "unknown"]), max_size=6)


@settings(max_examples=40)
@given(CHANGES)
def test_the_scenes_that_changed_are_stale_and_no_others(changes):
    scenes, staged, episodes = [], [], []
    for scene, change in zip(SCENES, changes, strict=False):
        demand = scene.model_copy(update={"id": demand_id(scene.id)})
        staged.append({"id": scene.id, "demand": demand.model_dump(mode="json")})
        made_from = "" if change == "unknown" else scene.digest()
        episodes += [
            Episode(id=name, scene_id=name, status="ok", made_from=made_from)
            for name in (scene.id, twin_id(scene.id), demand.id)
        ]
        other = {"horizon_s": scene.horizon_s + 1}
        if change != "gone":
            scenes.append(scene.model_copy(update=other if change in ("scene", "unknown") else {}))
        scenes.append(demand.model_copy(update=other if change == "demand" else {}))
    wanted = [
        scene.id
        for scene, change in zip(SCENES, changes, strict=False)
        if change in ("scene", "demand", "gone")
    ]
    assert stale_scenes(episodes, scenes, staged) == wanted


@pytest.fixture
def stale(small, tmp_path):
    """Return a study whose scene was changed by hand."""
    folder = shutil.copytree(small, tmp_path / "out")
    study = Study.open(folder)
    refuse_stale(study, study.episodes, study.scenes)
    first, *others = study.store.lines("scenes.jsonl")
    first["ego"]["speed"] += 1.0
    study.store.write_lines("scenes.jsonl", [first, *others])
    return folder


def test_a_study_of_other_scenes_is_refused_in_one_line(stale, tmp_path):
    before = {path: path.read_bytes() for path in stale.rglob("*") if path.is_file()}
    name = json.loads((stale / "scenes.jsonl").read_text().splitlines()[0])["id"]
    for words in (
        ("publish", stale, "-o", tmp_path / "data"),
        ("quiz", stale),
        ("audit", stale),
        ("drive", stale),
        ("evaluate", stale, "--require", "safe>=0.1"),
    ):
        found = CliRunner().invoke(main, [str(word) for word in words])
        assert (found.exit_code, found.output.count("\n")) == (2, 1), words
        assert f"changed since it was run: {name}; the same `oodscen run OUT`" in found.output
    assert {path: path.read_bytes() for path in stale.rglob("*") if path.is_file()} == before
    assert not (tmp_path / "data").exists()


def test_an_audit_looks_only_at_recorded_frames(small, tmp_path):
    folder = shutil.copytree(small, tmp_path / "out")
    frame = next(folder.glob("frames/*/last.jpg"))
    data = frame.read_bytes()
    frame.write_bytes(data[:-2] + b"\0" + data[-2:])
    found = CliRunner().invoke(main, ["audit", str(folder)])
    assert found.exit_code == 2
    assert f"{frame.relative_to(folder)} is not the recorded frame" in found.output
    assert not (folder / "audit.json").exists()
