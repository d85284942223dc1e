"""The shape of the land: undulations, hills on the horizon, ditches, and the ground at tunnels and bridges."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from oodscen.driving._roads.corridor import Structure
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.theme import Theme
from oodscen_pybullet._types import Array, Mask

KERB_HEIGHT_M = 0.10
"""Height of pavements above the road, m."""
PORTAL_M = 7.4
"""Height of a tunnel's portal above the road, m."""
BANK_M = 13.0
"""Distance from the asphalt at which the ground beside a portal reaches the portal's height, m."""
VALLEY_M = 11.0
"""Depth of the ground below a bridge, m."""

_UNKERBED_LIFT = -0.02
"""Height of the ground above the adjacent asphalt where there are no kerbs, m."""
_HEIGHTS: dict[Theme, tuple[float, float]] = {
    "residential": (0.0, 11.0),
    "urban": (0.0, 2.0),
    "highway": (5.0, 16.0),
    "rural": (7.0, 20.0),
}
"""Height of the land's undulations and of the hills on the horizon, m."""
_UNDULATING_M, _HILLY_M = (18.0, 90.0), (100.0, 190.0)
"""Distances from asphalt between which undulations, and the hills on the horizon, rise to their height, m."""
_UNDULATION_M, _HILL_M = 75.0, 60.0
"""Wavelengths of undulations and of hills, m."""
_HILL_SWING = 0.45
"""Largest change of the height of hills, as a share of it."""
_HILL_SHIFT_M = 500.0
"""Distance in the noise between undulations and hills, which must not coincide, m."""
_DITCH_M, _DITCH_NEAR_M, _DITCH_FAR_M = 0.25, (0.5, 2.5), (3.0, 6.0)
"""Depth of a ditch beside a road without kerbs, and distances from asphalt along its two banks, m."""
_BANK_NEAR_M = 3.0
"""Distance from the asphalt at which the bank beside a portal begins, m."""
_BANK_FADE_M = (4.0, 60.0)
"""Distances before a tunnel between which the bank falls to the ground, m."""
_COVER_SLOPE, _COVER_M = 0.45, 18.0
"""Slope of the hill above a tunnel, and its height above the portals, m."""
_VALLEY_SIDE_M, _VALLEY_FAR_M = 24.0, (120.0, 190.0)
"""Length of a valley's side below a bridge, and distances from asphalt between which the valley ends, m."""
_ABUTMENT_M = 0.5
"""Length over which the ground below a bridge starts to fall, m; it reaches so far beyond the bridge's ends."""
_GRID = 64
"""Rows and columns after which the noise repeats."""
_GRID_OFFSET = 1000.0
"""Place of the map's origin in the grid of the noise."""


class Heights(NamedTuple):
    """The height of the ground at points, m."""

    beside: Array
    """[n] where the road is in the open."""
    across: Array
    """[n] above a tunnel, or below a bridge."""
    is_above: Mask
    """[n] True where the road is in a tunnel."""


class _Spots(NamedTuple):
    """Points on the land."""

    s: Array
    """[n] s of the nearest point of the ego's road, m."""
    away: Array
    """[n] distance from asphalt, m; 0 on it."""
    road: Array
    """[n] height of the surrounding roads, m."""
    ditch: Array
    """[n] height of a ditch's ground relative to them, m."""


@dataclass(frozen=True, eq=False)
class Relief:
    """The shape of the land around roads."""

    ground: Ground
    theme: Theme
    waves: Array
    """[_GRID, _GRID] -1 to 1: noise at the corners of a grid, which repeats."""

    @classmethod
    def drawn(cls, ground: Ground, theme: Theme, rng: np.random.Generator) -> Self:
        """Draw the undulations and hills."""
        return cls(ground, theme, rng.uniform(-1.0, 1.0, (_GRID, _GRID)))

    @property
    def lift(self) -> float:
        """Height of the ground above the adjacent asphalt, m; `heights` leaves it out."""
        return KERB_HEIGHT_M if self.ground.has_kerb else _UNKERBED_LIFT

    def heights(self, x: Array, y: Array) -> Heights:
        """Return the height of the ground at points."""
        near = self.ground.near(x, y)
        away = np.maximum(near.asphalt, 0.0)
        ditch = np.zeros(len(x)) if self.ground.has_kerb else _ditch(away)
        spots = _Spots(near.s, away, near.z, ditch)
        structures = self.ground.corridor.structures
        tunnels = [one for one in structures if one.kind == "tunnel"]
        heights = _with_tunnels(near.z + self._hills(x, y, away) + ditch, spots, tunnels)
        for structure in structures:
            if structure.kind == "bridge":
                heights = _with_valley(heights, spots, structure)
        return heights

    def _hills(self, x: Array, y: Array, away: Array) -> Array:
        """Return the height of undulations and hills at points at some distances from asphalt, m."""
        undulations, hills = _HEIGHTS[self.theme]
        undulating = undulations * _rise(away, *_UNDULATING_M) * self._noise(x, y, _UNDULATION_M)
        swing = _HILL_SWING * self._noise(x + _HILL_SHIFT_M, y, _HILL_M)
        return np.asarray(undulating + hills * _rise(away, *_HILLY_M) * (1.0 + swing))

    def _noise(self, x: Array, y: Array, size: float) -> Array:
        """Return smooth noise, -1 to 1, with a wavelength of about `size`: value noise."""
        u, v = x / size + _GRID_OFFSET, y / size + _GRID_OFFSET
        i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
        a, b = _rise(u - i, 0.0, 1.0), _rise(v - j, 0.0, 1.0)
        i0, i1, j0, j1 = i % _GRID, (i + 1) % _GRID, j % _GRID, (j + 1) % _GRID
        low = self.waves[i0, j0] * (1 - a) + self.waves[i1, j0] * a
        high = self.waves[i0, j1] * (1 - a) + self.waves[i1, j1] * a
        return np.asarray(low * (1 - b) + high * b, np.float64)


def _with_tunnels(bare: Array, spots: _Spots, tunnels: Sequence[Structure]) -> Heights:
    """Raise the ground beside the portals of tunnels, and the hills above them."""
    before = np.full(len(bare), np.inf)
    for tunnel in tunnels:
        before = np.minimum(before, np.maximum(tunnel.start - spots.s, spots.s - tunnel.end))
    bank = _rise(spots.away, _BANK_NEAR_M, BANK_M) * PORTAL_M
    deep = np.maximum(-before, 0.0)
    return Heights(
        bare + bank * _fall(np.maximum(before, 0.0), *_BANK_FADE_M),
        bare + PORTAL_M + np.minimum(_COVER_SLOPE * deep, _COVER_M),
        before <= 0.0,
    )


def _with_valley(heights: Heights, spots: _Spots, bridge: Structure) -> Heights:
    """Lower the ground below a bridge into a level valley."""
    beside, across, is_above = heights
    within = np.minimum(spots.s - bridge.start, bridge.end - spots.s)
    share = _rise(within, 0.0, _VALLEY_SIDE_M)
    level = 1.0 - share * _fall(spots.away, *_VALLEY_FAR_M)
    beside = spots.road + spots.ditch + (beside - spots.road - spots.ditch) * level
    beside = beside - np.minimum(np.maximum(within, 0.0), _ABUTMENT_M) - VALLEY_M * share
    return Heights(beside, np.where(within > -_ABUTMENT_M, beside, across), is_above)


def _rise(value: Array, start: float, end: float) -> Array:
    """Return 0 below `start`, 1 above `end`, and a smooth ramp in between."""
    share = np.clip((value - start) / (end - start), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share), np.float64)


def _fall(value: Array, start: float, end: float) -> Array:
    """Return 1 below `start`, 0 above `end`, and a smooth ramp in between."""
    return 1.0 - _rise(value, start, end)


def _ditch(away: Array) -> Array:
    """Return the height of the ground beside a road without kerbs, by the distance from asphalt, m."""
    return -_DITCH_M * _rise(away, *_DITCH_NEAR_M) * _fall(away, *_DITCH_FAR_M)
