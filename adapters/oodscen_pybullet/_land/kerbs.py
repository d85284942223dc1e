"""Pavements and medians that stand above a road, with their kerbs."""

from typing import NamedTuple

import numpy as np

from oodscen_pybullet._land.land import KERB_FOOT_M
from oodscen_pybullet._land.relief import KERB_HEIGHT_M
from oodscen_pybullet._land.ribbons import LAYER_M, Ribbons
from oodscen_pybullet._meshes.atlas import swatch_uv
from oodscen_pybullet._meshes.shapes import upright
from oodscen_pybullet._types import Array, Mask

_KERB_WIDTH_M = 0.16
"""Width of a kerb, m."""
_THIN_M = 1e-5
"""Width of the side of a kerb seen from above, m."""
_STEP_M = 1e-3
"""Width of a step in the edge of a median up to which it has no face of its own, m."""

_Span = tuple[float, float]
"""t of the right and the left end of a line across the road, m."""


class Band(NamedTuple):
    """A band along a road."""

    right: Array
    """[n], t of its right edge, m."""
    left: Array
    where: Mask
    """[n - 1], the pieces where it is."""


def kerb_medians(ribbons: Ribbons, medians: list[Band]) -> None:
    """Add kerbs along both edges of raised medians without a lane between them, except where two touch."""
    outlines = _outlines(medians)
    for outline in outlines:
        _add_kerbs(ribbons, outline, "kerb", "kerb_side")
    if outlines:
        _close_ends(ribbons, outlines)


def _outlines(medians: list[Band]) -> list[Band]:
    """Return what neighbouring medians cover together: one band for the pieces of every group that occurs."""
    groups: dict[tuple[int, ...], list[int]] = {}
    for piece, there in enumerate(zip(*(median.where.tolist() for median in medians), strict=True)):
        group = tuple(np.flatnonzero(there).tolist())
        if group:
            groups.setdefault(group, []).append(piece)
    outlines = []
    for group, pieces in groups.items():
        where = np.zeros(len(medians[0].where), bool)
        where[pieces] = True
        right = np.min([medians[index].right for index in group], axis=0)
        left = np.max([medians[index].left for index in group], axis=0)
        outlines.append(Band(right, left, where))
    return outlines


def _close_ends(ribbons: Ribbons, outlines: list[Band]) -> None:
    """Add upright faces where raised medians begin or end, or change their width at once."""
    pieces = len(outlines[0].where)
    which = np.full(pieces + 2, -1)
    for index, outline in enumerate(outlines):
        which[1:-1][outline.where] = index
    for row in np.flatnonzero(np.diff(which)).tolist():
        before, after = (
            (outlines[index].right[row], outlines[index].left[row]) if index >= 0 else None
            for index in which[row : row + 2].tolist()
        )
        for right, left in _uncovered(after, before):
            _add_end(ribbons, row, right, left, is_beginning=True)
        for right, left in _uncovered(before, after):
            _add_end(ribbons, row, right, left, is_beginning=False)


def _uncovered(span: _Span | None, cover: _Span | None) -> list[_Span]:
    """Return the parts of a span that another does not cover."""
    if span is None or cover is None:
        return [span] if span else []
    (right, left), (right_end, left_end) = span, cover
    parts = ((right, min(left, right_end)), (max(right, left_end), left))
    return [(low, high) for low, high in parts if high - low > _STEP_M]


def _add_end(ribbons: Ribbons, row: int, right: float, left: float, *, is_beginning: bool) -> None:
    """Add the upright face of a raised median across the road, at a sample of its course."""
    ax, ay, az = ribbons.course.points(right, KERB_FOOT_M)[row].tolist()
    bx, by, bz = ribbons.course.points(left, KERB_HEIGHT_M)[row].tolist()
    face = np.array([upright((bx, by), (ax, ay), az, bz)])
    uv = np.broadcast_to(swatch_uv("kerb_side"), (1, 4, 2))
    ribbons.add_quads(face if is_beginning else face[:, [1, 0, 3, 2]], uv)


def raise_tunnel_walk(ribbons: Ribbons, band: Band) -> None:
    """Add a tunnel's walk at the height of a pavement, with kerbs."""
    right, left, where = band
    ribbons.band(right, left, "tunnel_light", heights=(KERB_HEIGHT_M, KERB_HEIGHT_M), where=where)
    _add_kerbs(ribbons, band, "tunnel_light", "tunnel")


def raise_pavement(ribbons: Ribbons, band: Band) -> None:
    """Add a pavement with kerbs."""
    right, left, where = band
    ribbons.tiled_band(right, left, "paving", heights=(KERB_HEIGHT_M, KERB_HEIGHT_M), where=where)
    _add_kerbs(ribbons, band, "kerb", "kerb_side")


def _add_kerbs(ribbons: Ribbons, band: Band, top: str, side: str) -> None:
    """Add kerbs along both edges of a raised band, with the given colours for tops and sides."""
    right, left, where = band
    high = (KERB_HEIGHT_M + LAYER_M, KERB_HEIGHT_M + LAYER_M)
    width = np.minimum(_KERB_WIDTH_M, 0.5 * np.maximum(left - right, 0.0))
    ribbons.band(right, right + width, top, heights=high, where=where)
    ribbons.band(left - width, left, top, heights=high, where=where)
    ribbons.band(right - _THIN_M, right, side, heights=(KERB_FOOT_M, KERB_HEIGHT_M), where=where)
    ribbons.band(left, left + _THIN_M, side, heights=(KERB_HEIGHT_M, KERB_FOOT_M), where=where)
