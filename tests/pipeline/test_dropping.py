"""A judged model leaves no trace but its recorded answers and what they cost."""

import json
import shutil

import pytest
from lxml import html

from oodscen import Study
from oodscen._pipeline import run_study
from oodscen._pipeline.dropping import drop_models
from oodscen.errors import UnknownComponent
from oodscen.judging._constant_answerers import ConstantAnswerer
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._references import ALWAYS
from oodscen.report._leaderboard import study_board
from oodscen.report._load import read
from oodscen.testing import ScriptedLLM
from tests.pipeline.quick import SMALL, asked_about, lines, rewrite

ADDRESS = "http://127.0.0.1:1/v1"


def named(name, answer=None):
    model = ScriptedLLM(answer or (lambda asked: ConstantAnswerer("stop").complete(asked).text))
    model.name = name
    return model


@pytest.fixture(scope="module")
def made(small, tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    for name in ("plain", "judged"):
        shutil.copytree(small, folder / name)
    servers = {"good": ADDRESS, "mute": ADDRESS}
    config = SMALL.model_copy(update={"vlms": ("good", "mute", "random"), "servers": servers})
    models = {"good": named("good"), "mute": named("mute", lambda asked: "")}
    run_study(folder / "judged", config, models=models)
    return folder


@pytest.fixture
def study(made, tmp_path):
    return Study.open(shutil.copytree(made / "judged", tmp_path / "study"))


def test_what_is_dropped_is_gone_from_every_file(study) -> None:
    items = len(asked_about(study))
    assert study.info["status"] == "incomplete"
    assert drop_models(study, ["mute"]) == {"mute": items}
    assert study.config.vlms == ("good", "random")
    assert study.config.servers == {"good": ADDRESS}
    assert {row.model for row in study.verdicts} == {"good", *ALWAYS}
    assert study.info["counts"]["outcomes"] == {"good": {"answered": items}}
    assert study.info["counts"]["verdicts"] == len(study.verdicts)
    assert (study.info["status"], study.info["failures"]["verdicts"]) == ("success", 0)
    board = json.loads((study.folder / "leaderboard.json").read_text())
    assert "mute" not in {row["model"] for row in board["standings"]}
    page = html.document_fromstring((study.folder / "report.html").read_text("utf-8"))
    assert "mute" not in page.get_element_by_id("models").text_content()
    assert "mute" in (study.folder / "answers.jsonl").read_text()


def test_all_dropped_it_is_as_if_nobody_had_been_judged(study, made) -> None:
    drop_models(study, ["good", "mute", "random"])
    for name in ("verdicts.jsonl", "leaderboard.json"):
        assert (study.folder / name).read_bytes() == (made / "plain" / name).read_bytes()
    assert study.config == Study.open(made / "plain").config


def test_references_that_every_study_has_keep_their_verdicts(study) -> None:
    before = {row.model for row in study.verdicts}
    assert drop_models(study, ["random"]) == {"random": 0}
    assert {row.model for row in study.verdicts} == before
    assert study.config.vlms == ("good", "mute")


@pytest.mark.parametrize("name", ["goood", "oracle", "constant:stop"])
def test_who_was_never_judged_is_an_error_and_nothing_changes(study, name) -> None:
    before = {path: path.read_bytes() for path in study.folder.glob("*.json*")}
    with pytest.raises(UnknownComponent):
        drop_models(study, ["good", name])
    assert {path: path.read_bytes() for path in study.folder.glob("*.json*")} == before


def test_a_replay_goes_by_either_name_and_when_its_file_is_gone(made, tmp_path) -> None:
    folder = shutil.copytree(made / "plain", tmp_path / "study")
    recording = shutil.copy(made / "judged" / "answers.jsonl", tmp_path / "a.jsonl")
    name = f"replay:{recording}#good"
    config = SMALL.model_copy(update={"vlms": (name,)})
    study = run_study(folder, config)
    copies = [Study.open(shutil.copytree(folder, tmp_path / f"copy{n}")) for n in range(2)]
    called = "replay:a.jsonl#good"
    assert drop_models(copies[0], [name]) == {name: len(asked_about(study))}
    assert drop_models(copies[1], [called]) == {called: len(asked_about(study))}
    recording.unlink()
    assert drop_models(study, [name]) == {name: len(asked_about(study))}
    for one in (study, *copies):
        assert one.config.vlms == ()
        assert {row.model for row in one.verdicts} == {*ALWAYS}


def test_the_leaderboard_keeps_the_papers_frames_and_leaves_out_what_cannot_be_named(
    small, tmp_path
) -> None:
    folder = shutil.copytree(small, tmp_path / "study")
    rows = lines(folder, "episodes.jsonl")
    below = next(row for row in rows if row["sighting"])
    config = SMALL.model_copy(update={"vlms": ("good", "bad"), "protocols": ("ours", "paper")})
    models = {name: named(name) for name in config.vlms}
    for size_px in (below["sighting"]["size_px"], 1.0):
        below["sighting"]["size_px"] = size_px
        rewrite(folder, "episodes.jsonl", rows)
        study = run_study(folder, config, models=models)
        written = Leaderboard.load(folder / "leaderboard.json")
        assert study.leaderboard() == study_board(read(study)) == written
        copy = Study.open(shutil.copytree(folder, tmp_path / f"dropped at {size_px}"))
        drop_models(copy, ["bad"])
        dropped = Leaderboard.load(copy.folder / "leaderboard.json")
        assert dropped == copy.leaderboard()
        assert (dropped.whole, dropped.scenes) == (written.whole, written.scenes)
    assert written.scenes == 0
