"""The whole run: complete, repeatable, resumable, refusing what does not belong together."""

import json
import shutil
import subprocess
import sys
import threading

import cv2
import numpy as np
import pytest
from click.testing import CliRunner

from oodscen import Study, make_llm
from oodscen._cli import main
from oodscen._cli.summaries import summary
from oodscen._pipeline import estimate, run_study
from oodscen._pipeline.context import Context
from oodscen._pipeline.dropping import drop_models
from oodscen.errors import (
    DataError,
    FolderTaken,
    InUse,
    LLMError,
    StudyError,
    StudyMismatch,
    UnknownComponent,
)
from oodscen.stages._making.making import MadeProp
from oodscen.testing import AnsweringServer, ScriptedLLM
from tests.pipeline.quick import QUICK, SMALL, asked_about, content


def under(name, files, former):
    """Return files in which decisions and edits bear another name of the model that made them."""
    old, new = (f'"model":"{one}"'.encode() for one in (former, name))
    return {path: data.replace(old, new) for path, data in files.items()}


@pytest.fixture(scope="module")
def folder(quick, tmp_path_factory):
    """Return a finished study that only the tests of this file use."""
    return shutil.copytree(quick, tmp_path_factory.mktemp("study") / "out")


@pytest.fixture
def study(folder):
    return Study.open(folder)


def test_a_study_is_complete(folder, study):
    assert study.info["status"] == "success"
    assert study.info["config"] == QUICK.model_dump(mode="json")
    assert "not a language model" in study.info["authors"]["llm"]
    assert len(study.tree("initial")) == QUICK.nodes
    assert [item.round for item in study.rounds] == list(range(1, QUICK.iterations + 1))
    scenarios, scenes, episodes = study.scenarios, study.scenes, study.episodes
    assert [s.id for s in scenarios] == [s.scenario_id for s in scenes]
    ends = ("", "~twin", "~demand")
    assert [e.id for e in episodes] == [f"{s.id}{end}" for s in scenes for end in ends]
    assert len(scenes) == QUICK.max_paths * QUICK.per_path
    assert len(study.texts(10)) == 10
    items = {episode.id for episode in asked_about(study)}
    assert {verdict.scene_id for verdict in study.verdicts} == items
    for episode in episodes:
        for name in episode.frames.values():
            picture = cv2.imdecode(
                np.frombuffer((folder / name).read_bytes(), np.uint8), cv2.IMREAD_COLOR
            )
            assert picture.std() > 4
    assert (folder / "report.html").stat().st_size > 1_000
    assert len(list(study.to_pandas("episodes").id)) == len(episodes)


def test_every_node_of_the_diverse_tree_has_a_decision_with_a_reason(study):
    decisions = {item.id: item for item in study.decisions}
    assert set(decisions) == set(study.tree("diverse").by_id)
    assert all(item.reason for item in decisions.values())
    assert set(study.tree("simulatable").by_id) == {i for i, d in decisions.items() if d.keep}


def test_another_folder_with_other_files_and_more_workers_give_the_same_bytes(folder, tmp_path):
    mine = {".probe": "a", ".study.json.part": "b", "notes.txt": "c"}
    for name, text in mine.items():
        (tmp_path / name).write_text(text)
    run_study(tmp_path, QUICK, workers=2)
    assert {name: (tmp_path / name).read_text() for name in mine} == mine
    found = {name: data for name, data in content(tmp_path).items() if name not in mine}
    assert found == content(folder)


def test_running_again_changes_nothing(folder):
    before = content(folder)
    calls = (folder / "calls.jsonl").read_bytes()
    run_study(folder, QUICK)
    assert content(folder) == before
    assert (folder / "calls.jsonl").read_bytes() == calls


KILLED = """
import json, os, signal, sys
from oodscen import StudyConfig
from oodscen._pipeline import run_study

out, config = sys.argv[1], StudyConfig.model_validate_json(sys.argv[2])
# What is slow to load is loaded once for all processes.
run_study(out + ".first", config)

for stage, number in json.loads(sys.argv[3]):
    def progress(at, done, total):
        if at == stage and done >= number:
            os.kill(os.getpid(), signal.SIGKILL)

    child = os.fork()
    if not child:
        run_study(out, config, progress=progress)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL, stage
    with open(out + "/study.json") as file:
        assert json.load(file)["status"] == "running", stage
"""


def test_killed_at_five_moments_and_continued_it_ends_the_same(small, tmp_path):
    out = tmp_path / "killed"
    moments = [("redteam", 1), ("prune", 3), ("describe sets", 5), ("augment", 1), ("simulate", 1)]
    order = [sys.executable, "-c", KILLED, str(out), SMALL.model_dump_json(), json.dumps(moments)]
    process = subprocess.run(order, capture_output=True, text=True)
    assert process.returncode == 0, process.stderr
    run_study(out, SMALL)
    assert content(out) == content(small)


def test_a_torn_line_is_done_again(folder, tmp_path):
    out = shutil.copytree(folder, tmp_path / "torn")
    for name in ("scenes.jsonl", "episodes.jsonl", "redteam.jsonl", "scenarios.jsonl"):
        path = out / name
        path.write_bytes(path.read_bytes()[:-20])
    (out / "tree.diverse.json").unlink()
    run_study(out, QUICK)
    assert content(out) == content(folder)


def test_a_thing_that_its_model_failed_to_make_is_a_failed_item(folder, tmp_path):
    out = shutil.copytree(folder, tmp_path / "out")
    failed = MadeProp.failed("kite", LLMError("no valid answer"), model="m", prompt="p@1")
    Study.open(out).store.write_lines("assets.jsonl", [failed])
    info = run_study(out, QUICK).info
    assert (info["status"], info["failures"]["assets"]) == ("incomplete", 1)


def test_a_folder_of_another_configuration_is_refused_with_the_difference(folder):
    before = content(folder)
    with pytest.raises(StudyMismatch) as caught:
        run_study(folder, QUICK.model_copy(update={"seed": 4, "per_path": 2}))
    assert caught.value.differences == {"seed": (13, 4), "per_path": (1, 2)}
    assert content(folder) == before


def stats(folder):
    return {path: path.stat().st_mtime_ns for path in [folder, *sorted(folder.rglob("*"))]}


@pytest.mark.parametrize(
    "name", ["scenarios.jsonl", "metrics.json", "report.html", "frames/a.jpg", "tree.diverse.json"]
)
def test_what_is_in_the_way_is_named_and_stays(tmp_path, name):
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("mine")
    (tmp_path / "notes.txt").write_text("mine")
    before = content(tmp_path)
    for begin in (run_study, estimate):
        with pytest.raises(FolderTaken) as caught:
            begin(tmp_path, QUICK)
        assert caught.value.names == (name.partition("/")[0],)
    assert content(tmp_path) == before


WRITING = {
    "run": lambda out: run_study(out, QUICK),
    "drop": lambda out: drop_models(Study.open(out), ["random"]),
    "report": lambda out: Study.open(out).write_report(),
    "run command": lambda out: call("run", out, "--quick"),
    "evaluate": lambda out: call("evaluate", out, "--vlm", "random"),
    "drive": lambda out: call("drive", out),
    "report command": lambda out: call("report", out),
}


def call(*words):
    found = CliRunner().invoke(main, [str(word) for word in words])
    assert found.exit_code == 2
    assert "is being written by process" in found.output
    raise InUse("", "", "", "")


@pytest.mark.parametrize("how", WRITING)
def test_who_comes_second_changes_nothing(folder, how):
    held, done = threading.Event(), threading.Event()

    def hold():
        with Study.open(folder).store.writing():
            held.set()
            done.wait()

    first = threading.Thread(target=hold)
    first.start()
    held.wait()
    before = stats(folder)
    try:
        with pytest.raises(InUse):
            WRITING[how](folder)
        assert stats(folder) == before
        assert Study.open(folder).verdicts
    finally:
        done.set()
        first.join()


@pytest.mark.parametrize("name", ["leaderboard.json", "report.html", "frames"])
def test_what_is_no_file_or_no_folder_stops_a_run_before_it_writes(folder, tmp_path, name):
    out = shutil.copytree(folder, tmp_path / "out")
    path = out / name
    if path.is_dir():
        shutil.rmtree(path)
        path.write_text("")
    else:
        path.unlink()
        path.mkdir()
    before = content(out) | {"study.json": (out / "study.json").read_bytes()}
    for write in (WRITING["run"], lambda out: drop_models(Study.open(out), [])):
        with pytest.raises(DataError, match=rf"(?s){name}:.* is not a "):
            write(out)
    assert content(out) | {"study.json": (out / "study.json").read_bytes()} == before


def test_a_broken_file_stops_a_run_before_it_writes(folder, tmp_path):
    out = shutil.copytree(folder, tmp_path / "out")
    lines = (out / "claims.jsonl").read_text().split("\n")
    (out / "claims.jsonl").write_text("\n".join([lines[0], '{"id":"x"}', *lines[1:]]))
    before = content(out) | {"study.json": (out / "study.json").read_bytes()}
    with pytest.raises(DataError, match=r"claims.jsonl, line 2"):
        run_study(out, QUICK)
    assert content(out) | {"study.json": (out / "study.json").read_bytes()} == before


def test_unknown_components_are_refused_before_anything_is_written(tmp_path):
    for change in ({"simulator": "pybulet"}, {"encoder": "minilmm"}):
        with pytest.raises(UnknownComponent) as caught:
            run_study(tmp_path / "out", QUICK.model_copy(update=change))
        assert caught.value.matches
    assert not (tmp_path / "out").exists()


def test_a_run_keeps_its_folder_when_a_component_changes_the_working_one(tmp_path, monkeypatch):
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    context = Context("out", QUICK)
    monkeypatch.chdir("elsewhere")
    with context.store.writing():
        context.store.write("study.json", "{}")
    assert (tmp_path / "out" / "study.json").is_file()
    assert list((tmp_path / "elsewhere").iterdir()) == []


def test_an_unwritable_folder_is_a_study_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError):
        run_study(tmp_path / "file" / "out", QUICK)


def test_a_band_leaves_only_texts_inside_it(folder, tmp_path, study):
    values = study.metrics["sets"]["simulatable"]["oodness"]["per_text"]
    middle = sorted(values)[len(values) // 2]
    config = QUICK.model_copy(
        update={"band": (middle - 1e-6, 1.0), "demands": False, "catalogues": ()}
    )
    banded = run_study(tmp_path / "band", config)
    kept = [s.id for s, v in zip(study.scenarios, values, strict=True) if v >= middle - 1e-6]
    assert [scene.id for scene in banded.scenes] == kept
    assert 0 < len(kept) < len(values)
    outside = len(values) - len(kept)
    assert f"{outside} texts are not staged: their OOD-ness lies outside" in summary(banded.info)


@pytest.fixture(scope="module")
def author():
    return make_llm("builtin", seed=QUICK.seed)


def served(out, server, config=QUICK, **changes):
    config = config.model_copy(update={"llm": "served", **changes})
    return run_study(out, config, models={"served": server.client(seed=config.seed)})


def test_through_litellm_and_http_the_study_is_the_same(small, tmp_path):
    with AnsweringServer(make_llm("builtin", seed=SMALL.seed)) as server:
        study = served(tmp_path / "served", server, SMALL, twins=True, catalogues=("carla-0.9.16",))
    assert study.info["status"] == "success"
    assert under("builtin", content(tmp_path / "served"), "served") == content(small)
    assert len(server.received) == len(study.table("calls"))


def test_malformed_answers_are_repaired_or_cost_one_item(folder, tmp_path, author):
    def faults(number, request):
        if request is not None and request.prompt.purpose == "stage-scene":
            first = request.prompt.text == first_text
            return (
                "malformed" if first else ("wrong_schema" if len(request.messages) == 2 else None)
            )
        return None

    whole = Study.open(folder)
    first_text = whole.scenarios[0].text
    with AnsweringServer(author, faults=faults) as server:
        study = served(tmp_path / "faulty", server)
    assert study.info["status"] == "incomplete"
    assert study.info["failures"]["scenes"] == 1
    (failure,) = study.failures("scenes")
    assert failure["id"] == whole.scenes[0].id
    assert "stage-scene" in failure["error"]
    assert len(study.scenes) == len(whole.scenes) - 1
    assert len(study.episodes) == 3 * len(study.scenes)


def test_every_scene_that_tells_no_actions_apart_says_what_was_tried(folder, study):
    lines = {line["id"]: line for line in study.store.lines("restaged.jsonl")}
    scenes = {scene.id: scene.model_dump(mode="json") for scene in study.scenes}
    for episode in study.episodes:
        if episode.is_ordinary or episode.status == "failed":
            continue
        line = lines.get(episode.id)
        if episode.restaged:
            assert (line["how"], line["scene"]) == (episode.restaged, scenes[episode.id])
        elif not episode.is_decidable:
            assert line["tried"]
            assert "scene" not in line
        else:
            assert line is None


def test_images_arrive_as_jpeg_and_a_model_is_judged(folder, tmp_path):
    answers = {
        "describe-frame": {"description": "a road"},
        "name-aspect": {"is_ood": True, "aspect": "something odd"},
        "choose-aspect": {"choice": 1},
        "choose-action": {"action": "stop"},
    }
    with AnsweringServer(ScriptedLLM(answers)) as server:
        config = QUICK.model_copy(update={"vlms": ("served",)})
        out = shutil.copytree(folder, tmp_path / "out")
        study = run_study(out, config, models={"served": server.client()})
    pictures = [image for request in server.received for image in request.images]
    assert pictures
    for data in pictures[:6]:
        decoded = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
        assert decoded.shape == (QUICK.height, QUICK.width, 3)
    judged = [verdict for verdict in study.verdicts if verdict.model == "served"]
    labels = {episode.id: episode.label("stop") for episode in asked_about(study)}
    scores = {"safe": True, "marginal": None}
    wanted = {name: scores.get(label, False) for name, label in labels.items()}
    assert {v.scene_id: v.action_is_safe for v in judged} == wanted


def test_a_small_baseline_of_ones_own_is_enough(tmp_path):
    texts = tmp_path / "own.txt"
    texts.write_text("A car waits at a red light.\nA bus stops at its stop.\nEgo follows a van.\n")
    config = SMALL.model_copy(update={"baseline": str(texts), "demands": False, "catalogues": ()})
    study = run_study(tmp_path / "out", config)
    assert study.metrics["baseline"]["N"] == 3
    assert study.metrics["baseline_batch"]["size"] == 1


def test_pruning_explains_every_node_and_ranks_the_way_back(study):
    decisions = study.decisions
    assert [decision.id for decision in decisions] == [
        node.id for node, _ in study.tree("diverse").walk()
    ]
    assert all(decision.reason and decision.match for decision in decisions)
    assert {decision.id for decision in decisions if decision.keep} == set(
        study.tree("simulatable").by_id
    )
    found = study.restoration
    assert found.kept == len(study.tree("simulatable").leaves)
    restored = [leaf for step in found.sequence for leaf in step.paths]
    dropped = {decision.id for decision in decisions if not decision.keep and decision.lacks}
    assert {*restored, *found.beyond} == dropped
