"""The texture atlas that all meshes share: a palette of colours, printed faces and facades."""

import tomllib
from enum import IntEnum
from functools import cache
from importlib.resources import files

import numpy as np

from oodscen.data._designs.colours import LIT, rgb_of
from oodscen_pybullet._meshes.textures import paint_regions
from oodscen_pybullet._types import U8, Array, Ints, Mask

SIZE = 1024
"""Width and height of the atlas, in pixels."""
SWATCH = 16
"""Width and height of one colour, in pixels."""

LOOKS = tomllib.loads(files("oodscen_pybullet._meshes").joinpath("looks.toml").read_text("utf-8"))
"""The tables of `looks.toml`."""
COLOURS: dict[str, tuple[int, int, int]] = {k: tuple(v) for k, v in LOOKS["colours"].items()}
"""Red, green and blue of every colour, by name."""
SNOWED: dict[str, tuple[int, int, int]] = {k: tuple(v) for k, v in LOOKS["snowed"].items()}
"""Colours of the land under lying snow, by the colour they replace."""
SNOWED_ROADS: dict[str, tuple[int, int, int]] = {
    k: tuple(v) for k, v in LOOKS["snowed_roads"].items()
}
"""Colours of the roads under lying snow."""
REGIONS: dict[str, tuple[int, int, int, int]] = {k: tuple(v) for k, v in LOOKS["regions"].items()}
"""x, y, width and height of every printed region, in pixels from the top left."""
_NAMES = tuple(COLOURS)
_BEYOND = 2.0
"""First texture coordinate beyond the atlas that stands for a colour."""
_CODES = 2.0**24
"""Number of colours of 24 bits."""

EMISSIVE: frozenset[str] = frozenset(
    {
        "tail_lit", "brake_lit", "head_lit", "red_lit", "green_lit", "brake_core", "amber_core", "screen_lit", "flame", "ember", "amber_lit", "beacon_lit", "beacon_red_lit",
        "arrow_left", "arrow_right", "sign_man", "sign_walker", "sign_taxi", "sign_tram", "lit_window", "lit_window_cool", "lamp_on",
    }
)  # fmt: skip
"""Colours and regions that emit light, so night does not darken them."""


class Snow(IntEnum):
    """The extent of lying snow."""

    NONE = 0
    LAND = 1
    """The roads are cleared; everything beside them is white."""
    ROADS = 2
    """The roads are white too."""


@cache
def swatch_uv(colour: str) -> Array:
    """Return the texture coordinates of a colour's centre: [2], v upwards.

    A colour that the atlas lacks has coordinates beyond it, which `free_colours` reads.
    """
    if colour not in COLOURS and (rgb := rgb_of(colour)) is not None:
        red, green, blue = rgb
        code = (red << 16) + (green << 8) + blue
        place = np.array([_BEYOND + code / _CODES, _BEYOND + colour.startswith(LIT)])
    else:
        index = _NAMES.index(colour)
        column, row = index % (SIZE // SWATCH), index // (SIZE // SWATCH)
        place = np.array([(column + 0.5) * SWATCH / SIZE, 1 - (row + 0.5) * SWATCH / SIZE])
    place.flags.writeable = False
    return place


def free_colours(uvs: Array) -> tuple[Mask, Ints]:
    """Return which coordinates, [n, 2], are colours that the atlas lacks, and red, green, blue, lit: [n, 4]."""
    is_free = uvs[:, 0] > _BEYOND - 0.5
    code = np.rint((uvs[:, 0] - _BEYOND) * _CODES).astype(np.int64)
    lit = np.rint(uvs[:, 1] - _BEYOND).astype(np.int64)
    rows = np.stack([code >> 16, (code >> 8) & 255, code & 255, lit], axis=1)
    return is_free, np.where(is_free[:, None], rows, 0)


def nearest_swatches(uvs: Array) -> Array:
    """Return coordinates with those beyond the atlas replaced by its nearest colours, for plain cameras."""
    is_free, rows = free_colours(uvs)
    if not is_free.any():
        return uvs
    palette = np.array(list(COLOURS.values()))
    away = ((rows[is_free, None, :3] - palette) ** 2).sum(axis=2)
    nearest = np.array([swatch_uv(_NAMES[index]) for index in away.argmin(axis=1)])
    swatches = uvs.copy()
    swatches[is_free] = nearest
    return swatches


def region_uv(name: str) -> Array:
    """Return the corners of a region: [4, 2], counter-clockwise from the bottom left."""
    x, y, width, height = REGIONS[name]
    left, right = (x + 0.5) / SIZE, (x + width - 0.5) / SIZE
    top, bottom = 1 - (y + 0.5) / SIZE, 1 - (y + height - 0.5) / SIZE
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]])


@cache
def draw_atlas(snow: Snow = Snow.NONE) -> U8:
    """Paint the atlas: [SIZE, SIZE, 3] RGB; every call returns the same bytes."""
    image = np.zeros((SIZE, SIZE, 3), np.uint8)
    colours = dict(COLOURS)
    if snow >= Snow.LAND:
        colours.update(SNOWED)
    if snow >= Snow.ROADS:
        colours.update(SNOWED_ROADS)
    for index, name in enumerate(_NAMES):
        top, left = (SWATCH * cell for cell in divmod(index, SIZE // SWATCH))
        image[top : top + SWATCH, left : left + SWATCH] = colours[name]
    paint_regions(image, REGIONS, colours)
    image.flags.writeable = False
    return image
