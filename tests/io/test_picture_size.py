"""The size that a picture's header says, without decoding it."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._io.picture_size import picture_size

SIDE = st.integers(1, 300)


@pytest.mark.parametrize("form", [".jpg", ".png"])
@settings(max_examples=30)
@given(width=SIDE, height=SIDE, cut=st.floats(0, 1))
def test_the_header_says_the_size_and_a_part_of_a_file_is_no_error(form, width, height, cut):
    data = cv2.imencode(form, np.zeros((height, width, 3), np.uint8))[1].tobytes()
    assert picture_size(data) == (width, height)
    assert picture_size(data[: int(cut * len(data))]) in (None, (width, height))


@given(st.binary(max_size=60))
def test_other_bytes_have_no_size_or_some(data):
    for begin in (b"", b"\xff\xd8", b"\x89PNG\r\n\x1a\n"):
        found = picture_size(begin + data)
        assert found is None or len(found) == 2
