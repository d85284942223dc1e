from pathlib import Path

import pytest

from oodscen.report._charts.frames import picture


def test_a_frame_is_addressed_relative_to_the_page(tmp_path: Path) -> None:
    (tmp_path / "frames").mkdir()
    (tmp_path / "frames/a b~twin.jpg").write_bytes(b"x")
    assert picture(tmp_path, "frames/a b~twin.jpg").href == "frames/a%20b~twin.jpg"


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        (None, "no frame"),
        ("frames/gone.jpg", "frame file is missing"),
        ("/etc/passwd.jpg", "not a picture of this study"),
        ("../x.jpg", "not a picture of this study"),
        ("https://example.org/x.jpg", "not a picture of this study"),
        ("javascript:alert(1)//x.jpg", "not a picture of this study"),
        ("frames/x.html", "not a picture of this study"),
    ],
)
def test_what_is_no_frame_of_the_study_has_no_address(
    tmp_path: Path, name: str | None, problem: str
) -> None:
    found = picture(tmp_path, name)
    assert (found.href, found.problem) == ("", problem)
