"""The numba kernels that colour the pixels from the surfaces that `depth_kernel` found in front.

Each pixel is shaded once, at its centre, with a texture of matching resolution; where its corners
show another surface, the colours are mixed.
"""

from typing import NamedTuple

import numpy as np

from oodscen.numerics._kernels import Kernel, inlined, part
from oodscen_pybullet._meshes.tags import Tag
from oodscen_pybullet._rendering.depth_kernel import (
    TUNNEL_AMBIENT,
    TUNNEL_DIFFUSE,
    DrawnTriangles,
    Samples,
)
from oodscen_pybullet._rendering.triangles import Textures
from oodscen_pybullet._types import F32, I32, U8

_SKY = int(Tag.SKY)
_RUN = 32
"""Largest number of pixels shaded together."""
_FINEST = 2.0
"""Texels per pixel above which the next coarser level is used."""


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
    """[5, _RUN] work space."""


class Colours(NamedTuple):
    """Rows of pixels to be filled."""

    red: U8
    green: U8
    blue: U8
    lit: U8
    """Incidence of the sun on the surface, 0 (grazing) to 255 (perpendicular)."""


@inlined
def _paint(
    mark: int, column: np.float32, row: int, count: int, paints: Paints, colours: Colours, at: int
) -> None:
    """Shade adjacent pixels of one record that is textured or unevenly lit.

    Args:
        mark: The record.
        column: Column of the first sample, pixels.
        row: Row of the samples, counted in samples.
        count: Number of pixels, small enough for a single texture level.
        paints: The records, the textures and the light.
        colours: Receive the pixels from column `at` on.
        at: Column of the first pixel.
    """
    records, labels = paints.drawn.records, paints.drawn.labels
    texels, sizes = paints.sheet.texels, paints.sheet.sizes
    light, detail, scratch = paints.light, paints.detail, paints.scratch
    red, green, blue, lit = colours.red, colours.green, colours.blue, colours.lit
    k, first = np.uint64(mark), np.uint64(at)
    zero, half, full = np.float32(0.0), np.float32(0.5), np.float32(255.0)
    region = labels[k, 0]
    is_uneven = records[k, 17] != zero
    across, down = column - records[k, 0], np.float32(row) - records[k, 1]
    iwx = records[k, 3]
    iw = records[k, 2] + records[k, 3] * across + records[k, 4] * down
    shade, shade_x = zero, zero
    if is_uneven:
        shade_x = records[k, 12]
        shade = records[k, 11] + records[k, 12] * across + records[k, 13] * down
    ambient, diffuse = light[0], light[1]
    if labels[k, 3] & 8:
        ambient, diffuse = np.float32(TUNNEL_AMBIENT), np.float32(TUNNEL_DIFFUSE)
    if region < 0:
        plain_r, plain_g, plain_b = records[k, 14], records[k, 15], records[k, 16]
        for i in range(np.uint64(count)):
            t = np.float32(np.int32(i))
            slant = max((shade + shade_x * t) / (iw + iwx * t), zero)
            strength = ambient + diffuse * slant
            red[first + i] = np.uint8(min(plain_r * strength + half, full))
            green[first + i] = np.uint8(min(plain_g * strength + half, full))
            blue[first + i] = np.uint8(min(plain_b * strength + half, full))
            lit[first + i] = np.uint8(min(slant * full, full))
        return
    ux, vx = records[k, 6], records[k, 9]
    u0 = records[k, 5] + records[k, 6] * across + records[k, 7] * down
    v0 = records[k, 8] + records[k, 9] * across + records[k, 10] * down
    t = np.float32(count - 1) * half
    w = np.float32(1.0) / (iw + iwx * t)
    u, v = (u0 + ux * t) * w, (v0 + vx * t) * w
    along = max(abs((ux - u * iwx) * w), abs((vx - v * iwx) * w))
    iwy = records[k, 4]
    deep = max(abs((records[k, 7] - u * iwy) * w), abs((records[k, 10] - v * iwy) * w))
    spread = along * deep * np.float32(detail)
    size = np.uint64(0)
    limit = np.float32(_FINEST * _FINEST)
    shrink = np.float32(1.0)
    for _ in range(sizes.shape[1] - 1):
        if spread <= limit:
            break
        spread *= np.float32(0.25)
        shrink *= half
        size += np.uint64(1)
    one, picked = np.uint64(1), np.uint64(region)
    start = sizes[picked, size, 0]
    wide, tall = sizes[picked, size, one], sizes[picked, size, np.uint64(2)]
    most_u, most_v = np.float32(wide - 1), np.float32(tall - 1)
    # Every level has one extra column and row, which repeat the last ones.
    line = np.int32(wide + 1)
    two, three, four = np.uint64(2), np.uint64(3), np.uint64(4)
    # Two loops: the first one vectorises, which fetching texels would prevent.
    for i in range(np.uint64(count)):
        t = np.float32(np.int32(i))
        w = np.float32(1.0) / (iw + iwx * t)
        u = min(max((u0 + ux * t) * w * shrink - half, zero), most_u)
        v = min(max((v0 + vx * t) * w * shrink - half, zero), most_v)
        x0, y0 = np.int32(u), np.int32(v)
        scratch[0, i] = start + y0 * line + x0
        scratch[one, i] = np.int32((u - np.float32(x0)) * np.float32(64.0))
        scratch[two, i] = np.int32((v - np.float32(y0)) * np.float32(64.0))
        slant = max((shade + shade_x * t) * w, zero)
        strength = ambient + diffuse * slant if is_uneven else records[k, 14]
        scratch[three, i] = np.int32(strength * np.float32(4096.0))
        scratch[four, i] = np.int32(min(slant * full, full) if is_uneven else records[k, 18])
    rounding = np.uint64(0x800 + (0x800 << 21) + (0x800 << 42))
    lanes = np.uint64(0xFF + (0xFF << 21) + (0xFF << 42))
    most = np.uint64(255)
    for i in range(np.uint64(count)):
        fu, fv = np.uint64(np.uint32(scratch[one, i])), np.uint64(np.uint32(scratch[two, i]))
        a = np.uint64(np.uint32(scratch[0, i]))
        c = a + np.uint64(np.uint32(line))
        k11 = fu * fv
        k10, k01 = (fv << np.uint64(6)) - k11, (fu << np.uint64(6)) - k11
        k00 = np.uint64(4096) - k01 - k10 - k11
        texel = texels[a] * k00 + texels[a + one] * k01 + texels[c] * k10 + texels[c + one] * k11
        texel = ((texel + rounding) >> np.uint64(12)) & lanes
        texel = texel * np.uint64(np.uint32(scratch[three, i])) + rounding
        red[first + i] = np.uint8(min((texel >> np.uint64(12)) & np.uint64(0x1FF), most))
        green[first + i] = np.uint8(min((texel >> np.uint64(33)) & np.uint64(0x1FF), most))
        blue[first + i] = np.uint8(min((texel >> np.uint64(54)) & np.uint64(0x1FF), most))
        lit[first + i] = np.uint8(scratch[four, i])


@inlined
def _differs(mark: int, other: int, labels: I32) -> bool:
    """Return whether two samples show different surfaces."""
    if mark == other:
        return False
    if mark < 0 or other < 0:
        return True
    return bool(labels[np.uint64(mark), 2] != labels[np.uint64(other), 2])


class Edges(NamedTuple):
    """The pixels whose corners show other surfaces."""

    spots: I32
    """[n, 2] row and column."""
    mixed: U8
    """[n, 3] smoothed colours."""


@part
def _smooth(
    edges: Edges, begin: int, end: int, samples: Samples, paints: Paints, planes: Planes
) -> None:
    """Mix the centre of each pixel, weighted one half, with its corners.

    A surface that a neighbour shows at its centre takes that neighbour's colour; only surfaces too thin
    for that are shaded again.
    """
    nearness, shown = samples.nearness, samples.shown
    records, labels = paints.drawn.records, paints.drawn.labels
    spots, mixed = edges.spots, edges.mixed
    rgb, reach, sky = planes.rgb, planes.reach, planes.sky
    height, width = reach.shape
    zero, half, most = np.float32(0.0), np.float32(0.5), np.float32(255.0)
    paint = np.empty((4, 1), np.uint8)
    colours = Colours(paint[0], paint[1], paint[2], paint[3])
    for n in range(np.uint64(begin), np.uint64(end)):
        y, x = int(spots[n, 0]), int(spots[n, 1])
        red = green = blue = weight = total = zero
        one_r = one_g = one_b = zero
        one, before = -1, np.int32(-1)
        for tap in range(5):
            # The centre, then the corners from the upper left.
            part = np.float32(4.0 if tap == 0 else 1.0)
            i, j = (0, 0) if tap == 0 else (2 * ((tap - 1) & 1) - 1, 2 * ((tap - 1) >> 1) - 1)
            r = max(2 * y + j, 0)
            c = max(x - 1, 0) if i < 0 else x
            mark = shown[np.uint64(r), np.uint64(c)]
            if mark < 0:
                continue
            if mark != before:
                before = mark
                k = np.uint64(mark)
                surface = labels[k, 2]
                if surface != one:
                    one = surface
                    is_known = False
                    if labels[k, 0] < 0 and records[k, 17] == zero:
                        one_r, one_g, one_b = records[k, 14], records[k, 15], records[k, 16]
                        is_known = True
                    for step in range(4):
                        # The pixel's own centre, and those of the others that share the corner, are
                        # equally near.
                        if is_known:
                            break
                        b = min(max(y + j, 0), height - 1) if step & 2 else y
                        a = min(max(x + i, 0), width - 1) if step & 1 else x
                        other = shown[np.uint64(2 * b), np.uint64(a)]
                        if other >= 0 and labels[np.uint64(other), 2] == surface:
                            one_r = np.float32(rgb[0, np.uint64(b), np.uint64(a)])
                            one_g = np.float32(rgb[1, np.uint64(b), np.uint64(a)])
                            one_b = np.float32(rgb[2, np.uint64(b), np.uint64(a)])
                            is_known = True
                    if not is_known:
                        middle = np.float32(x) + half * np.float32(i)
                        _paint(mark, middle, 2 * y + j, 1, paints, colours, 0)
                        one_r = np.float32(paint[0, 0])
                        one_g = np.float32(paint[1, 0])
                        one_b = np.float32(paint[2, 0])
            red += part * one_r
            green += part * one_g
            blue += part * one_b
            total += part * nearness[np.uint64(r), np.uint64(c)]
            weight += part
        scale = np.float32(1.0) / weight
        reach[np.uint64(y), np.uint64(x)] = weight / total
        mixed[n, 0] = np.uint8(min(red * scale + half, most))
        mixed[n, 1] = np.uint8(min(green * scale + half, most))
        mixed[n, 2] = np.uint8(min(blue * scale + half, most))
        sky[np.uint64(y), np.uint64(x)] = np.uint8(
            (np.float32(8.0) - weight) * np.float32(255.0 / 8.0) + half
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
        far = np.float32(1.0) / near[x]
        depth[line, x] = np.float32(np.inf) if mark < 0 else far
        reach[line, x] = depth[line, x]
        at = np.uint64(mark if mark >= 0 else 0)
        rows[line, x] = -1 if mark < 0 else labels[at, 1]
        tags[line, x] = np.uint8(_SKY if mark < 0 else labels[at, 4])


@part
def _find_edges(shown: I32, labels: I32, y: int, changes: I32, spots: I32, count: int) -> int:
    """Append the pixels of a row whose corners show other surfaces; return their number so far."""
    row, one = 2 * y, np.uint64(1)
    wide = np.uint64(shown.shape[1])
    middle, over, under = shown[row], shown[max(row - 1, 0)], shown[row + 1]
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
    zero, half, most = np.float32(0.0), np.float32(0.5), np.float32(255.0)
    width, y = marks.shape[0], np.uint64(line)
    colours = Colours(rgb[0, y], rgb[1, y], rgb[2, y], lit[y])
    x = 0
    while x < width:
        at = np.uint64(x)
        mark = marks[at]
        stop = x + 1
        limit = min(x + _RUN, width)
        while stop < limit and marks[np.uint64(stop)] == mark:
            stop += 1
        if mark < 0:
            for i in range(np.uint64(stop - x)):
                sky[y, at + i] = 255
                rgb[0, y, at + i] = rgb[1, y, at + i] = rgb[2, y, at + i] = 0
                lit[y, at + i] = kinds[y, at + i] = 0
        elif labels[np.uint64(mark), 0] < 0 and records[np.uint64(mark), 17] == zero:
            k = np.uint64(mark)
            plain_r = np.uint8(min(records[k, 14] + half, most))
            plain_g = np.uint8(min(records[k, 15] + half, most))
            plain_b = np.uint8(min(records[k, 16] + half, most))
            plain_lit, made = np.uint8(records[k, 18]), np.uint8(labels[k, 3])
            for i in range(np.uint64(stop - x)):
                sky[y, at + i] = 0
                rgb[0, y, at + i] = plain_r
                rgb[1, y, at + i] = plain_g
                rgb[2, y, at + i] = plain_b
                lit[y, at + i] = plain_lit
                kinds[y, at + i] = made
        else:
            row = line * paints.detail
            _paint(mark, np.float32(x), row, stop - x, paints, colours, x)
            made = np.uint8(labels[np.uint64(mark), 3])
            for i in range(np.uint64(stop - x)):
                sky[y, at + i] = 0
                kinds[y, at + i] = made
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
    paints = Paints(drawn, sheet, light, detail, np.empty((5, _RUN), np.int32))
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
