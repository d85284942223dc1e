"""Episodes that no longer belong to their scenes."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Study
from oodscen._cli import main
from oodscen._pipeline import run_study
from oodscen.data._episode import Episode
from oodscen.data._pairing import demand_id, twin_id
from oodscen.errors import UsageError
from oodscen.report._load import read
from oodscen.study._staging import text_digest
from oodscen.study._stale import refuse_stale, stale_scenes
from tests.interchange.staging import SCENES
from tests.pipeline.quick import SMALL

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


@pytest.mark.parametrize("line", [{}, {"id": None}, {"id": 3}, {"id": []}])
def test_a_staged_line_without_a_name_makes_no_scene_stale(line):
    assert stale_scenes([], [], [{"how": "", **line}]) == []
    assert stale_scenes([], [], [{"how": "", "id": "box"}]) == ["box"]


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
        assert f"removed since it was run: {name}; the same `oodscen run OUT`" in found.output
    assert {path: path.read_bytes() for path in stale.rglob("*") if path.is_file()} == before
    assert not (tmp_path / "data").exists()


def edit(folder: Path, table: str, change: Callable[[list[dict[str, Any]]], object]) -> None:
    """Change the lines of a table as one would by hand."""
    store = Study.open(folder).store
    lines = list(store.lines(table))
    change(lines)
    store.write_lines(table, lines)


def swap(lines: list[dict[str, Any]]) -> None:
    first, second = lines[:2]
    first["text"], second["text"] = second["text"], first["text"]


@pytest.mark.parametrize(
    ("table", "change"),
    [
        ("scenarios.jsonl", lambda lines: lines[0].update(text="A whale lies on the road.")),
        ("scenarios.jsonl", lambda lines: lines[0].update(path=lines[-1]["path"])),
        ("scenarios.jsonl", lambda lines: lines[0].update(leaf=lines[-1]["leaf"])),
        (
            "scenarios.jsonl",
            lambda lines: lines[0].update(path=lines[-1]["path"], leaf=lines[-1]["leaf"]),
        ),
        ("scenarios.jsonl", swap),
        ("scenarios.jsonl", lambda lines: lines.pop(0)),
        ("scenarios.jsonl", lambda lines: lines.clear()),
        ("episodes.jsonl", lambda lines: lines.pop(0)),
        ("claims.jsonl", lambda lines: lines[0]["claims"].pop()),
        ("claims.jsonl", lambda lines: lines[0].update(status="failed", error="no answer")),
    ],
    ids=(
        "text",
        "path",
        "leaf",
        "kind",
        "swapped",
        "one gone",
        "gone",
        "episode",
        "claims",
        "unread",
    ),
)
def test_a_changed_text_is_noticed_as_a_changed_scene_is(quick, tmp_path, table, change):
    folder = shutil.copytree(quick, tmp_path / "out")
    study = Study.open(folder)
    refuse_stale(study, study.episodes, study.scenes)
    name = study.scenes[0].id
    edit(folder, table, change)
    with pytest.raises(
        UsageError, match=r"or [a-z]+ texts?, ha[sv]e? changed or been removed since"
    ) as refused:
        refuse_stale(study, study.episodes, study.scenes)
    assert name in str(refused.value)
    assert name in read(study).gaps["episodes.jsonl"]


def test_a_study_of_another_text_is_refused(quick, tmp_path):
    folder = shutil.copytree(quick, tmp_path / "out")
    edit(folder, "scenarios.jsonl", swap)
    commands = (
        ("publish", folder, "-o", tmp_path / "data", "--to", "none"),
        ("quiz", folder),
        ("audit", folder),
        ("drive", folder),
        ("evaluate", folder, "--require", "safe>=0.1"),
    )
    for words in commands:
        found = CliRunner().invoke(main, [str(word) for word in words])
        assert (found.exit_code, found.output.count("\n")) == (2, 1), words
        assert (
            "2 scenes, or their texts, have changed or been removed since they were run: "
            in found.output
        )
    told = CliRunner().invoke(main, ["report", str(folder)])
    assert "or their texts, have changed or been removed since they were run: " in told.stderr


def test_a_study_of_another_text_is_taken_once_it_is_run_again(small, tmp_path):
    folder = shutil.copytree(small, tmp_path / "out")
    edit(
        folder,
        "scenarios.jsonl",
        lambda lines: lines[0].update(text=lines[0]["text"] + " It is night."),
    )
    study = Study.open(folder)
    with pytest.raises(
        UsageError, match="or its text, has changed or been removed since it was run"
    ):
        refuse_stale(study, study.episodes, study.scenes)
    run_study(folder, SMALL)
    study = Study.open(folder)
    refuse_stale(study, study.episodes, study.scenes)
    told = CliRunner().invoke(main, ["report", str(folder)])
    assert "removed since" not in told.stderr


@pytest.mark.parametrize("table", ["claims.jsonl", "staged.jsonl", "tree.simulatable.json"])
def test_what_a_study_has_no_record_of_is_taken_as_it_is(quick, tmp_path, table):
    folder = shutil.copytree(quick, tmp_path / "out")
    (folder / table).unlink()
    study = Study.open(folder)
    refuse_stale(study, study.episodes, study.scenes)


def test_a_scene_by_hand_of_a_text_that_could_not_be_read_is_not_stale(quick, tmp_path):
    folder = shutil.copytree(quick, tmp_path / "out")
    study = Study.open(folder)
    first = study.scenarios[0]
    edit(folder, "claims.jsonl", lambda lines: lines[0].update(status="failed", error="no answer"))
    edit(
        folder,
        "staged.jsonl",
        lambda lines: lines[0].update(made_from=text_digest(first, None)),
    )
    refuse_stale(study, study.episodes, study.scenes)


def test_an_audit_looks_only_at_recorded_frames(small, tmp_path):
    folder = shutil.copytree(small, tmp_path / "out")
    frame = next(folder.glob("frames/*/last.jpg"))
    data = frame.read_bytes()
    frame.write_bytes(data[:-2] + b"\0" + data[-2:])
    found = CliRunner().invoke(main, ["audit", str(folder)])
    assert found.exit_code == 2
    assert f"{frame.relative_to(folder)} is not the recorded frame" in found.output
    assert not (folder / "audit.json").exists()
