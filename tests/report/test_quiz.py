"""The quiz: one page without a network, an answer or an id, whose file a study takes."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from oodscen import Study
from oodscen._io.study_files import PEOPLE
from oodscen._pipeline.answering import add_answers
from oodscen.errors import DataError, FolderTaken
from oodscen.report._quiz import write_quiz
from tests.report.conftest import build_study


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return build_study(tmp_path_factory.mktemp("quiz") / "study", with_twins=True)


@pytest.fixture(scope="module")
def page(study: Study) -> str:
    return write_quiz(study).read_text(encoding="utf-8")


def payload(page: str) -> dict[str, Any]:
    found = re.search(r'id="payload">(.*?)</script>', page, re.DOTALL)
    assert found
    return json.loads(found[1])


def test_the_page_needs_no_network_and_gives_nothing_away(study: Study, page: str):
    assert not re.search(r"https?://|<link [^>]*stylesheet|@import", page)
    items = payload(page)["items"]
    assert items
    for episode in study.episodes:
        assert episode.scene_id not in page
    for item in items:
        assert set(item) == {"item", "frames", "times", "facts", "questions", "options"}
        assert all(url.startswith("data:image/") for url in item["frames"])
        assert "none" in [name for name, _ in item["options"]]
        assert len(item["questions"]) == 3
        assert not any("JSON" in question for question in item["questions"])


def test_a_scene_comes_with_its_ordinary_drive_and_the_number_is_kept(study: Study, tmp_path: Path):
    first, again = (write_quiz(study, tmp_path / name, scenes=1).read_bytes() for name in "ab")
    assert first == again
    assert len(payload(first.decode())["items"]) == 2


def test_a_named_link_is_followed_and_a_device_stays_one(study: Study, tmp_path: Path):
    (tmp_path / "page").write_text("old")
    for name, other in (("link", "page"), ("null", "/dev/null")):
        (tmp_path / name).symlink_to(other)
        assert write_quiz(study, tmp_path / name, scenes=1) == tmp_path / name
        assert (tmp_path / name).is_symlink()
    assert payload((tmp_path / "page").read_text(encoding="utf-8"))["items"]


def test_a_link_in_the_study_is_replaced_and_not_followed(study: Study, tmp_path: Path):
    (tmp_path / "mine").write_text("mine")
    page = study.folder / "quiz.html"
    page.unlink(missing_ok=True)
    page.symlink_to(tmp_path / "mine")
    assert not write_quiz(study, scenes=1).is_symlink()
    assert (tmp_path / "mine").read_text() == "mine"


@pytest.mark.parametrize("name", ["study.json", "scenes.jsonl", "episodes.jsonl"])
def test_no_file_of_a_study_is_replaced(study: Study, name: str):
    before = (study.folder / name).read_bytes()
    with pytest.raises(FolderTaken):
        write_quiz(study, study.folder / name)
    assert (study.folder / name).read_bytes() == before


@pytest.mark.parametrize("name", ["frames/quiz.html", "frames/scene/first.jpg"])
def test_no_file_below_a_folder_of_a_study_is_written(study: Study, name: str):
    with pytest.raises(FolderTaken):
        write_quiz(study, study.folder / name)
    assert not (study.folder / name).exists()


def test_the_file_that_it_saves_is_taken_once_per_name(study: Study, page: str, tmp_path: Path):
    file = tmp_path / "answers.json"
    for action in ("stop", "keep_speed"):
        answers = [
            {
                "item": one["item"],
                "is_ood": False,
                "confidence": 0.7,
                "choice": one["options"][0][0],
                "action": action,
            }
            for one in payload(page)["items"]
        ]
        file.write_text(json.dumps({"schema_version": 1, "id": "Ada", "answers": answers}))
        assert add_answers(study, [file]) == ("Ada",)
    (kept,) = study.store.lines(PEOPLE)
    assert {one["action"] for one in kept["answers"]} == {"keep_speed"}
    for wrong in ({**answers[0], "item": "x"}, {**answers[0], "choice": "unicorn"}):
        file.write_text(json.dumps({"id": "Bob", "answers": [wrong]}))
        with pytest.raises(DataError, match=r"no drive|'unicorn' is none of the kinds"):
            add_answers(study, [file])
