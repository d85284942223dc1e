"""The numba kernel that finds visible surfaces: triangles into a depth buffer of samples.

It records only the nearest triangle of every sample; `shading` gives the pixels their colours.
All arithmetic is on scalars, so that the bits do not depend on the processor.

A value that is linear over a triangle in space is, divided by the depth w, linear on the screen: the inverse of the
matrix whose rows are the corners (right, up, ahead) turns the corners' values into that linear function, and their
ones into 1/w itself. Only the outline of a triangle is clipped at the near plane; the function holds for all of it.

Source: Olano and Greer, Triangle scan conversion using 2D homogeneous coordinates, 1997.

The kernels stay whole where they are long: numba compiles smaller parts to slower code or to other bits.

Kernels compile on their first call, which takes some seconds: `oodscen.numerics._kernels`.
"""

import math
from typing import NamedTuple

import numpy as np

from oodscen.numerics._kernels import Kernel, inlined, part
from oodscen_pybullet._rendering import records as rec
from oodscen_pybullet._rendering.records import DrawnTriangles
from oodscen_pybullet._rendering.triangles import SHELTERED, Triangles
from oodscen_pybullet._types import F32, I32, Array

BLOCK = 16
"""Samples that are drawn together; sample buffers are padded by this length."""

_EVEN = 1e-3
"""Difference between the corners' cosines with the light below which a triangle is evenly lit."""
_EYE, _RIGHT, _UP, _FORWARD, _SUN = range(5)
"""Rows of the table of vectors in an object's frame."""

# Evenly lit surfaces that look alike get one number, in mixed radix: their colour in steps of 1/8, their flags, their
# body. The largest prime that leaves room for two more values in 32 bits folds it.
_TONE_STEPS, _TONES, _KINDS, _BODIES = 8.0, 4096, 32, 512
_STRENGTH_STEPS, _TEXTURES = 255.0, 256
_TEXTURED = 1 << 40
"""Keeps the numbers of textures apart from those of colours."""
_PRIME = 2**31 - 19


class Samples(NamedTuple):
    """The front surface of every sample, padded by BLOCK."""

    nearness: F32
    """[height * detail * width + BLOCK] 1/w, initially of the far plane."""
    shown: I32
    """[height * detail * width + BLOCK] record, initially -1."""


class Screen(NamedTuple):
    """The projection onto samples."""

    focal: float
    """Pixels per unit of x / w."""
    tall: float
    """Samples per unit of y / w."""
    near: float
    """Distance of the near plane, m."""
    middle_x: float
    """Column of the optical axis."""
    middle_y: float
    """Row of the optical axis."""
    columns: int
    rows: int
    detail: int


class Outline(NamedTuple):
    """Work space for one triangle."""

    points: Array
    """[3, 3] corners to the right, upwards and ahead of the camera, m."""
    x: Array
    """[5] columns of the corners that the near plane leaves."""
    y: Array
    """[5] their rows."""
    steps: Array
    """[5] columns per row along each edge."""


class Plane(NamedTuple):
    """The linear functions of the screen that a triangle's corners define."""

    inverse: Array
    """[3, 3] the inverse of the matrix of corners, times its determinant."""
    turn: float
    """1 / determinant."""
    grow_x: float
    grow_y: float
    at_x: float
    """Column of the point at which values are given."""
    at_y: float
    view_x: float
    """x / w of that point."""
    view_y: float


class Shutter(NamedTuple):
    """The camera, the light and the samples of a picture."""

    camera: Array
    """[17] eye, right, up, forward, focal length in pixels, near and far plane, m; column and row of the
    optical axis, pixels."""
    sun: Array
    """[5] direction towards the sun, ambient and diffuse fraction."""
    detail: int
    """1 samples each pixel at its centre. 2 adds a row of samples between each two rows of pixels, shifted right
    by half a pixel: the pixels' corners."""
    width: int
    """Pixels and samples per row."""
    height: int
    """Rows of pixels."""


@Kernel
def scatter(
    objects: Triangles, shutter: Shutter, samples: Samples, drawn: DrawnTriangles, count: int
) -> int:
    """Draw objects into the buffer of samples.

    Args:
        objects: The objects.
        shutter: The camera and the light.
        samples: The front surfaces, changed in place.
        drawn: Receives the drawn triangles from `count` on.
        count: Number of records so far.

    Returns:
        The new number of records.
    """
    camera, sun, detail = shutter.camera, shutter.sun, shutter.detail
    width, height = shutter.width, shutter.height
    focal, far = camera[12], camera[14]
    axis_x, axis_y = camera[15], camera[16]
    screen = Screen(
        focal, focal * detail, camera[13], axis_x - 0.5, (axis_y - 0.5) * detail,
        width, height * detail, detail,
    )  # fmt: skip
    slopes = (max(axis_x, width - axis_x) / focal, max(axis_y, height - axis_y) / focal)
    outline = Outline(np.empty((3, 3)), np.empty(5), np.empty(5), np.empty(5))
    inverse, turned = np.empty((3, 3)), np.empty((5, 3))
    spans = objects.spans
    for index in range(spans.shape[0]):
        _turn(objects, index, camera, sun, turned)
        if not _is_in_view(objects, index, turned, screen.near, far, slopes):
            continue
        for k in range(spans[index, 0], spans[index, 1]):
            corners = _project(objects, k, turned, screen, outline)
            if corners == 0:
                continue
            low_x, high_x, low_y, high_y = _extent(outline, corners)
            rim = screen.columns - 1.0 / detail
            if high_x < 0.0 or high_y < 0.0 or low_x > rim or low_y > screen.rows - 1:
                continue
            first = max(math.floor(low_y) + 1.0, 0.0)
            last = min(math.floor(high_y), screen.rows - 1.0)
            if first > last:
                continue
            if max(math.ceil(low_x * detail), 0.0) > math.ceil(high_x * detail) - 1.0:
                continue
            det = _invert(outline, inverse)
            if det == 0.0:
                continue
            at_x = math.floor(min(max(0.5 * (low_x + high_x), 0.0), screen.columns - 1.0))
            at_y = math.floor(min(max(0.5 * (low_y + high_y), 0.0), screen.rows - 1.0))
            turn = 1.0 / det
            plane = Plane(
                inverse, turn, turn / screen.focal, turn / screen.tall, at_x, at_y,
                (at_x - screen.middle_x) / screen.focal, (screen.middle_y - at_y) / screen.tall,
            )  # fmt: skip
            depth = _linear(plane, 1.0, 1.0, 1.0)
            if _fill(outline, corners, screen, plane, depth, (first, last), samples, count):
                _note(objects, index, k, turned, sun, plane, depth, drawn, count)
                count += 1
    return count


@part
def _turn(objects: Triangles, index: int, camera: Array, sun: Array, turned: Array) -> None:
    """Write eye, right, up, forward and sun in an object's frame into the rows of `turned`."""
    places = objects.places
    c, s = places[index, 3], places[index, 4]
    ex, ey = camera[0] - places[index, 0], camera[1] - places[index, 1]
    turned[_EYE, 0], turned[_EYE, 1] = c * ex + s * ey, c * ey - s * ex
    turned[_EYE, 2] = camera[2] - places[index, 2]
    for axis in range(1, 4):
        x, y = camera[3 * axis], camera[3 * axis + 1]
        turned[axis, 0], turned[axis, 1] = c * x + s * y, c * y - s * x
        turned[axis, 2] = camera[3 * axis + 2]
    turned[_SUN, 0], turned[_SUN, 1] = c * sun[0] + s * sun[1], c * sun[1] - s * sun[0]
    turned[_SUN, 2] = sun[2]


@part
def _is_in_view(
    objects: Triangles,
    index: int,
    turned: Array,
    near: float,
    far: float,
    slopes: tuple[float, float],
) -> bool:
    """Return whether an object's sphere may be in the picture, whose edges have these slopes."""
    spheres = objects.spheres
    x = spheres[index, 0] - turned[_EYE, 0]
    y = spheres[index, 1] - turned[_EYE, 1]
    z = spheres[index, 2] - turned[_EYE, 2]
    radius = np.float64(spheres[index, 3])
    ahead = x * turned[_FORWARD, 0] + y * turned[_FORWARD, 1] + z * turned[_FORWARD, 2]
    if ahead < near - radius or ahead > far + radius:
        return False
    across = abs(x * turned[_RIGHT, 0] + y * turned[_RIGHT, 1] + z * turned[_RIGHT, 2])
    if across > ahead * slopes[0] + radius * math.sqrt(1.0 + slopes[0] * slopes[0]):
        return False
    upwards = abs(x * turned[_UP, 0] + y * turned[_UP, 1] + z * turned[_UP, 2])
    return bool(upwards <= ahead * slopes[1] + radius * math.sqrt(1.0 + slopes[1] * slopes[1]))


@inlined
def _project(objects: Triangles, k: int, turned: Array, screen: Screen, outline: Outline) -> int:
    """Project a triangle, clipped at the near plane; return the number of corners left."""
    planes, corners = objects.planes, objects.corners
    points, px, py = outline.points, outline.x, outline.y
    eye_x, eye_y, eye_z = turned[_EYE, 0], turned[_EYE, 1], turned[_EYE, 2]
    if planes[k, 0] * eye_x + planes[k, 1] * eye_y + planes[k, 2] * eye_z <= planes[k, 3]:
        return 0
    near, focal, tall = screen.near, screen.focal, screen.tall
    behind = 0
    for j in range(3):
        dx, dy, dz = corners[k, j, 0] - eye_x, corners[k, j, 1] - eye_y, corners[k, j, 2] - eye_z
        w = dx * turned[_FORWARD, 0] + dy * turned[_FORWARD, 1] + dz * turned[_FORWARD, 2]
        points[j, 0] = dx * turned[_RIGHT, 0] + dy * turned[_RIGHT, 1] + dz * turned[_RIGHT, 2]
        points[j, 1] = dx * turned[_UP, 0] + dy * turned[_UP, 1] + dz * turned[_UP, 2]
        points[j, 2] = w
        if w < near:
            behind += 1
    if behind == 3:
        return 0
    if behind == 0:
        for j in range(3):
            inverse = 1.0 / points[j, 2]
            px[j] = screen.middle_x + focal * points[j, 0] * inverse
            py[j] = screen.middle_y - tall * points[j, 1] * inverse
        return 3
    n = 0
    for j in range(3):
        i = (j + 1) % 3
        wj, wi = points[j, 2], points[i, 2]
        if wj >= near:
            px[n] = screen.middle_x + focal * points[j, 0] / wj
            py[n] = screen.middle_y - tall * points[j, 1] / wj
            n += 1
        if (wj >= near) != (wi >= near):
            # Start at the same end from both sides, so that neighbours meet exactly.
            a, b = (j, i) if wj < near else (i, j)
            share = (near - points[a, 2]) / (points[b, 2] - points[a, 2])
            x = points[a, 0] + share * (points[b, 0] - points[a, 0])
            y = points[a, 1] + share * (points[b, 1] - points[a, 1])
            px[n] = screen.middle_x + focal * x / near
            py[n] = screen.middle_y - tall * y / near
            n += 1
    return n


@inlined
def _extent(outline: Outline, corners: int) -> tuple[float, float, float, float]:
    """Return the lowest and highest column, and the lowest and highest row."""
    px, py = outline.x, outline.y
    low_x, high_x, low_y, high_y = px[0], px[0], py[0], py[0]
    for j in range(1, corners):
        low_x, high_x = min(low_x, px[j]), max(high_x, px[j])
        low_y, high_y = min(low_y, py[j]), max(high_y, py[j])
    return low_x, high_x, low_y, high_y


@inlined
def _invert(outline: Outline, inverse: Array) -> float:
    """Write the inverse of the matrix of corners, times its determinant, which is returned."""
    points = outline.points
    ax, ay, aw = points[0, 0], points[0, 1], points[0, 2]
    b0, b1, b2 = points[1, 0], points[1, 1], points[1, 2]
    c0, c1, c2 = points[2, 0], points[2, 1], points[2, 2]
    inverse[0, 0] = b1 * c2 - b2 * c1
    inverse[0, 1] = b2 * c0 - b0 * c2
    inverse[0, 2] = b0 * c1 - b1 * c0
    inverse[1, 0] = c1 * aw - c2 * ay
    inverse[1, 1] = c2 * ax - c0 * aw
    inverse[1, 2] = c0 * ay - c1 * ax
    inverse[2, 0] = ay * b2 - aw * b1
    inverse[2, 1] = aw * b0 - ax * b2
    inverse[2, 2] = ax * b1 - ay * b0
    return float(ax * inverse[0, 0] + ay * inverse[0, 1] + aw * inverse[0, 2])


@inlined
def _linear(plane: Plane, a: float, b: float, c: float) -> tuple[float, float, float]:
    """Return the values a, b and c of the three corners over w as a function of the screen.

    Returns:
        The function at the plane's point, its growth per column and its growth per row.
    """
    inverse = plane.inverse
    p0 = a * inverse[0, 0] + b * inverse[1, 0] + c * inverse[2, 0]
    p1 = a * inverse[0, 1] + b * inverse[1, 1] + c * inverse[2, 1]
    p2 = a * inverse[0, 2] + b * inverse[1, 2] + c * inverse[2, 2]
    value = (p0 * plane.view_x + p1 * plane.view_y + p2) * plane.turn
    return value, p0 * plane.grow_x, -p1 * plane.grow_y


@inlined
def _find_steps(outline: Outline, corners: int) -> None:
    """Write the columns per row along each edge, from its upper corner down."""
    px, py, step = outline.x, outline.y, outline.steps
    for j in range(corners):
        i = j + 1 if j + 1 < corners else 0
        if py[j] < py[i]:
            step[j] = (px[i] - px[j]) / (py[i] - py[j])
        elif py[i] < py[j]:
            step[j] = (px[j] - px[i]) / (py[j] - py[i])
        else:
            step[j] = 0.0


@part
def _fill(
    outline: Outline,
    corners: int,
    screen: Screen,
    plane: Plane,
    depth: tuple[float, float, float],
    lines: tuple[float, float],
    samples: Samples,
    count: int,
) -> bool:
    """Draw the rows of a triangle; return whether any sample shows it.

    Args:
        outline: The triangle; a clipped one has four corners.
        corners: Their number.
        screen: The projection.
        plane: Gives the point to which `depth` belongs.
        depth: 1/w there, per column and per row.
        lines: First and last row.
        samples: The front surfaces, changed in place.
        count: The triangle's record.
    """
    px, py, step = outline.x, outline.y, outline.steps
    nearness, shown = samples.nearness, samples.shown
    iw, iwx, iwy = depth
    _find_steps(outline, corners)
    is_drawn = False
    slope = np.float32(iwx)
    mark = np.int32(count)
    # A triangle has one long side and two short ones.
    top, foot = 0, 0
    if corners == 3:
        for j in range(1, 3):
            top = j if py[j] < py[top] else top
            foot = j if py[j] >= py[foot] else foot
    bend = 3 - top - foot
    long = top if (top + 1) % 3 == foot else foot
    upper = top if (top + 1) % 3 == bend else bend
    lower = bend if (bend + 1) % 3 == foot else foot
    long_step, upper_step, lower_step = step[long], step[upper], step[lower]
    top_x, top_y, bend_x, bend_y = px[top], py[top], px[bend], py[bend]
    for row in range(int(lines[0]), int(lines[1]) + 1):
        level = np.float64(row)
        if corners == 3:
            left = top_x + (level - top_y) * long_step
            if level <= bend_y:
                right = top_x + (level - top_y) * upper_step
            else:
                right = bend_x + (level - bend_y) * lower_step
            left, right = min(left, right), max(left, right)
        else:
            left, right = 1e30, -1e30
            for j in range(corners):
                i = j + 1 if j + 1 < corners else 0
                if (py[j] < level) != (py[i] < level):
                    if py[j] < py[i]:
                        x = px[j] + (level - py[j]) * step[j]
                    else:
                        x = px[i] + (level - py[i]) * step[j]
                    left, right = min(left, x), max(right, x)
        shift = 0.5 if screen.detail == 2 and row & 1 else 0.0
        start = math.ceil(max(left - shift, 0.0))
        stop = min(math.ceil(right - shift), np.float64(screen.columns))
        if not start < stop:
            continue
        begin = np.float32(iw + iwx * (start + shift - plane.at_x) + iwy * (level - plane.at_y))
        base = np.uint64(row * screen.columns + int(start))
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
    return is_drawn


@part
def _note(
    objects: Triangles,
    index: int,
    k: int,
    turned: Array,
    sun: Array,
    plane: Plane,
    depth: tuple[float, float, float],
    drawn: DrawnTriangles,
    count: int,
) -> None:
    """Write the record of a drawn triangle."""
    corners, regions, kinds, colours = (
        objects.corners,
        objects.regions,
        objects.kinds,
        objects.colours,
    )
    record, labels = drawn.records[count], drawn.labels
    record[rec.COLUMN], record[rec.ROW] = plane.at_x, plane.at_y
    record[rec.NEARNESS], record[rec.NEARNESS_X], record[rec.NEARNESS_Y] = depth
    labels[count, rec.TEXTURE] = regions[k]
    labels[count, rec.BODY] = objects.spans[index, 2]
    labels[count, rec.SURFACE] = count
    labels[count, rec.KIND] = kinds[k]
    labels[count, rec.CLASS] = objects.tags[k]
    sx, sy, sz = turned[_SUN, 0], turned[_SUN, 1], turned[_SUN, 2]
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
        ambient, diffuse = rec.TUNNEL_AMBIENT, rec.TUNNEL_DIFFUSE
    brightest, darkest = max(lights[0], lights[1], lights[2]), min(lights[0], lights[1], lights[2])
    is_uneven = brightest - darkest > _EVEN
    strength = 1.0
    record[rec.IS_UNEVEN] = record[rec.LIT] = 0.0
    if is_uneven:
        record[rec.IS_UNEVEN] = 1.0
        record[rec.LIGHT], record[rec.LIGHT_X], record[rec.LIGHT_Y] = _linear(
            plane, lights[0], lights[1], lights[2]
        )
    else:
        strength = ambient + diffuse * max(0.0, lights[0])
        record[rec.LIT] = 255.0 * min(max(lights[0], 0.0), 1.0)
    if regions[k] >= 0:
        for e in range(2):
            t0, t1, t2 = corners[k, 0, 6 + e], corners[k, 1, 6 + e], corners[k, 2, 6 + e]
            u, u_x, u_y = _linear(plane, t0, t1, t2)
            at = rec.U + 3 * e
            record[at], record[at + 1], record[at + 2] = u, u_x, u_y
        record[rec.RED] = record[rec.GREEN] = record[rec.BLUE] = strength
    else:
        for e in range(3):
            record[rec.RED + e] = colours[k, e] * strength
    if not is_uneven:
        # Surfaces that look alike on both sides of an edge need no smoothing there.
        tone = int(record[rec.RED] * _TONE_STEPS) * _TONES
        tone += int(record[rec.GREEN] * _TONE_STEPS)
        tone = tone * _TONES + int(record[rec.BLUE] * _TONE_STEPS)
        if regions[k] >= 0:
            tone = int(strength * _STRENGTH_STEPS) * _TEXTURES + regions[k] + _TEXTURED
        tone = ((tone * _KINDS + kinds[k]) * _BODIES + objects.spans[index, 2] + 1) % _PRIME
        labels[count, rec.SURFACE] = -2 - np.int32(tone)
