"""What belongs to a study is known, and nothing else is written in its place."""

import pytest

from oodscen._io.lock import NAME as LOCK
from oodscen._io.study_files import FOLDERS, QUIZ, TABLES, is_own, refuse_inside, refuse_own
from oodscen.errors import FolderTaken
from oodscen.study._files import LINES, VALUES


@pytest.fixture
def study(tmp_path):
    folder = tmp_path / "study"
    (folder / "frames" / "scene").mkdir(parents=True)
    (folder / "study.json").write_text('{"config": {}}')
    (folder / "frames" / "scene" / "last.jpg").write_bytes(b"a picture")
    return folder


@pytest.mark.parametrize("folder", FOLDERS)
def test_every_file_below_a_folder_of_a_study_is_its_own(folder, study):
    for name in (f"{folder}/new.html", f"{folder}/scene/deep/new.html", f"{folder}/{QUIZ}"):
        with pytest.raises(FolderTaken) as caught:
            refuse_own(study / name, but=QUIZ)
        assert caught.value.folder == str(study)


def test_a_file_that_is_there_is_named(study, tmp_path):
    (tmp_path / "link").symlink_to(study / "frames" / "scene")
    for place in (study / "frames" / "scene", tmp_path / "link"):
        with pytest.raises(FolderTaken) as caught:
            refuse_own(place / "last.jpg")
        assert caught.value.names == ("frames/scene/last.jpg",)


def test_the_lock_file_is_the_study_s(study):
    for refuse in (refuse_own, refuse_inside):
        with pytest.raises(FolderTaken, match=LOCK):
            refuse(study / LOCK)


def test_a_study_within_a_study_owns_its_files_too(study):
    inner = study / "frames" / "inner"
    inner.mkdir()
    (inner / "study.json").write_text('{"config": {}}')
    with pytest.raises(FolderTaken):
        refuse_own(inner / "mine.json")
    with pytest.raises(FolderTaken):
        refuse_own(inner / QUIZ, but=QUIZ)


def test_files_of_one_s_own_may_lie_in_a_study_s_folder(study, tmp_path):
    for name in ("mine.json", "mine/frames/last.jpg", "catalogues.json", QUIZ):
        refuse_own(study / name, but=QUIZ)
    refuse_own(tmp_path / "frames" / "last.jpg")
    refuse_inside(study / "mine")
    for name in ("frames/catalogues.json", "mine/../frames/x"):
        with pytest.raises(FolderTaken):
            refuse_own(study / name)


def test_every_file_with_a_type_of_its_own_is_known():
    assert all(map(is_own, (*LINES, *VALUES, *TABLES.values())))
