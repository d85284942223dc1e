"""The numba kernel that colours the pixels from the surfaces that `depth_kernel` found in front.

Each pixel is shaded once, at its centre, with a texture of matching resolution; where its corners
show another surface, the colours are mixed.
"""

import numpy as np

from oodscen.numerics._kernels import Kernel, part
from oodscen_pybullet._meshes.tags import Tag
from oodscen_pybullet._rendering import records as rec
from oodscen_pybullet._rendering.depth_kernel import Samples
from oodscen_pybullet._rendering.edges import Edges, find_edges, settle, smooth
from oodscen_pybullet._rendering.painting import RUN, SCRATCH, Colours, Paints, Planes, Run, paint
from oodscen_pybullet._rendering.records import DrawnTriangles
from oodscen_pybullet._rendering.triangles import Textures
from oodscen_pybullet._types import F32, I32

_SKY = int(Tag.SKY)
_ZERO, _HALF, _ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
_FULL = np.float32(255.0)
"""Largest value of a byte."""


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
def _shade(marks: I32, paints: Paints, planes: Planes, line: int) -> None:
    """Colour the centres of a row of pixels, one run of equal records after another."""
    records, labels = paints.drawn.records, paints.drawn.labels
    rgb, sky, lit, kinds = planes.rgb, planes.sky, planes.lit, planes.kinds
    width, y, row = marks.shape[0], np.uint64(line), line * paints.detail
    colours = Colours(rgb[0, y], rgb[1, y], rgb[2, y], lit[y])
    x = 0
    while x < width:
        mark = marks[np.uint64(x)]
        stop, limit = x + 1, min(x + RUN, width)
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
            paint(Run(mark, np.float32(x), row, stop - x, x), paints, colours)
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
    paints = Paints(drawn, sheet, light, detail, np.empty((SCRATCH, RUN), np.int32))
    changes = np.zeros(width, np.int32)
    spots = np.empty((height * width if detail == 2 else 0, 2), np.int32)
    edges = Edges(spots, np.empty((len(spots), 3), np.uint8))
    starts = np.zeros(height + 1, np.int64)
    count = 0
    for y in range(height):
        _measure(samples, drawn.labels, planes, y, y * detail)
        if detail == 2:
            count = find_edges(samples.shown, drawn.labels, y, changes, spots, count)
        _shade(samples.shown[y * detail], paints, planes, y)
        if detail == 2:
            # A row is mixed once the row below is painted, while all of them are in cache, and
            # written once the row below is mixed.
            starts[y + 1] = count
            for last in range(y - 1, y + (1 if y + 1 == height else 0)):
                if last >= 0:
                    begin, end = int(starts[last]), int(starts[last + 1])
                    smooth(edges, begin, end, samples, paints, planes)
                if last >= 1:
                    settle(edges, int(starts[last - 1]), int(starts[last]), planes.rgb)
    if detail == 2:
        settle(edges, int(starts[height - 1]), int(starts[height]), planes.rgb)
