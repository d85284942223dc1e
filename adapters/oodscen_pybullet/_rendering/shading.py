"""The numba kernels that colour the pixels from the surfaces that `depth_kernel` found in front.

Each pixel is shaded once, at its centre, with a texture of matching resolution; where its corners
show another surface, the colours are mixed.

Functions that run once per pixel or per run are inlined, and unpack their arrays before they loop: numba counts
references whenever an array leaves a tuple, or enters a function, which here would take longer than the shading.
"""

from typing import NamedTuple

import numpy as np

from oodscen.numerics._kernels import Kernel, inlined, part
from oodscen_pybullet._meshes.tags import Tag
from oodscen_pybullet._rendering import records as rec
from oodscen_pybullet._rendering.depth_kernel import Samples
from oodscen_pybullet._rendering.records import DrawnTriangles
from oodscen_pybullet._rendering.triangles import BLUE_SHIFT, GREEN_SHIFT, SHELTERED, Textures
from oodscen_pybullet._types import F32, I32, U8

_SKY = int(Tag.SKY)
_ZERO, _HALF, _ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
_FULL = np.float32(255.0)
"""Largest value of a byte."""
_RUN = 32
"""Largest number of pixels shaded together."""
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
_SCRATCH = 5

# A centre counts as much as the four corners together.
_CENTRE, _CORNER = np.float32(4.0), np.float32(1.0)
_ALL_TAPS = np.float32(8.0)


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
    """[_SCRATCH, _RUN] work space."""


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
    """Number of pixels, at most `_RUN`: few enough for a single texture level."""
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
def _paint(run: Run, paints: Paints, colours: Colours) -> None:
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


@inlined
def _differs(mark: int, other: int, labels: I32) -> bool:
    """Return whether two samples show different surfaces."""
    if mark == other:
        return False
    if mark < 0 or other < 0:
        return True
    return bool(labels[np.uint64(mark), rec.SURFACE] != labels[np.uint64(other), rec.SURFACE])


class Edges(NamedTuple):
    """The pixels whose corners show other surfaces."""

    spots: I32
    """[n, 2] row and column."""
    mixed: U8
    """[n, 3] smoothed colours."""


class Tap(NamedTuple):
    """A sample of a pixel: its centre, or one of its corners."""

    y: int
    x: int
    """The pixel."""
    down: int
    """Half pixels from the centre: -1, 0 or 1."""
    right: int


@inlined
def _shown_by(surface: int, tap: Tap, shown: I32, labels: I32) -> tuple[int, int]:
    """Return row and column of a pixel beside a sample whose centre shows its surface; a negative row if none does."""
    last, wide = shown.shape[0] // 2 - 1, shown.shape[1]
    row, column = -1, 0
    for step in range(4):
        # The pixel's own centre, and those of the others that share the corner, are equally near.
        y = min(max(tap.y + tap.down, 0), last) if step & 2 else tap.y
        x = min(max(tap.x + tap.right, 0), wide - 1) if step & 1 else tap.x
        other = shown[np.uint64(2 * y), np.uint64(x)]
        if row < 0 and other >= 0 and labels[np.uint64(other), rec.SURFACE] == surface:
            row, column = y, x
    return row, column


@part
def _smooth(
    edges: Edges, begin: int, end: int, samples: Samples, paints: Paints, planes: Planes
) -> None:
    """Mix the centre of each pixel, weighted one half, with its corners.

    A surface that a neighbour shows at its centre takes that neighbour's colour; only surfaces too thin
    for that are shaded again.
    """
    spots, mixed = edges.spots, edges.mixed
    records, labels = paints.drawn.records, paints.drawn.labels
    nearness, shown = samples.nearness, samples.shown
    rgb, reach, sky = planes.rgb, planes.reach, planes.sky
    single = np.empty((4, 1), np.uint8)
    painted = Colours(single[0], single[1], single[2], single[3])
    for n in range(np.uint64(begin), np.uint64(end)):
        y, x = int(spots[n, 0]), int(spots[n, 1])
        red = green = blue = weight = total = _ZERO
        tap_r = tap_g = tap_b = _ZERO
        surface = -1
        for corner in range(-1, 4):
            # The centre, then the corners from the upper left.
            part, right, down = _CENTRE, 0, 0
            if corner >= 0:
                part, right, down = _CORNER, 2 * (corner & 1) - 1, 2 * (corner >> 1) - 1
            r = np.uint64(max(2 * y + down, 0))
            c = np.uint64(max(x - 1, 0) if right < 0 else x)
            mark = shown[r, c]
            if mark < 0:
                continue
            k = np.uint64(mark)
            if labels[k, rec.SURFACE] != surface:
                surface = labels[k, rec.SURFACE]
                b, a = _shown_by(surface, Tap(y, x, down, right), shown, labels)
                if labels[k, rec.TEXTURE] < 0 and records[k, rec.IS_UNEVEN] == _ZERO:
                    tap_r, tap_g, tap_b = (
                        records[k, rec.RED],
                        records[k, rec.GREEN],
                        records[k, rec.BLUE],
                    )
                elif b >= 0:
                    i, j = np.uint64(b), np.uint64(a)
                    tap_r, tap_g, tap_b = (
                        np.float32(rgb[0, i, j]),
                        np.float32(rgb[1, i, j]),
                        np.float32(rgb[2, i, j]),
                    )
                else:
                    column = np.float32(x) + _HALF * np.float32(right)
                    _paint(Run(mark, column, 2 * y + down, 1, 0), paints, painted)
                    tap_r, tap_g, tap_b = (
                        np.float32(single[0, 0]),
                        np.float32(single[1, 0]),
                        np.float32(single[2, 0]),
                    )
            red += part * tap_r
            green += part * tap_g
            blue += part * tap_b
            total += part * nearness[r, c]
            weight += part
        scale = _ONE / weight
        reach[np.uint64(y), np.uint64(x)] = weight / total
        mixed[n, 0] = np.uint8(min(red * scale + _HALF, _FULL))
        mixed[n, 1] = np.uint8(min(green * scale + _HALF, _FULL))
        mixed[n, 2] = np.uint8(min(blue * scale + _HALF, _FULL))
        sky[np.uint64(y), np.uint64(x)] = np.uint8(
            (_ALL_TAPS - weight) * np.float32(255.0 / 8.0) + _HALF
        )


@part
def _settle(edges: Edges, begin: int, end: int, rgb: U8) -> None:
    """Write the smoothed colours of some pixels."""
    spots, mixed = edges.spots, edges.mixed
    for n in range(np.uint64(begin), np.uint64(end)):
        for e in range(3):
            rgb[e, np.uint64(spots[n, 0]), np.uint64(spots[n, 1])] = mixed[n, e]


@part
def _measure(samples: Samples, labels: I32, planes: Planes, y: int, row: int) -> None:
    """Write depth, reach, labels and classes of a row of pixels, from its row of samples."""
    depth, reach, rows, tags = planes.depth, planes.reach, planes.rows, planes.tags
    marks, near = samples.shown[row], samples.nearness[row]
    line = np.uint64(y)
    for x in range(np.uint64(depth.shape[1])):
        mark = marks[x]
        far = _ONE / near[x]
        depth[line, x] = np.float32(np.inf) if mark < 0 else far
        reach[line, x] = depth[line, x]
        at = np.uint64(mark if mark >= 0 else 0)
        rows[line, x] = -1 if mark < 0 else labels[at, rec.BODY]
        tags[line, x] = np.uint8(_SKY if mark < 0 else labels[at, rec.CLASS])


@part
def _find_edges(shown: I32, labels: I32, y: int, changes: I32, spots: I32, count: int) -> int:
    """Append the pixels of a row whose corners show other surfaces; return their number so far."""
    row, one = 2 * y, np.uint64(1)
    wide = np.uint64(shown.shape[1])
    middle, over, under = shown[row], shown[max(row - 1, 0)], shown[row + 1]
    # Few pixels have a corner of another record: these two loops, which vectorise, find them.
    for i in range(wide):
        changes[i] = (over[i] ^ middle[i]) | (under[i] ^ middle[i])
    for i in range(wide - one):
        changes[i + one] |= (over[i] ^ middle[i + one]) | (under[i] ^ middle[i + one])
    for i in range(wide):
        if changes[i]:
            mark = middle[i]
            left = i - one if i > 0 else i
            if (
                _differs(mark, over[i], labels)
                or _differs(mark, under[i], labels)
                or _differs(mark, over[left], labels)
                or _differs(mark, under[left], labels)
            ):
                spots[np.uint64(count), 0], spots[np.uint64(count), 1] = y, i
                count += 1
    return count


@part
def _shade(marks: I32, paints: Paints, planes: Planes, line: int) -> None:
    """Colour the centres of a row of pixels, one run of equal records after another."""
    records, labels = paints.drawn.records, paints.drawn.labels
    rgb, sky, lit, kinds = planes.rgb, planes.sky, planes.lit, planes.kinds
    width, y, row = marks.shape[0], np.uint64(line), line * paints.detail
    colours = Colours(rgb[0, y], rgb[1, y], rgb[2, y], lit[y])
    x = 0
    while x < width:
        mark = marks[np.uint64(x)]
        stop, limit = x + 1, min(x + _RUN, width)
        while stop < limit and marks[np.uint64(stop)] == mark:
            stop += 1
        k, is_sky = np.uint64(max(mark, 0)), mark < 0
        kind = np.uint8(0 if is_sky else labels[k, rec.KIND])
        for i in range(np.uint64(x), np.uint64(stop)):
            sky[y, i] = 255 if is_sky else 0
            kinds[y, i] = kind
        if is_sky:
            for i in range(np.uint64(x), np.uint64(stop)):
                rgb[0, y, i] = rgb[1, y, i] = rgb[2, y, i] = lit[y, i] = 0
        elif labels[k, rec.TEXTURE] < 0 and records[k, rec.IS_UNEVEN] == _ZERO:
            red = np.uint8(min(records[k, rec.RED] + _HALF, _FULL))
            green = np.uint8(min(records[k, rec.GREEN] + _HALF, _FULL))
            blue = np.uint8(min(records[k, rec.BLUE] + _HALF, _FULL))
            slant = np.uint8(records[k, rec.LIT])
            for i in range(np.uint64(x), np.uint64(stop)):
                rgb[0, y, i], rgb[1, y, i], rgb[2, y, i] = red, green, blue
                lit[y, i] = slant
        else:
            _paint(Run(mark, np.float32(x), row, stop - x, x), paints, colours)
        x = stop


@Kernel
def gather(
    samples: Samples,
    drawn: DrawnTriangles,
    sheet: Textures,
    light: F32,
    detail: int,
    planes: Planes,
) -> None:
    """Shade every pixel.

    Args:
        samples: As in `scatter`, [height * detail, width].
        drawn: As in `scatter`.
        sheet: The textures.
        light: Fractions of ambient light and of light from the sun.
        detail: As in `depth_kernel.Shutter`.
        planes: Filled by the kernel.
    """
    height, width = planes.depth.shape
    paints = Paints(drawn, sheet, light, detail, np.empty((_SCRATCH, _RUN), np.int32))
    changes = np.zeros(width, np.int32)
    spots = np.empty((height * width if detail == 2 else 0, 2), np.int32)
    edges = Edges(spots, np.empty((len(spots), 3), np.uint8))
    starts = np.zeros(height + 1, np.int64)
    count = 0
    for y in range(height):
        _measure(samples, drawn.labels, planes, y, y * detail)
        if detail == 2:
            count = _find_edges(samples.shown, drawn.labels, y, changes, spots, count)
        _shade(samples.shown[y * detail], paints, planes, y)
        if detail == 2:
            # A row is mixed once the row below is painted, while all of them are in cache, and
            # written once the row below is mixed.
            starts[y + 1] = count
            for last in range(y - 1, y + (1 if y + 1 == height else 0)):
                if last >= 0:
                    begin, end = int(starts[last]), int(starts[last + 1])
                    _smooth(edges, begin, end, samples, paints, planes)
                if last >= 1:
                    _settle(edges, int(starts[last - 1]), int(starts[last]), planes.rgb)
    if detail == 2:
        _settle(edges, int(starts[height - 1]), int(starts[height]), planes.rgb)
