"""Frames are shown only if they are those that were recorded."""

import hashlib
import os

import cv2
import numpy as np
import pytest

from oodscen.errors import DataError
from oodscen.protocols import Camera
from oodscen.study._frames import frames_of
from oodscen.study._store import Store

CAMERA = Camera(width=64, height=48)
FILE = "frames/a/last.jpg"


def picture(width=64, height=48, shade=0):
    return cv2.imencode(".jpg", np.full((height, width, 3), shade, np.uint8))[1].tobytes()


def lying(data):
    """Return a picture whose header says 60000 x 60000 pixels."""
    size = (48).to_bytes(2, "big") + (64).to_bytes(2, "big")
    at = data.index(size)
    return data[:at] + (60_000).to_bytes(2, "big") * 2 + data[at + 4 :]


def is_refused(store, recorded):
    with pytest.raises(DataError) as found:
        frames_of(store, {"last": FILE}, recorded, CAMERA)
    (issue,) = found.value.issues
    assert FILE in issue.message
    return issue.message


@pytest.mark.parametrize("is_recorded", [True, False])
def test_the_recorded_frame_is_shown(tmp_path, is_recorded):
    store = Store(tmp_path)
    store.write(FILE, picture())
    sha256 = hashlib.sha256(picture()).hexdigest()
    found = frames_of(store, {"last": FILE}, {FILE: sha256} if is_recorded else {}, CAMERA)
    assert {one: image.sha256 for one, image in found.items()} == {"last": sha256}


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        (picture(shade=200), "is not the recorded frame"),
        (lying(picture()), "60000 x 60000 pixels"),
        (picture(1, 1), "1 x 1 pixels, not the 64 x 48 of the camera"),
        (picture()[:-40], "cut off"),
        (b"<script>", "neither a JPEG nor a PNG"),
        (b"", "neither a JPEG nor a PNG"),
    ],
)
def test_another_picture_is_refused_by_name_and_reason(tmp_path, data, fault):
    store = Store(tmp_path)
    store.write(FILE, data)
    if fault != "is not the recorded frame":
        assert fault in is_refused(store, {})
    recorded = {FILE: hashlib.sha256(picture()).hexdigest()}
    assert "is not the recorded frame" in is_refused(store, recorded)


@pytest.mark.parametrize("make", [None, os.mkfifo, os.mkdir])
def test_what_is_no_file_cannot_be_read(tmp_path, make):
    store = Store(tmp_path)
    (tmp_path / FILE).parent.mkdir(parents=True)
    if make is not None:
        make(tmp_path / FILE)
    assert "cannot be read" in is_refused(store, {})
