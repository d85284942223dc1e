"""Pictures are told apart by name and content, not by where their bytes happen to lie."""

import pickle
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._messages import Image
from oodscen.errors import UsageError


@pytest.fixture
def files(tmp_path):
    for name, data in (("a", b"same"), ("b", b"same"), ("c", b"other")):
        (tmp_path / name).write_bytes(data)
    return tmp_path


def test_the_place_of_the_bytes_is_not_part_of_the_picture(files):
    first, moved = (Image.from_file(files / name, "frames/x/first.jpg") for name in "ab")
    assert first == moved
    assert hash(first) == hash(moved)
    assert first != Image.from_file(files / "c", "frames/x/first.jpg")
    assert first != Image.from_file(files / "a", "frames/y/first.jpg")
    assert "path" not in first.model_dump()


def test_bytes_are_read_late_and_their_absence_is_said(files):
    image = Image.from_file(files / "a")
    assert image.read() == b"same"
    with pytest.raises(FileNotFoundError, match=r"first\.jpg"):
        Image(name="first.jpg", sha256="0" * 64).read()


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        (b"\xff\xd8\xff...\xff\xd9", ""),
        (b"\x89PNG\r\n\x1a\n...IEND\xaeB`\x82", ""),
        (b"\xff\xd8\xff...", "is cut off before its end"),
        (b"GIF89a", "is neither a JPEG nor a PNG"),
        (b"", "is neither a JPEG nor a PNG"),
    ],
)
def test_a_picture_that_cannot_be_shown_says_why(tmp_path, data, fault):
    (tmp_path / "a").write_bytes(data)
    image = Image.from_file(tmp_path / "a")
    assert image.fault() == (f"a {fault}" if fault else "")
    (tmp_path / "a").unlink()
    assert image.fault() == "a: No such file or directory"


@given(st.binary(max_size=40), st.text(min_size=1, max_size=9))
def test_an_image_of_bytes_is_that_of_a_file_with_them(data, name):
    with pytest.raises(UsageError, match=r"neither a JPEG nor a PNG|cut off before its end"):
        Image.from_bytes(data, name)
    data = b"\xff\xd8\xff" + data + b"\xff\xd9"
    held = Image.from_bytes(data, name)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "picture"
        file.write_bytes(data)
        assert held == Image.from_file(file, name)
    assert pickle.loads(pickle.dumps(held)).read() == held.model_copy().read() == data
    assert held.model_dump().keys() == {"name", "sha256"}
