"""What a terminal is sent is read back as the picture."""

import base64
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._cli.pictures import blocks, graphics_of, iterm, kitty, sixel


@st.composite
def pictures(draw):
    height, width = draw(st.integers(1, 15)), draw(st.integers(1, 20))
    seed, colours = draw(st.integers(0, 99)), draw(st.integers(1, 12))
    some = np.random.default_rng(seed)
    palette = some.integers(0, 256, (colours, 3)).astype(np.uint8)
    return palette[some.integers(0, colours, (height, width))]


def drawn(text):
    """Return the pixels that sixels draw, as a terminal would."""
    head = re.match(r'\x1bPq"1;1;(\d+);(\d+)', text)
    width, height = map(int, head.groups())
    palette, found = {}, np.full((height + 6, width, 3), -1)
    row = column = 0
    for part in re.finditer(
        r"#(\d+);2;(\d+);(\d+);(\d+)|#(\d+)|!(\d+)(.)|([?-~])|([$-])", text[head.end() : -2]
    ):
        if part[1]:
            palette[int(part[1])] = [round(int(one) * 2.55) for one in part.group(2, 3, 4)]
        elif part[5]:
            colour = palette[int(part[5])]
        elif part[9]:
            column, row = 0, row + 6 * (part[9] == "-")
        else:
            length = int(part[6] or 1)
            for bit in range(6):
                if (ord(part[7] or part[8]) - 63) >> bit & 1:
                    found[row + bit, column : column + length] = colour
            column += length
    assert (found[height:] == -1).all()
    return found[:height]


@settings(max_examples=50)
@given(pictures())
def test_sixels_draw_every_pixel_in_the_nearest_of_216_colours(pixels):
    shown = drawn(sixel(pixels))
    assert np.abs(shown - pixels).max() <= 26


@given(pictures(), st.integers(1, 30))
def test_half_blocks_keep_the_mean_colours(pixels, columns):
    lines = blocks(pixels, columns).split("\n")
    assert all(line.count("▀") == columns and line.endswith("\x1b[0m") for line in lines)
    colours = np.array(
        [
            [int(one) for one in found]
            for found in re.findall(r"8;2;(\d+);(\d+);(\d+)m", "".join(lines))
        ]
    )
    assert (colours.min(axis=0) >= pixels.min(axis=(0, 1))).all()
    assert (colours.max(axis=0) <= pixels.max(axis=(0, 1))).all()


def test_half_blocks_of_as_many_pixels_are_the_pixels():
    pixels = np.arange(4 * 3 * 3, dtype=np.uint8).reshape(4, 3, 3)
    found = re.findall(r"8;2;(\d+);(\d+);(\d+)m", blocks(pixels, 3))
    above, below = np.array(found, int).reshape(2, 3, 2, 3).transpose(2, 0, 1, 3)
    assert (above == pixels[::2]).all()
    assert (below == pixels[1::2]).all()


@given(st.binary(min_size=1, max_size=20_000))
def test_files_are_sent_whole(data):
    parts = re.findall(r"\x1b_G[^;]*m=(\d);([^\x1b]*)\x1b\\", kitty(data, 40))
    assert base64.b64decode("".join(part for _, part in parts)) == data
    assert [more for more, _ in parts] == ["1"] * (len(parts) - 1) + ["0"]
    assert all(len(part) <= 4_096 for _, part in parts)
    assert base64.b64decode(iterm(data, 40).partition(":")[2].removesuffix("\x07")) == data


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({}, "none"),
        ({"TERM": "dumb"}, "none"),
        ({"TERM": "xterm-256color"}, "blocks"),
        ({"TERM": "xterm-kitty"}, "kitty"),
        ({"TERM": "xterm-256color", "TERM_PROGRAM": "WezTerm"}, "iterm"),
        ({"TERM": "foot"}, "sixel"),
        ({"TERM": "screen-256color", "KITTY_WINDOW_ID": "1"}, "blocks"),
        ({"TERM": "xterm-kitty", "TMUX": "x"}, "blocks"),
    ],
)
def test_a_terminal_is_known_by_its_variables(environment, expected):
    assert graphics_of(environment) == expected
