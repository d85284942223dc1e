"""The numba kernel that finds visible surfaces: triangles into a depth buffer of samples.

It records only the nearest triangle of every sample; `shading` gives the pixels their colours.
All arithmetic is on scalars, so that the bits do not depend on the processor.

Kernels compile on their first call, which takes some seconds: `oodscen.numerics._kernels`.
"""

import math

import numpy as np
from numpy.typing import NDArray

from oodscen.numerics._kernels import Kernel
from oodscen_pybullet._rendering.triangles import SHELTERED

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
U64 = NDArray[np.uint64]

RECORD = 19
"""Numbers stored per drawn triangle: a point on the grid of samples; 1/w, u/w, v/w and light/w there
with their slopes along columns and rows; red, green, blue; 1 if it is lit unevenly; incidence of
the sun, 0 (grazing) to 255 (perpendicular)."""
BLOCK = 16
"""Samples that are drawn together; sample buffers are padded by this length."""
TUNNEL_AMBIENT, TUNNEL_DIFFUSE = 0.78, 0.22
"""Fractions of a tunnel's light that are ambient, and from the ceiling."""
LABELS = 4
"""Integers stored per drawn triangle: texture, label, surface, kind."""


@Kernel
def scatter(
    corners: F32,
    planes: F32,
    colours: F32,
    regions: I32,
    kinds: U8,
    spans: I32,
    places: F64,
    spheres: F32,
    camera: F64,
    sun: F64,
    detail: int,
    width: int,
    height: int,
    nearness: F32,
    shown: I32,
    records: F32,
    labels: I32,
    count: int,
) -> int:
    """Draw objects into the buffer of samples.

    Args:
        corners: [n, 3, 8] x, y, z, normal, and texel column and row, in the object's frame.
        planes: [n, 4] normal and offset of each triangle's plane; it shows on the positive side.
        colours: [n, 3] colours of triangles without texture, 0 to 255.
        regions: [n] textures, -1 for none.
        kinds: [n] surface flags; passed through.
        spans: [m, 3] first triangle, end (exclusive), and label of each object.
        places: [m, 5] x, y, z, cosine and sine of the yaw of each object.
        spheres: [m, 4] centre and radius of each object's bounding sphere, in its frame.
        camera: [17] eye, right, up, forward, focal length in pixels, near and far plane, m; column
            and row of the optical axis, pixels.
        sun: [5] direction towards the sun, ambient and diffuse fraction.
        detail: 1 samples each pixel at its centre. 2 adds a row of samples between each two rows of
            pixels, shifted right by half a pixel: the pixels' corners.
        width: Pixels and samples per row.
        height: Rows of pixels.
        nearness: [height * detail * width + BLOCK] 1/w of the front surface, initially of the far plane.
        shown: [height * detail * width + BLOCK] record of the front surface, initially -1.
        records: [k, RECORD] records of drawn triangles, filled from `count` on.
        labels: [k, LABELS] labels of drawn triangles.
        count: Number of records so far.

    Returns:
        The new number of records.
    """
    focal, near, far = camera[12], camera[13], camera[14]
    columns, rows = width, height * detail
    tall = focal * detail
    axis_x, axis_y = camera[15], camera[16]
    middle_x, middle_y = axis_x - 0.5, (axis_y - 0.5) * detail
    rim = columns - 1.0 / detail
    slope_x = max(axis_x, width - axis_x) / focal
    slope_y = max(axis_y, height - axis_y) / focal
    lean_x = math.sqrt(1.0 + slope_x * slope_x)
    lean_y = math.sqrt(1.0 + slope_y * slope_y)
    poly = np.empty((4, 6))
    px = np.empty(5)
    py = np.empty(5)
    pw = np.empty(5)
    step = np.empty(4)
    for index in range(spans.shape[0]):
        c, s = places[index, 3], places[index, 4]
        ex = camera[0] - places[index, 0]
        ey = camera[1] - places[index, 1]
        ez = camera[2] - places[index, 2]
        eye_x, eye_y, eye_z = c * ex + s * ey, c * ey - s * ex, ez
        rx, ry, rz = c * camera[3] + s * camera[4], c * camera[4] - s * camera[3], camera[5]
        ux, uy, uz = c * camera[6] + s * camera[7], c * camera[7] - s * camera[6], camera[8]
        fx, fy, fz = c * camera[9] + s * camera[10], c * camera[10] - s * camera[9], camera[11]
        sx, sy, sz = c * sun[0] + s * sun[1], c * sun[1] - s * sun[0], sun[2]
        bx, by, bz = spheres[index, 0] - eye_x, spheres[index, 1] - eye_y, spheres[index, 2] - eye_z
        radius = np.float64(spheres[index, 3])
        ahead = bx * fx + by * fy + bz * fz
        if ahead < near - radius or ahead > far + radius:
            continue
        if abs(bx * rx + by * ry + bz * rz) > ahead * slope_x + radius * lean_x:
            continue
        if abs(bx * ux + by * uy + bz * uz) > ahead * slope_y + radius * lean_y:
            continue
        for k in range(spans[index, 0], spans[index, 1]):
            if planes[k, 0] * eye_x + planes[k, 1] * eye_y + planes[k, 2] * eye_z <= planes[k, 3]:
                continue
            behind = 0
            for j in range(3):
                dx, dy, dz = (
                    corners[k, j, 0] - eye_x,
                    corners[k, j, 1] - eye_y,
                    corners[k, j, 2] - eye_z,
                )
                w = dx * fx + dy * fy + dz * fz
                poly[j, 0] = dx * rx + dy * ry + dz * rz
                poly[j, 1] = dx * ux + dy * uy + dz * uz
                poly[j, 2] = w
                if w < near:
                    behind += 1
            if behind == 3:
                continue
            # Each slot of px, py and pw is a corner of the polygon left after near-plane clipping.
            n = 0
            if behind == 0:
                for j in range(3):
                    inverse = 1.0 / poly[j, 2]
                    px[j] = middle_x + focal * poly[j, 0] * inverse
                    py[j] = middle_y - tall * poly[j, 1] * inverse
                    pw[j] = inverse
                n = 3
            else:
                for j in range(3):
                    i = (j + 1) % 3
                    wj, wi = poly[j, 2], poly[i, 2]
                    if wj >= near:
                        px[n] = middle_x + focal * poly[j, 0] / wj
                        py[n] = middle_y - tall * poly[j, 1] / wj
                        pw[n] = 1.0 / wj
                        n += 1
                    if (wj >= near) != (wi >= near):
                        # Start at the same end from both sides, so that neighbours meet exactly.
                        if wj < near:
                            share = (near - wj) / (wi - wj)
                            x = poly[j, 0] + share * (poly[i, 0] - poly[j, 0])
                            y = poly[j, 1] + share * (poly[i, 1] - poly[j, 1])
                        else:
                            share = (near - wi) / (wj - wi)
                            x = poly[i, 0] + share * (poly[j, 0] - poly[i, 0])
                            y = poly[i, 1] + share * (poly[j, 1] - poly[i, 1])
                        px[n] = middle_x + focal * x / near
                        py[n] = middle_y - tall * y / near
                        pw[n] = 1.0 / near
                        n += 1
            low_x, high_x, low_y, high_y = px[0], px[0], py[0], py[0]
            for j in range(1, n):
                low_x, high_x = min(low_x, px[j]), max(high_x, px[j])
                low_y, high_y = min(low_y, py[j]), max(high_y, py[j])
            if high_x < 0.0 or high_y < 0.0 or low_x > rim or low_y > rows - 1:
                continue
            first = max(math.floor(low_y) + 1.0, 0.0)
            last = min(math.floor(high_y), rows - 1.0)
            if first > last:
                continue
            if max(math.ceil(low_x * detail), 0.0) > math.ceil(high_x * detail) - 1.0:
                continue
            # 1/w is linear over the screen: the plane through the eye-space triangle.
            ax, ay, aw = poly[0, 0], poly[0, 1], poly[0, 2]
            b0, b1, b2 = poly[1, 0], poly[1, 1], poly[1, 2]
            c0, c1, c2 = poly[2, 0], poly[2, 1], poly[2, 2]
            # Rows of the inverse of the matrix of corners, scaled by its determinant.
            i00, i01, i02 = b1 * c2 - b2 * c1, b2 * c0 - b0 * c2, b0 * c1 - b1 * c0
            i10, i11, i12 = c1 * aw - c2 * ay, c2 * ax - c0 * aw, c0 * ay - c1 * ax
            i20, i21, i22 = ay * b2 - aw * b1, aw * b0 - ax * b2, ax * b1 - ay * b0
            det = ax * i00 + ay * i01 + aw * i02
            if det == 0.0:
                continue
            turn = 1.0 / det
            grow_x, grow_y = turn / focal, turn / tall
            at_x = math.floor(min(max(0.5 * (low_x + high_x), 0.0), columns - 1.0))
            at_y = math.floor(min(max(0.5 * (low_y + high_y), 0.0), rows - 1.0))
            view_x, view_y = (at_x - middle_x) / focal, (middle_y - at_y) / tall
            g0, g1, g2 = i00 + i10 + i20, i01 + i11 + i21, i02 + i12 + i22
            iw = (g0 * view_x + g1 * view_y + g2) * turn
            iwx, iwy = g0 * grow_x, -g1 * grow_y
            # Left and right ends of the rows, edge by edge from the upper corner down.
            for j in range(n):
                i = j + 1 if j + 1 < n else 0
                if py[j] < py[i]:
                    step[j] = (px[i] - px[j]) / (py[i] - py[j])
                elif py[i] < py[j]:
                    step[j] = (px[j] - px[i]) / (py[j] - py[i])
                else:
                    step[j] = 0.0
            is_drawn = False
            slope = np.float32(iwx)
            mark = np.int32(count)
            # A triangle has one long side and two short ones; clipped ones have four sides.
            top, foot = 0, 0
            if n == 3:
                for j in range(1, 3):
                    top = j if py[j] < py[top] else top
                    foot = j if py[j] >= py[foot] else foot
            bend = 3 - top - foot
            if n == 3:
                long = top if (top + 1) % 3 == foot else foot
                upper = top if (top + 1) % 3 == bend else bend
                lower = bend if (bend + 1) % 3 == foot else foot
                long_step, upper_step, lower_step = step[long], step[upper], step[lower]
                top_x, top_y, bend_x, bend_y = px[top], py[top], px[bend], py[bend]
            for row in range(int(first), int(last) + 1):
                level = np.float64(row)
                if n == 3:
                    left = top_x + (level - top_y) * long_step
                    if level <= bend_y:
                        right = top_x + (level - top_y) * upper_step
                    else:
                        right = bend_x + (level - bend_y) * lower_step
                    left, right = min(left, right), max(left, right)
                else:
                    left, right = 1e30, -1e30
                    for j in range(n):
                        i = j + 1 if j + 1 < n else 0
                        if (py[j] < level) != (py[i] < level):
                            if py[j] < py[i]:
                                x = px[j] + (level - py[j]) * step[j]
                            else:
                                x = px[i] + (level - py[i]) * step[j]
                            left, right = min(left, x), max(right, x)
                shift = 0.5 if detail == 2 and row & 1 else 0.0
                start = math.ceil(max(left - shift, 0.0))
                stop = min(math.ceil(right - shift), np.float64(columns))
                if not start < stop:
                    continue
                begin = np.float32(iw + iwx * (start + shift - at_x) + iwy * (level - at_y))
                base = np.uint64(row * columns + int(start))
                hits = np.uint32(0)
                length, offset = np.int32(int(stop) - int(start)), np.int32(0)
                while offset < length:
                    # A fixed number of samples, always written back, so that the loop vectorises.
                    for lane in range(np.uint64(BLOCK)):
                        along = offset + np.int32(lane)
                        value = begin + slope * np.float32(along)
                        before, other = nearness[base + lane], shown[base + lane]
                        is_nearer = (value > before) & (along < length)
                        nearness[base + lane] = value if is_nearer else before
                        shown[base + lane] = mark if is_nearer else other
                        hits |= np.uint32(is_nearer)
                    offset += np.int32(BLOCK)
                    base += np.uint64(BLOCK)
                if hits:
                    is_drawn = True
            if not is_drawn:
                continue
            record = records[count]
            record[0], record[1] = at_x, at_y
            record[2], record[3], record[4] = iw, iwx, iwy
            labels[count, 0] = regions[k]
            labels[count, 1] = spans[index, 2]
            labels[count, 2] = count
            lights = (
                corners[k, 0, 3] * sx + corners[k, 0, 4] * sy + corners[k, 0, 5] * sz,
                corners[k, 1, 3] * sx + corners[k, 1, 4] * sy + corners[k, 1, 5] * sz,
                corners[k, 2, 3] * sx + corners[k, 2, 4] * sy + corners[k, 2, 5] * sz,
            )
            ambient, diffuse = sun[3], sun[4]
            if kinds[k] & SHELTERED:
                # In a tunnel light comes from the ceiling.
                lights = (
                    np.float64(corners[k, 0, 5]),
                    np.float64(corners[k, 1, 5]),
                    np.float64(corners[k, 2, 5]),
                )
                ambient, diffuse = TUNNEL_AMBIENT, TUNNEL_DIFFUSE
            is_uneven = (
                max(lights[0], lights[1], lights[2]) - min(lights[0], lights[1], lights[2]) > 1e-3
            )
            strength = 1.0
            record[17] = record[18] = 0.0
            labels[count, 3] = kinds[k]
            if is_uneven:
                record[17] = 1.0
                p0 = lights[0] * i00 + lights[1] * i10 + lights[2] * i20
                p1 = lights[0] * i01 + lights[1] * i11 + lights[2] * i21
                p2 = lights[0] * i02 + lights[1] * i12 + lights[2] * i22
                record[11] = (p0 * view_x + p1 * view_y + p2) * turn
                record[12], record[13] = p0 * grow_x, -p1 * grow_y
            else:
                strength = ambient + diffuse * max(0.0, lights[0])
                record[18] = 255.0 * min(max(lights[0], 0.0), 1.0)
            if regions[k] >= 0:
                for e in range(2):
                    t0, t1, t2 = corners[k, 0, 6 + e], corners[k, 1, 6 + e], corners[k, 2, 6 + e]
                    p0 = t0 * i00 + t1 * i10 + t2 * i20
                    p1 = t0 * i01 + t1 * i11 + t2 * i21
                    p2 = t0 * i02 + t1 * i12 + t2 * i22
                    record[5 + 3 * e] = (p0 * view_x + p1 * view_y + p2) * turn
                    record[6 + 3 * e], record[7 + 3 * e] = p0 * grow_x, -p1 * grow_y
                record[14] = record[15] = record[16] = strength
            else:
                for e in range(3):
                    record[14 + e] = colours[k, e] * strength
            if not is_uneven:
                # Surfaces that look alike on both sides of an edge need no smoothing there.
                tone = int(record[14] * 8.0) * 4096 + int(record[15] * 8.0)
                tone = tone * 4096 + int(record[16] * 8.0)
                if regions[k] >= 0:
                    tone = int(strength * 255.0) * 256 + regions[k] + (1 << 40)
                tone = ((tone * 32 + kinds[k]) * 512 + spans[index, 2] + 1) % 2147483629
                labels[count, 2] = -2 - np.int32(tone)
            count += 1
    return count
