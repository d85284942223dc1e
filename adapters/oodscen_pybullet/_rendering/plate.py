"""The inputs of the kernel that develops pictures: raw pixels, and the light and weather they are seen in.

Compiled code reads them, so every number is a 32-bit scalar, every flag a bool, and every list a tuple or an array.
"""

from typing import NamedTuple

import numpy as np

from oodscen_pybullet._types import F32, U8

GRID_AHEAD, GRID_ASIDE, GRID_CELL_M = 192, 160, 0.5
"""Cells ahead of and across the camera in which lamps light the ground, and their size, m."""
_ZERO = np.float32(0.0)


class Air(NamedTuple):
    """The air between the camera and what it sees."""

    rate: np.float32
    """Extinction by fog, rain and snow, 1/m."""
    fog_rate: np.float32
    """Extinction by fog alone, which also fills tunnels, 1/m."""
    colour: F32
    """[3] colour of thick air, 0 to 255."""
    halo: np.float32
    """Brightness of thick air in the ego's beams, 0 to 255."""
    sky_through: np.float32
    """Fraction of the sky's light that the air lets through."""


class Daylight(NamedTuple):
    """The light of the sun and the sky."""

    direct: F32
    """[3] light in the sun, 1 for an unchanged colour."""
    shade: F32
    """[3] light in shadow."""
    dark: F32
    """[256] the sun's fraction of the light, by `Plate.lit`."""


class ShadowMaps(NamedTuple):
    """The fine shadow map near the camera and the coarse one around it."""

    heights: F32
    """[CELLS, CELLS] heights of the fine map, m above its level; rows by y, columns by x."""
    tiles: F32
    """[CELLS / TILE, CELLS / TILE] greatest height in and beside each tile of the fine map, m."""
    far_heights: F32
    """[FAR_CELLS, FAR_CELLS] heights of the coarse map, m above the same level."""
    is_cast: bool = False
    """False if there are no shadows; then nothing else is read."""
    x: np.float32 = _ZERO
    """Column of the camera's place in the fine map; `y` is its row."""
    y: np.float32 = _ZERO
    z: np.float32 = _ZERO
    """Height of the camera above the maps' level, m."""
    scale: np.float32 = _ZERO
    """Cells of the fine map per metre."""
    far_x: np.float32 = _ZERO
    """Column of the camera's place in the coarse map; `far_y` is its row."""
    far_y: np.float32 = _ZERO
    far_scale: np.float32 = _ZERO
    """Cells of the coarse map per metre."""
    lean_x: np.float32 = _ZERO
    """Distance along x that light covers per metre of height; `lean_y` is the same along y."""
    lean_y: np.float32 = _ZERO
    sun_gain: np.float32 = _ZERO
    """Factor from the sun's fraction of the light to `1` on level ground."""


class Clouds(NamedTuple):
    """The clouds of the sky."""

    edge: np.float32
    """Density at which clouds begin."""
    floor: np.float32
    """Least fraction of the blue sky that is hidden."""
    shade: np.float32
    """Brightness of thin clouds relative to that of thick ones."""
    bright: np.float32
    """Brightness of thick clouds, 0 to 255."""
    sheet: F32
    """[n, m] density by height and heading, one column more than a full turn."""


class PortalPlane(NamedTuple):
    """The end of a tunnel ahead of the camera, and the light inside."""

    lamps: F32
    """[3] light of the tunnel's lamps."""
    is_ahead: bool = False
    """False if there is none; then `is_inside` is false and nothing else counts."""
    is_inside: bool = False
    """True if the camera is in the tunnel and looks out."""
    distance: np.float32 = _ZERO
    """Distance from the camera along the normal, m."""
    right: np.float32 = _ZERO
    """Component of the normal along the camera's right; `up` and `forward` are the others."""
    up: np.float32 = _ZERO
    forward: np.float32 = _ZERO
    air: np.float32 = _ZERO
    """Brightness of the air inside relative to that outside, for a camera inside."""


class Plate(NamedTuple):
    """The inputs of the development of a picture."""

    rgb: U8
    """[3, height, width] raw colours."""
    depth: F32
    """[height, width] m, at the pixels' centres."""
    reach: F32
    """[height, width] mean depth of the part that is not sky, m."""
    lit: U8
    """[height, width] incidence of the sun on the surface, 0 (grazing) to 255 (perpendicular)."""
    kinds: U8
    """[height, width] surface flags, `triangles.SHINING` and so on."""
    sky: U8
    """[height, width] fraction of sky, 0 to 255."""
    across: F32
    """[width] x / depth."""
    upwards: F32
    """[height] y / depth."""
    axes: F32
    """[3, 3] the camera's right, up and forward."""
    eye_height: np.float32
    """Height of the camera above the road, m."""
    air: Air
    daylight: Daylight
    shadow: ShadowMaps
    clouds: Clouds
    portal: PortalPlane
    beam: np.float32
    """Brightness of the ego's beams; 0 if they are off or not seen by day."""
    beam_spread: F32
    """[2, width] lateral falloff of the ego's beams on objects, and in the air."""
    halo: F32
    """[height] brightness of the ego's beams in the air."""
    clear_sky: F32
    """[height, 3] colour of the clear sky, 0 to 255."""
    cloud_rows: F32
    """[height, 2] row of the cloud sheet, and weight of the next row."""
    cloud_columns: F32
    """[width] column of the cloud sheet; its fraction is the weight of the next column."""
    level: F32
    """[3, 2] parts of the camera's right, up and forward to its level right and ahead."""
    has_grid: bool
    grid: F32
    """[GRID_AHEAD, GRID_ASIDE, 3] light of other lamps on the ground; not read without `has_grid`."""
    grid_row: np.float32
    """Row of the grid that the camera is over."""
    wet: np.float32
    """Brightness of wet ground relative to dry; 0 if the ground is dry."""
    has_grain: bool
    noise: np.uint32
    """Start of the sequence of grain."""
