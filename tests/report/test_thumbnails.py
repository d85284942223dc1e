import base64
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.report.thumbnails import CEILING, FLOOR, Thumbnails, is_inside


def write(folder: Path, width: int, height: int) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (height, width, 3)).astype(np.uint8)
    picture = cv2.GaussianBlur(noise, (0, 0), 4)
    (folder / "x.jpg").write_bytes(cv2.imencode(".jpg", picture)[1].tobytes())


@pytest.mark.parametrize(("count", "limit"), [(3, CEILING), (10**6, FLOOR)])
def test_thumbnails_keep_to_their_share_of_the_page(tmp_path: Path, count: int, limit: int) -> None:
    write(tmp_path, 640, 480)
    made = Thumbnails(tmp_path, count).make("first", "x.jpg")
    encoded = made.source.removeprefix("data:image/jpeg;base64,")
    assert len(encoded) <= limit
    decoded = cv2.imdecode(np.frombuffer(base64.b64decode(encoded), np.uint8), cv2.IMREAD_COLOR)
    assert decoded is not None
    assert decoded.shape[:2] == (made.height, made.width)
    assert made.width / made.height == pytest.approx(4 / 3, abs=0.02)
    assert made.width <= 256


def test_small_frames_are_not_blown_up(tmp_path: Path) -> None:
    write(tmp_path, 64, 48)
    made = Thumbnails(tmp_path, 1).make("last", "x.jpg")
    assert (made.width, made.height) == (64, 48)


def test_names_with_spaces_are_quoted(tmp_path: Path) -> None:
    write(tmp_path, 64, 48)
    (tmp_path / "x.jpg").rename(tmp_path / "a b.jpg")
    assert Thumbnails(tmp_path, 1).make("last", "a b.jpg").href == "a%20b.jpg"


@pytest.mark.parametrize(
    "name",
    [
        "/etc/x.jpg",
        "../x.jpg",
        "a/../../x.jpg",
        "javascript:x.jpg",
        "//host/x.jpg",
        "a\\x.jpg",
        "x.svg",
        "x.html",
        "x.jpg?y",
        "",
    ],
)
def test_what_is_outside_or_no_picture_is_refused(name: str, tmp_path: Path) -> None:
    assert not is_inside(name)
    made = Thumbnails(tmp_path, 1).make("last", name)
    assert made.problem
    assert not made.href
    assert not made.source


@given(st.text())
def test_what_is_let_through_stays_inside(name: str) -> None:
    if is_inside(name):
        base = Path("/study")
        assert (base / name).is_relative_to(base)
        assert ".." not in Path(name).parts
