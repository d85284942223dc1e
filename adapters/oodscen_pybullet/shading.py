"""The numba kernels that give pixels their colours, from what `raster` found in front.

Each pixel is shaded once, at its centre, with textures in a size that fits; where the samples
around it show more than one surface, these are mixed.
"""

import numpy as np

from oodscen_pybullet.compiling import inlined, kernel
from oodscen_pybullet.raster import F32, I32, U8, U64

_RUN = 16
"""Most pixels that are shaded together."""
_FINEST = 2.0
"""Texels per pixel from which on the next coarser size is taken."""


@inlined
def _paint(
    mark: int,
    column: int,
    row: int,
    count: int,
    records: F32,
    labels: I32,
    texels: U64,
    sizes: I32,
    light: F32,
    detail: int,
    strip: F32,
) -> None:
    """Shade neighbouring pixels of one record that is textured or lit unevenly.

    Args:
        mark: The record.
        column: Of the first sample.
        row: Of the samples.
        count: Pixels; so few that one size of texture fits all.
        records: Of `scatter`.
        labels: Of `scatter`.
        texels: Of `gather`.
        sizes: Of `gather`.
        light: Of `gather`.
        detail: Samples from one pixel to the next.
        strip: [4, at least count] to be filled with red, green, blue, and how squarely the sun meets
            the surface, 0 to 255.
    """
    k = np.uint64(mark)
    zero, half = np.float32(0.0), np.float32(0.5)
    red, green, blue = records[k, 14], records[k, 15], records[k, 16]
    region = labels[k, 0]
    is_uneven = records[k, 17] != zero
    full = np.float32(255.0)
    across, down = np.float32(column) - records[k, 0], np.float32(row) - records[k, 1]
    stride = np.float32(detail)
    iwx = records[k, 3] * stride
    iw = records[k, 2] + records[k, 3] * across + records[k, 4] * down
    shade, shade_x = zero, zero
    if is_uneven:
        shade_x = records[k, 12] * stride
        shade = records[k, 11] + records[k, 12] * across + records[k, 13] * down
    if region < 0:
        for i in range(np.uint64(count)):
            t = np.float32(np.int32(i))
            slant = max((shade + shade_x * t) / (iw + iwx * t), zero)
            strength = light[0] + light[1] * slant
            strip[0, i], strip[1, i], strip[2, i], strip[3, i] = (
                red * strength,
                green * strength,
                blue * strength,
                min(slant * full, full),
            )
        return
    ux, vx = records[k, 6] * stride, records[k, 9] * stride
    u0 = records[k, 5] + records[k, 6] * across + records[k, 7] * down
    v0 = records[k, 8] + records[k, 9] * across + records[k, 10] * down
    t = np.float32(count - 1) * half
    w = np.float32(1.0) / (iw + iwx * t)
    u, v = (u0 + ux * t) * w, (v0 + vx * t) * w
    along = max(abs((ux - u * iwx) * w), abs((vx - v * iwx) * w))
    iwy = records[k, 4]
    deep = max(abs((records[k, 7] - u * iwy) * w), abs((records[k, 10] - v * iwy) * w)) * stride
    spread = along * deep
    size = np.uint64(0)
    limit = np.float32(_FINEST * _FINEST)
    shrink = np.float32(1.0)
    for _ in range(sizes.shape[1] - 1):
        if spread <= limit:
            break
        spread *= np.float32(0.25)
        shrink *= half
        size += np.uint64(1)
    one, two, picked = np.uint64(1), np.uint64(2), np.uint64(region)
    start = sizes[picked, size, 0]
    wide, tall = sizes[picked, size, one], sizes[picked, size, two]
    low = np.uint64(0x1FFFFF)
    most_u, most_v = np.float32(wide - 1), np.float32(tall - 1)
    for i in range(np.uint64(count)):
        t = np.float32(np.int32(i))
        w = np.float32(1.0) / (iw + iwx * t)
        u = min(max((u0 + ux * t) * w * shrink - half, zero), most_u)
        v = min(max((v0 + vx * t) * w * shrink - half, zero), most_v)
        x0, y0 = np.int32(u), np.int32(v)
        fu = np.uint64(np.int32((u - np.float32(x0)) * np.float32(64.0)))
        fv = np.uint64(np.int32((v - np.float32(y0)) * np.float32(64.0)))
        a = np.uint64(start + y0 * wide + x0)
        c = a + (np.uint64(wide) if y0 + 1 < tall else np.uint64(0))
        right = np.uint64(1) if x0 + 1 < wide else np.uint64(0)
        k11 = fu * fv
        k10, k01 = (fv << np.uint64(6)) - k11, (fu << np.uint64(6)) - k11
        k00 = np.uint64(4096) - k01 - k10 - k11
        texel = (
            texels[a] * k00 + texels[a + right] * k01 + texels[c] * k10 + texels[c + right] * k11
        )
        strength = np.float32(1.0 / 4096.0)
        strip[3, i] = records[k, 18]
        if is_uneven:
            slant = max((shade + shade_x * t) * w, zero)
            strength *= light[0] + light[1] * slant
            strip[3, i] = min(slant * full, full)
        strip[0, i] = red * strength * np.float32(np.int32(texel & low))
        strip[1, i] = green * strength * np.float32(np.int32((texel >> np.uint64(21)) & low))
        strip[2, i] = blue * strength * np.float32(np.int32(texel >> np.uint64(42)))


@kernel
def _is_edge(
    shown: I32, labels: I32, row: int, column: int, last_row: int, last_column: int
) -> bool:
    """Tell whether the samples around one show more than one surface."""
    mark = shown[row, column]
    surface = labels[np.uint64(mark), 2] if mark >= 0 else -1
    for r in range(max(row - 1, 0), min(row + 1, last_row) + 1):
        for c in range(max(column - 1, 0), min(column + 1, last_column) + 1):
            other = shown[r, c]
            if other != mark and (other < 0 or labels[np.uint64(other), 2] != surface):
                return True
    return False


@kernel
def _smooth(
    spots: I32,
    count: int,
    nearness: F32,
    shown: I32,
    records: F32,
    labels: I32,
    texels: U64,
    sizes: I32,
    light: F32,
    rgb: U8,
    reach: F32,
    sky: U8,
) -> None:
    """Mix what the nine samples at and around the centres of some pixels show.

    A surface that a neighbour shows at its centre has that neighbour's colour; only what is too
    thin for that is shaded anew.
    """
    height, width = reach.shape
    last_row, last_column = 2 * height - 1, 2 * width - 1
    zero, half, most = np.float32(0.0), np.float32(0.5), np.float32(255.0)
    strip = np.empty((4, 1), np.float32)
    mixed = np.empty((count, 3), np.uint8)
    for n in range(np.uint64(count)):
        y, x = int(spots[n, 0]), int(spots[n, 1])
        red = green = blue = weight = total = zero
        one_r = one_g = one_b = zero
        one = -1
        for j in range(-1, 2):
            r = min(max(2 * y + j, 0), last_row)
            for i in range(-1, 2):
                c = min(max(2 * x + i, 0), last_column)
                mark = shown[np.uint64(r), np.uint64(c)]
                if mark < 0:
                    continue
                k = np.uint64(mark)
                surface = labels[k, 2]
                if surface != one:
                    one = surface
                    is_known = False
                    if labels[k, 0] < 0 and records[k, 17] == zero:
                        one_r, one_g, one_b = records[k, 14], records[k, 15], records[k, 16]
                        is_known = True
                    for step in range(3):
                        # Its own centre, then that of the pixel across, then of the one above or
                        # below, are as near as any.
                        if is_known:
                            break
                        b = min(max(y + j, 0), height - 1) if step == 2 else y
                        a = min(max(x + i, 0), width - 1) if step == 1 else x
                        other = shown[np.uint64(2 * b), np.uint64(2 * a)]
                        if other >= 0 and labels[np.uint64(other), 2] == surface:
                            one_r = np.float32(rgb[0, np.uint64(b), np.uint64(a)])
                            one_g = np.float32(rgb[1, np.uint64(b), np.uint64(a)])
                            one_b = np.float32(rgb[2, np.uint64(b), np.uint64(a)])
                            is_known = True
                    if not is_known:
                        _paint(mark, c, r, 1, records, labels, texels, sizes, light, 2, strip)
                        one_r, one_g, one_b = strip[0, 0], strip[1, 0], strip[2, 0]
                part = np.float32((2 - abs(i)) * (2 - abs(j)))
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
            (np.float32(16.0) - weight) * np.float32(255.0 / 16.0) + half
        )
    for n in range(np.uint64(count)):
        for e in range(3):
            rgb[e, np.uint64(spots[n, 0]), np.uint64(spots[n, 1])] = mixed[n, e]


@kernel
def gather(
    nearness: F32,
    shown: I32,
    records: F32,
    labels: I32,
    texels: U64,
    sizes: I32,
    light: F32,
    detail: int,
    rgb: U8,
    depth: F32,
    rows: I32,
    reach: F32,
    sky: U8,
    lit: U8,
    kinds: U8,
) -> None:
    """Shade every pixel.

    Args:
        nearness: Of `scatter`, [height * detail, width * detail].
        shown: Of `scatter`, likewise.
        records: Of `scatter`.
        labels: Of `scatter`.
        texels: Every texture in every size, row by row; red, green and blue 21 bits apart, so that
            one product weighs all three.
        sizes: [regions, sizes, 3] where each begins in `texels`, its width and height.
        light: Shares of light from everywhere and from the sun.
        detail: Samples per pixel along a row and along a column, 1 or 2.
        rgb: [3, height, width] to be filled.
        depth: [height, width] to be filled: at the pixel's centre, m, infinity for the sky.
        rows: The same with the label, -1 for the sky.
        reach: The same with the mean distance of what is not sky, m.
        sky: The same with the share of sky, 0 to 255.
        lit: The same with how squarely the sun meets the surface at the centre, 0 to 255.
        kinds: The same with what that surface is made of.
    """
    height, width = depth.shape
    last_column, last_row = width * detail - 1, height * detail - 1
    zero, half, most = np.float32(0.0), np.float32(0.5), np.float32(255.0)
    strip = np.empty((4, _RUN), np.float32)
    upright = np.zeros(width * detail + 2, np.int32)
    level = np.zeros(width * detail + 2, np.int32)
    mixed = np.zeros(width, np.int32)
    spots = np.empty((height * width if detail == 2 else 0, 2), np.int32)
    count = 0
    marks = np.empty(width, np.int32)
    one, two = np.uint64(1), np.uint64(2)
    step, wide = np.uint64(detail), np.uint64(width)
    for y in range(np.uint64(height)):
        row = int(y) * detail
        middle, near = shown[row], nearness[row]
        for x in range(wide):
            mark = middle[x * step]
            marks[x] = mark
            far = np.float32(1.0) / near[x * step]
            depth[y, x] = np.float32(np.inf) if mark < 0 else far
            reach[y, x] = depth[y, x]
            rows[y, x] = -1 if mark < 0 else labels[np.uint64(mark if mark >= 0 else 0), 1]
        if detail == 2:
            over, under = shown[max(row - 1, 0)], shown[min(row + 1, last_row)]
            for c in range(np.uint64(width * 2)):
                upright[c + one] = (over[c] ^ middle[c]) | (under[c] ^ middle[c])
            for c in range(np.uint64(last_column)):
                level[c + one] = middle[c] ^ middle[c + one]
            for i in range(wide):
                k = i * two
                mixed[i] = (
                    upright[k] | upright[k + one] | upright[k + two] | level[k] | level[k + one]
                )
            for i in range(wide):
                if mixed[i] and _is_edge(shown, labels, row, int(i) * 2, last_row, last_column):
                    spots[np.uint64(count), 0], spots[np.uint64(count), 1] = y, i
                    count += 1
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
                _paint(
                    mark,
                    x * detail,
                    row,
                    stop - x,
                    records,
                    labels,
                    texels,
                    sizes,
                    light,
                    detail,
                    strip,
                )
                made = np.uint8(labels[np.uint64(mark), 3])
                for i in range(np.uint64(stop - x)):
                    sky[y, at + i] = 0
                    lit[y, at + i] = np.uint8(strip[3, i])
                    kinds[y, at + i] = made
                    rgb[0, y, at + i] = np.uint8(min(strip[0, i] + half, most))
                    rgb[1, y, at + i] = np.uint8(min(strip[1, i] + half, most))
                    rgb[2, y, at + i] = np.uint8(min(strip[2, i] + half, most))
            x = stop
    if count:
        _smooth(
            spots,
            count,
            nearness,
            shown,
            records,
            labels,
            texels,
            sizes,
            light,
            rgb,
            reach,
            sky,
        )
