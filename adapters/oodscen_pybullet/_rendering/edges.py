"""Smooth edges: where a pixel's corners show other surfaces than its centre, all their colours are mixed.

The loop of `smooth` stays whole: with the colour of a corner in an inlined function of its own, it took twice as long.
"""

from typing import NamedTuple

import numpy as np

from oodscen.numerics._kernels import inlined, part
from oodscen_pybullet._rendering import records as rec
from oodscen_pybullet._rendering.depth_kernel import Samples
from oodscen_pybullet._rendering.painting import Colours, Paints, Planes, Run, paint
from oodscen_pybullet._types import I32, U8

_ZERO, _HALF, _ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
_FULL = np.float32(255.0)
"""Largest value of a byte."""

# A centre counts as much as the four corners together.
_CENTRE, _CORNER = np.float32(4.0), np.float32(1.0)
_ALL_TAPS = np.float32(8.0)


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


@part
def find_edges(shown: I32, labels: I32, y: int, changes: I32, spots: I32, count: int) -> int:
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


@inlined
def _differs(mark: int, other: int, labels: I32) -> bool:
    """Return whether two samples show different surfaces."""
    if mark == other:
        return False
    if mark < 0 or other < 0:
        return True
    return bool(labels[np.uint64(mark), rec.SURFACE] != labels[np.uint64(other), rec.SURFACE])


@part
def smooth(
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
                    paint(Run(mark, column, 2 * y + down, 1, 0), paints, painted)
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
def settle(edges: Edges, begin: int, end: int, rgb: U8) -> None:
    """Write the smoothed colours of some pixels."""
    spots, mixed = edges.spots, edges.mixed
    for n in range(np.uint64(begin), np.uint64(end)):
        for e in range(3):
            rgb[e, np.uint64(spots[n, 0]), np.uint64(spots[n, 1])] = mixed[n, e]
