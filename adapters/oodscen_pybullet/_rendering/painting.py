"""The colours of runs of pixels: texture and light along one drawn triangle.

Functions that run once per pixel or per run are inlined, and unpack their arrays before they loop: numba counts
references whenever an array leaves a tuple, or enters a function, which here would take longer than the shading.
"""

from typing import NamedTuple

import numpy as np

from oodscen.numerics._kernels import inlined
from oodscen_pybullet._rendering import records as rec
from oodscen_pybullet._rendering.records import DrawnTriangles
from oodscen_pybullet._rendering.triangles import BLUE_SHIFT, GREEN_SHIFT, SHELTERED, Textures
from oodscen_pybullet._types import F32, I32, U8

RUN = 32
"""Largest number of pixels shaded together."""

_ZERO, _HALF, _ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
_FULL = np.float32(255.0)
"""Largest value of a byte."""
_FINEST = np.float32(2.0 * 2.0)
"""Texels per pixel, by area, above which the next coarser level is used."""

# Textures are mixed in fixed point, all three colours in one number of 64 bits, whose lanes have 21 bits each.
_PART_BITS, _WEIGHT_BITS = np.uint64(6), np.uint64(12)
"""Bits of a fraction of a texel, and of the product of two."""
_PARTS, _WEIGHTS = np.float32(64.0), np.float32(4096.0)
_WHOLE = np.uint64(4096)
"""The weight 1."""
_ROUNDING = np.uint64(0x800 + (0x800 << GREEN_SHIFT) + (0x800 << BLUE_SHIFT))
"""Half a unit in each lane."""
_LANES = np.uint64(0xFF + (0xFF << GREEN_SHIFT) + (0xFF << BLUE_SHIFT))
"""A byte in each lane."""
_GREEN, _BLUE = np.uint64(GREEN_SHIFT + 12), np.uint64(BLUE_SHIFT + 12)
"""Positions of a lane whose value is multiplied by a weight."""
_BYTE, _LIT_BYTE = np.uint64(255), np.uint64(0x1FF)
"""Largest value of a colour, and of one that light has made too bright."""

# Rows of the work space in which a run of textured pixels is prepared.
_TEXEL, _PART_U, _PART_V, _STRENGTH, _SLANT = range(5)
SCRATCH = 5
"""Their number."""


class Planes(NamedTuple):
    """A picture as the kernel fills it."""

    rgb: U8
    """[3, height, width] colours."""
    depth: F32
    """[height, width] depth at the pixel's centre, m, infinity for the sky."""
    rows: I32
    """[height, width] label, -1 for the sky."""
    reach: F32
    """[height, width] mean distance of the part that is not sky, m."""
    sky: U8
    """[height, width] fraction of sky, 0 to 255."""
    lit: U8
    """[height, width] incidence of the sun on the surface at the centre, 0 to 255."""
    kinds: U8
    """[height, width] that surface's flags."""
    tags: U8
    """[height, width] semantic class: `oodscen_pybullet._meshes.tags.Tag`; 0 for actors."""


class Paints(NamedTuple):
    """All that gives the drawn triangles their colours."""

    drawn: DrawnTriangles
    sheet: Textures
    light: F32
    """Fractions of ambient light and of light from the sun."""
    detail: int
    """Rows of samples from one row of pixels to the next."""
    scratch: I32
    """[SCRATCH, RUN] work space."""


class Colours(NamedTuple):
    """Rows of pixels to be filled."""

    red: U8
    green: U8
    blue: U8
    lit: U8
    """Incidence of the sun on the surface, 0 (grazing) to 255 (perpendicular)."""


class Run(NamedTuple):
    """Adjacent pixels of one record that is textured or unevenly lit."""

    mark: int
    """The record."""
    column: np.float32
    """Column of the first sample, pixels."""
    row: int
    """Row of the samples, counted in samples."""
    length: int
    """Number of pixels, at most `RUN`: few enough for a single texture level."""
    first: int
    """Column of the first pixel among the colours to be filled."""


class Slope(NamedTuple):
    """A value over depth along a run: at its first pixel, and its growth from one pixel to the next."""

    start: np.float32
    step: np.float32


class Shine(NamedTuple):
    """The light on a run of pixels."""

    slant: Slope
    """Cosine between the normal and the light, over depth; 0 on an evenly lit triangle."""
    ambient: np.float32
    diffuse: np.float32


@inlined
def paint(run: Run, paints: Paints, colours: Colours) -> None:
    """Shade a run of pixels."""
    records, labels = paints.drawn.records, paints.drawn.labels
    k = np.uint64(run.mark)
    x, y = run.column - records[k, rec.COLUMN], np.float32(run.row) - records[k, rec.ROW]
    step = records[k, rec.NEARNESS_X]
    near = Slope(records[k, rec.NEARNESS] + step * x + records[k, rec.NEARNESS_Y] * y, step)
    slant, step = _ZERO, _ZERO
    if records[k, rec.IS_UNEVEN] != _ZERO:
        step = records[k, rec.LIGHT_X]
        slant = records[k, rec.LIGHT] + step * x + records[k, rec.LIGHT_Y] * y
    ambient, diffuse = paints.light[0], paints.light[1]
    if labels[k, rec.KIND] & SHELTERED:
        ambient, diffuse = np.float32(rec.TUNNEL_AMBIENT), np.float32(rec.TUNNEL_DIFFUSE)
    shine = Shine(Slope(slant, step), ambient, diffuse)
    if labels[k, rec.TEXTURE] < 0:
        _paint_plain(run, near, shine, records, colours)
    else:
        step_u, step_v = records[k, rec.U_X], records[k, rec.V_X]
        u = Slope(records[k, rec.U] + step_u * x + records[k, rec.U_Y] * y, step_u)
        v = Slope(records[k, rec.V] + step_v * x + records[k, rec.V_Y] * y, step_v)
        line = _find_texels(run, near, shine, u, v, paints)
        _mix_texels(run, line, paints, colours)


@inlined
def _paint_plain(run: Run, near: Slope, shine: Shine, records: F32, colours: Colours) -> None:
    """Shade unevenly lit pixels of one colour."""
    k, first = np.uint64(run.mark), np.uint64(run.first)
    out_r, out_g, out_b, lit = colours.red, colours.green, colours.blue, colours.lit
    slant_0, slant_x = shine.slant
    ambient, diffuse = shine.ambient, shine.diffuse
    red, green, blue = records[k, rec.RED], records[k, rec.GREEN], records[k, rec.BLUE]
    for i in range(np.uint64(run.length)):
        t = np.float32(np.int32(i))
        slant = max((slant_0 + slant_x * t) / (near.start + near.step * t), _ZERO)
        strength = ambient + diffuse * slant
        out_r[first + i] = np.uint8(min(red * strength + _HALF, _FULL))
        out_g[first + i] = np.uint8(min(green * strength + _HALF, _FULL))
        out_b[first + i] = np.uint8(min(blue * strength + _HALF, _FULL))
        lit[first + i] = np.uint8(min(slant * _FULL, _FULL))


@inlined
def _texels_per_pixel(run: Run, near: Slope, u: Slope, v: Slope, paints: Paints) -> np.float32:
    """Return the area of the finest texture that a pixel in the middle of a run covers, texels."""
    records, k = paints.drawn.records, np.uint64(run.mark)
    t = np.float32(run.length - 1) * _HALF
    depth = _ONE / (near.start + near.step * t)
    column, row = (u.start + u.step * t) * depth, (v.start + v.step * t) * depth
    along = max(abs((u.step - column * near.step) * depth), abs((v.step - row * near.step) * depth))
    near_y = records[k, rec.NEARNESS_Y]
    deep = max(
        abs((records[k, rec.U_Y] - column * near_y) * depth),
        abs((records[k, rec.V_Y] - row * near_y) * depth),
    )
    return np.float32(along * deep * np.float32(paints.detail))


@inlined
def _find_texels(
    run: Run, near: Slope, shine: Shine, u: Slope, v: Slope, paints: Paints
) -> np.int32:
    """Write the texels, their weights and the light of a run into the work space.

    Fetching a texel would keep this loop from being vectorised, so `_mix_texels` does that.

    Returns:
        The distance from a texel to the one below it.
    """
    records, labels = paints.drawn.records, paints.drawn.labels
    sizes, scratch = paints.sheet.sizes, paints.scratch
    k = np.uint64(run.mark)
    region, size = np.uint64(labels[k, rec.TEXTURE]), np.uint64(0)
    spread, shrink = _texels_per_pixel(run, near, u, v, paints), _ONE
    for _ in range(sizes.shape[1] - 1):
        if spread <= _FINEST:
            break
        spread *= np.float32(0.25)
        shrink *= _HALF
        size += np.uint64(1)
    start = sizes[region, size, 0]
    wide, tall = sizes[region, size, np.uint64(1)], sizes[region, size, np.uint64(2)]
    most_u, most_v = np.float32(wide - 1), np.float32(tall - 1)
    # Every level has one extra column and row, which repeat the last ones.
    line = np.int32(wide + 1)
    is_uneven = records[k, rec.IS_UNEVEN] != _ZERO
    for i in range(np.uint64(run.length)):
        t = np.float32(np.int32(i))
        depth = _ONE / (near.start + near.step * t)
        column = min(max((u.start + u.step * t) * depth * shrink - _HALF, _ZERO), most_u)
        row = min(max((v.start + v.step * t) * depth * shrink - _HALF, _ZERO), most_v)
        x, y = np.int32(column), np.int32(row)
        scratch[_TEXEL, i] = start + y * line + x
        scratch[_PART_U, i] = np.int32((column - np.float32(x)) * _PARTS)
        scratch[_PART_V, i] = np.int32((row - np.float32(y)) * _PARTS)
        slant = max((shine.slant.start + shine.slant.step * t) * depth, _ZERO)
        strength = shine.ambient + shine.diffuse * slant if is_uneven else records[k, rec.RED]
        scratch[_STRENGTH, i] = np.int32(strength * _WEIGHTS)
        scratch[_SLANT, i] = np.int32(
            min(slant * _FULL, _FULL) if is_uneven else records[k, rec.LIT]
        )
    return line


@inlined
def _mix_texels(run: Run, line: np.int32, paints: Paints, colours: Colours) -> None:
    """Mix the four texels around each pixel of a run, and apply the light."""
    texels, scratch = paints.sheet.texels, paints.scratch
    out_r, out_g, out_b, lit = colours.red, colours.green, colours.blue, colours.lit
    first, one = np.uint64(run.first), np.uint64(1)
    for i in range(np.uint64(run.length)):
        u = np.uint64(np.uint32(scratch[_PART_U, i]))
        v = np.uint64(np.uint32(scratch[_PART_V, i]))
        above = np.uint64(np.uint32(scratch[_TEXEL, i]))
        below = above + np.uint64(np.uint32(line))
        k11 = u * v
        k10, k01 = (v << _PART_BITS) - k11, (u << _PART_BITS) - k11
        k00 = _WHOLE - k01 - k10 - k11
        texel = (
            texels[above] * k00
            + texels[above + one] * k01
            + texels[below] * k10
            + texels[below + one] * k11
        )
        texel = ((texel + _ROUNDING) >> _WEIGHT_BITS) & _LANES
        texel = texel * np.uint64(np.uint32(scratch[_STRENGTH, i])) + _ROUNDING
        out_r[first + i] = np.uint8(min((texel >> _WEIGHT_BITS) & _LIT_BYTE, _BYTE))
        out_g[first + i] = np.uint8(min((texel >> _GREEN) & _LIT_BYTE, _BYTE))
        out_b[first + i] = np.uint8(min((texel >> _BLUE) & _LIT_BYTE, _BYTE))
        lit[first + i] = np.uint8(scratch[_SLANT, i])
