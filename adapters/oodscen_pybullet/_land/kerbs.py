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


class Band(NamedTuple):
    """A band along a road."""

    right: Array
    """[n], t of its right edge, m."""
    left: Array
    where: Mask
    """[n - 1], the pieces where it is."""


def kerb_medians(ribbons: Ribbons, medians: list[Band]) -> None:
    """Add kerbs along both edges of raised medians without a lane between them, except where two touch."""
    if not medians:
        return
    where = np.array([median.where for median in medians])
    is_median = np.zeros((len(medians), where.shape[1] + 1), bool)
    is_median[:, :-1] |= where
    is_median[:, 1:] |= where
    right = np.where(is_median, [median.right for median in medians], np.inf).min(axis=0)
    left = np.where(is_median, [median.left for median in medians], -np.inf).max(axis=0)
    is_any = is_median.any(axis=0)
    right, left = np.where(is_any, right, 0.0), np.where(is_any, left, 0.0)
    whole = Band(right, left, np.asarray(where.any(axis=0)))
    _add_kerbs(ribbons, whole, "kerb", "kerb_side")
    _close_ends(ribbons, whole)


def _close_ends(ribbons: Ribbons, median: Band) -> None:
    """Add upright faces where a raised median begins and ends."""
    padded = np.concatenate([[False], median.where, [False]]).astype(int)
    changes = np.flatnonzero(np.diff(padded)).tolist()
    low = ribbons.course.points(median.right, KERB_FOOT_M)
    high = ribbons.course.points(median.left, KERB_HEIGHT_M)
    uv = np.broadcast_to(swatch_uv("kerb_side"), (1, 4, 2))
    for index, row in enumerate(changes):
        (ax, ay, az), (bx, by, bz) = low[row].tolist(), high[row].tolist()
        face = np.array([upright((bx, by), (ax, ay), az, bz)])
        is_beginning = index % 2 == 0
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
    """Add kerbs along both edges of a raised band, of the colours of their tops and sides."""
    right, left, where = band
    high = (KERB_HEIGHT_M + LAYER_M, KERB_HEIGHT_M + LAYER_M)
    width = np.minimum(_KERB_WIDTH_M, 0.5 * np.maximum(left - right, 0.0))
    ribbons.band(right, right + width, top, heights=high, where=where)
    ribbons.band(left - width, left, top, heights=high, where=where)
    ribbons.band(right - _THIN_M, right, side, heights=(KERB_FOOT_M, KERB_HEIGHT_M), where=where)
    ribbons.band(left, left + _THIN_M, side, heights=(KERB_HEIGHT_M, KERB_FOOT_M), where=where)
