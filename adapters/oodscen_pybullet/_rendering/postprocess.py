"""The kernel that turns raw colours into a camera's picture in one pass over the rows.

It applies shadows, wetness, lamps, fog, sky and grain in scalar arithmetic on 32-bit numbers, so
the bits do not depend on the processor; `postprocess_arrays` does the same without numba.
"""

from typing import Any, NamedTuple

import numpy as np

from oodscen.numerics._kernels import Kernel, part
from oodscen_pybullet._rendering.optics import (
    CLOUD_GAIN,
    CLOUD_TINT,
    FARTHEST_M,
    HORIZON_M,
    OPAQUE,
    TINT_B,
    TINT_G,
    TINY,
    beam,
    cloud_share,
    fade,
    grain,
)
from oodscen_pybullet._rendering.plate import GRID_AHEAD, GRID_ASIDE, GRID_CELL_M, Plate
from oodscen_pybullet._rendering.triangles import GROUND, SHELTERED, SHINING, SOFT
from oodscen_pybullet._types import F32, U8

_ONE, _HALF, _ZERO = np.float32(1.0), np.float32(0.5), np.float32(0.0)
_SHADOWS_END = np.float32(78.0)
"""Distance beyond which only the coarse shadow map is used, m."""
_BLEND, _BLEND_CELLS = np.float32(0.07), np.float32(0.25)
"""1 / distance before that within which both maps are blended, 1/m, and metres that count for a cell of the fine map."""
_LEVEL_BIAS, _FAR_BIAS = np.float32(0.03), np.float32(0.001)
"""Height by which a surface must be in shadow, m, and its growth per metre of distance."""
_UPRIGHT_BIAS, _SLANT_BIAS = np.float32(0.05), np.float32(0.25)
"""The same in addition for objects, m, and at a grazing sun."""
_COARSE_BIAS = np.float32(0.3)
"""The same in addition on the coarse shadow map, m."""
_ENTERS = np.float32(1.0 / 7.0)
"""1 / distance at which the daylight in a tunnel has halved, 1/m."""
_FACING = np.float32(1e-4)
"""Least cosine, times the ray's length per metre of depth, at which a ray meets the portal."""
_ALOFT = np.float32(0.2)
"""1 / height above the ground at which the light of other lamps has halved, 1/m."""


class RowBuffers(NamedTuple):
    """Work space for one row of pixels."""

    clear: F32
    """[width] brightness left by shadows."""
    sunny: F32
    """[width] 1 in the sun, 0 in shadow."""
    indoors: F32
    """[width] brightness of a tunnel's interior."""
    gate: F32
    """[width] distance of the portal."""
    light: F32
    """[3, width] red, green and blue."""
    veil: F32
    """[width] fraction of the light that the air lets through."""
    clouds: F32
    """[m] density of clouds at this height."""


@Kernel
def postprocess_pixels(plate: Plate, image: U8, first: int, end: int) -> None:
    """Develop rows of a picture, from `first` to before `end`, into `image`, [height, width, 3]."""
    width = plate.depth.shape[1]
    rows, light = np.empty((5, width), np.float32), np.empty((3, width), np.float32)
    clouds = np.empty(plate.clouds.sheet.shape[1], np.float32)
    line = RowBuffers(rows[0], rows[1], rows[2], rows[3], light, rows[4], clouds)
    line.sunny[:] = _ONE
    line.indoors[:] = _ZERO
    has_portal = plate.portal.is_ahead
    for y in range(first, end):
        for x in range(width):
            line.clear[x] = _ONE
        if plate.shadow.is_cast:
            _find_shadows(plate, line, y)
        if has_portal:
            _find_tunnel(plate, line, y)
        _add_daylight(plate, line)
        if plate.beam > _ZERO:
            _add_beams(plate, line, y)
        if plate.has_grid:
            _add_lamps(plate, line, y)
        if has_portal:
            _add_tunnel_lamps(plate, line)
        _colour(plate, line, y)
        if plate.wet > _ZERO:
            _wet(plate, line, y)
        if plate.air.rate > _ZERO:
            _find_veil(plate, line, y)
            _add_air(plate, line, y)
        _add_sky(plate, line, y)
        if plate.has_grain:
            _add_grain(plate, line, y)
        _store(line, image, y)


@part
def _lit_share(heights: Any, u: Any, v: Any, z: Any) -> Any:
    """Return the fraction of sunlight that reaches a point of a shadow map.

    Args:
        heights: The map.
        u: Column of the point, less than the last one.
        v: Row of the point.
        z: Height of the point.
    """
    one = np.uint64(1)
    i, j = np.uint64(np.int32(u)), np.uint64(np.int32(v))
    fu, fv = u - np.float32(np.int32(u)), v - np.float32(np.int32(v))
    a = _ONE if heights[j, i] <= z else _ZERO
    b = _ONE if heights[j, i + one] <= z else _ZERO
    c = _ONE if heights[j + one, i] <= z else _ZERO
    d = _ONE if heights[j + one, i + one] <= z else _ZERO
    a += (b - a) * fu
    c += (d - c) * fu
    return a + (c - a) * fv


@part
def _near_light(tiles: Any, heights: Any, u: Any, v: Any, z: Any) -> Any:
    """Return the fraction of sunlight that reaches a point of the shadow map near the camera."""
    i, j = np.uint64(np.int32(u)), np.uint64(np.int32(v))
    if tiles[j >> np.uint64(4), i >> np.uint64(4)] > z:
        return _lit_share(heights, u, v, z)
    return _ONE


@part
def _far_light(heights: Any, u: Any, v: Any, z: Any) -> Any:
    """Return the fraction of sunlight that reaches a point by the coarse shadow map."""
    cells = np.float32(heights.shape[0] - 1)
    if _ZERO <= u < cells and _ZERO <= v < cells:
        return _lit_share(heights, u, v, z + _COARSE_BIAS)
    return _ONE


@part
def _find_shadows(plate: Plate, line: RowBuffers, y: int) -> None:
    """Look up which pixels of a row are in the sun, and how bright those in shadow are."""
    shadow, axes, across, dark = plate.shadow, plate.axes, plate.across, plate.daylight.dark
    depth, lit, kinds = plate.depth, plate.lit, plate.kinds
    clear, sunny = line.clear, line.sunny
    is_inside = plate.portal.is_inside
    cells = np.float32(shadow.heights.shape[0] - 1)
    scale = shadow.scale
    far_share = shadow.far_scale / scale
    right_x = (axes[0, 0] - shadow.lean_x * axes[0, 2]) * scale
    right_y = (axes[0, 1] - shadow.lean_y * axes[0, 2]) * scale
    up = plate.upwards[y]
    rise = up * axes[1, 2] + axes[2, 2]
    step_x = (axes[2, 0] + up * axes[1, 0] - shadow.lean_x * rise) * scale
    step_y = (axes[2, 1] + up * axes[1, 1] - shadow.lean_y * rise) * scale
    for x in range(across.shape[0]):
        kind = kinds[y, x]
        is_sheltered = kind & SHELTERED != 0
        sunny[x] = _ZERO
        if lit[y, x] == 0 or kind & SHINING or (is_sheltered and not is_inside):
            continue
        far = depth[y, x]
        z = shadow.z + far * rise + _LEVEL_BIAS + far * _FAR_BIAS
        if not kind & GROUND:
            # Objects have faces at all angles and therefore need a larger tolerance.
            slant = _ONE - np.float32(lit[y, x]) * TINY
            z += _UPRIGHT_BIAS + _SLANT_BIAS * slant
        aside, along = step_x + across[x] * right_x, step_y + across[x] * right_y
        u, v = shadow.x + far * aside, shadow.y + far * along
        edge = np.minimum(np.minimum(u, cells - u), np.minimum(v, cells - v))
        share = np.minimum(_SHADOWS_END - far, edge * _BLEND_CELLS)
        share = np.minimum(share * _BLEND, _ONE)
        sun = _ONE
        if share > _ZERO:
            sun = _near_light(shadow.tiles, shadow.heights, u, v, z)
        else:
            share = _ZERO
        if share < _ONE:
            u = shadow.far_x + far * aside * far_share
            v = shadow.far_y + far * along * far_share
            wide = _far_light(shadow.far_heights, u, v, z)
            sun = wide + (sun - wide) * share
        loss = _HALF if is_sheltered else dark[lit[y, x]]
        clear[x] = _ONE - loss * (_ONE - sun)
        sunny[x] = np.minimum(sun * loss * shadow.sun_gain, _ONE)


@part
def _find_tunnel(plate: Plate, line: RowBuffers, y: int) -> None:
    """Find the distance of the portal in each pixel, and how far daylight enters."""
    portal, across, kinds, reach = plate.portal, plate.across, plate.kinds, plate.reach
    clear, sunny, indoors, gate = line.clear, line.sunny, line.indoors, line.gate
    up = plate.upwards[y]
    for x in range(across.shape[0]):
        towards = portal.forward + up * portal.up + across[x] * portal.right
        gate[x] = HORIZON_M
        if towards > _FACING:
            gate[x] = portal.distance / towards
        indoors[x] = _ZERO
        if kinds[y, x] & SHELTERED:
            # Daylight enters for some metres.
            way = np.minimum(reach[y, x], FARTHEST_M) * towards - portal.distance
            way = way * _ENTERS
            indoors[x] = clear[x]
            clear[x] = clear[x] / (_ONE + way * way)
            sunny[x] = _ZERO


@part
def _add_daylight(plate: Plate, line: RowBuffers) -> None:
    """Start a row with the light of the sun and the sky."""
    clear, sunny, light = line.clear, line.sunny, line.light
    for c in range(3):
        shade = plate.daylight.shade[c]
        gain = plate.daylight.direct[c] - shade
        for x in range(clear.shape[0]):
            light[c, x] = (shade + gain * sunny[x]) * clear[x]


@part
def _add_beams(plate: Plate, line: RowBuffers, y: int) -> None:
    """Add the ego's low beams."""
    axes, spread = plate.axes, plate.beam_spread
    kinds, reach = plate.kinds, plate.reach
    light = line.light
    rise = plate.upwards[y] * axes[1, 2] + axes[2, 2]
    for x in range(light.shape[1]):
        near = np.minimum(reach[y, x], FARTHEST_M)
        is_ground = kinds[y, x] & (GROUND | SOFT) == GROUND
        aloft = _ZERO if is_ground else plate.eye_height + near * rise
        bright = beam(near, aloft, spread[0, x], plate.beam)
        light[0, x] += bright
        light[1, x] += bright * TINT_G
        light[2, x] += bright * TINT_B


@part
def _add_lamps(plate: Plate, line: RowBuffers, y: int) -> None:
    """Add the light of other lamps."""
    axes, across, level, grid = plate.axes, plate.across, plate.level, plate.grid
    kinds, reach = plate.kinds, plate.reach
    light, up = line.light, plate.upwards[y]
    rise = up * axes[1, 2] + axes[2, 2]
    aside, ahead = up * level[1, 0] + level[2, 0], up * level[1, 1] + level[2, 1]
    one = np.uint64(1)
    for x in range(light.shape[1]):
        near = np.minimum(reach[y, x], FARTHEST_M)
        u = near * (ahead + across[x] * level[0, 1]) * np.float32(1.0 / GRID_CELL_M)
        v = near * (aside + across[x] * level[0, 0]) * np.float32(1.0 / GRID_CELL_M)
        u, v = u + plate.grid_row, v + np.float32(GRID_ASIDE / 2)
        is_near = _ZERO <= u < np.float32(GRID_AHEAD - 1) and _ZERO <= v < np.float32(
            GRID_ASIDE - 1
        )
        if not is_near:
            continue
        i, j = np.uint64(np.int32(u)), np.uint64(np.int32(v))
        fu, fv = u - np.float32(np.int32(u)), v - np.float32(np.int32(v))
        aloft = np.maximum(plate.eye_height + near * rise, _ZERO) * _ALOFT
        if kinds[y, x] & (GROUND | SOFT) == GROUND:
            aloft = _ZERO
        share = _ONE / (_ONE + aloft * aloft)
        w11 = fu * fv * share
        w10, w01 = fu * share - w11, fv * share - w11
        w00 = share - w11 - w10 - w01
        for e in range(3):
            k = np.uint64(e)
            bright = (
                grid[i, j, k] * w00
                + grid[i, j + one, k] * w01
                + grid[i + one, j, k] * w10
                + grid[i + one, j + one, k] * w11
            )
            light[e, x] += bright


@part
def _add_tunnel_lamps(plate: Plate, line: RowBuffers) -> None:
    """Light a tunnel's interior."""
    light, indoors = line.light, line.indoors
    for c in range(3):
        bright = plate.portal.lamps[c]
        for x in range(indoors.shape[0]):
            light[c, x] = np.maximum(light[c, x], bright * indoors[x])


@part
def _colour(plate: Plate, line: RowBuffers, y: int) -> None:
    """Multiply the light by the surfaces' colours."""
    rgb, kinds, light = plate.rgb, plate.kinds, line.light
    for c in range(3):
        for x in range(light.shape[1]):
            # Self-luminous surfaces are as bright by night as by day.
            shines = kinds[y, x] & SHINING != 0
            bright = np.maximum(light[c, x], _ONE) if shines else light[c, x]
            light[c, x] = np.float32(rgb[c, y, x]) * bright


@part
def _wet(plate: Plate, line: RowBuffers, y: int) -> None:
    """Darken wet ground."""
    kinds, light, left = plate.kinds, line.light, plate.wet
    for c in range(3):
        for x in range(light.shape[1]):
            if kinds[y, x] & (GROUND | SHELTERED | SOFT) == GROUND:
                light[c, x] *= left


@part
def _find_veil(plate: Plate, line: RowBuffers, y: int) -> None:
    """Find the fraction of the light that the air lets through."""
    across, kinds, reach = plate.across, plate.kinds, plate.reach
    gate, veil = line.gate, line.veil
    rate, up = plate.air.rate, plate.upwards[y]
    is_inside = plate.portal.is_inside
    for x in range(veil.shape[0]):
        stretch = np.sqrt(_ONE + across[x] * across[x] + up * up)
        far = np.minimum(reach[y, x], HORIZON_M) * stretch
        veil[x] = far * rate
    if plate.portal.is_ahead:
        # Rain and snow obscure only what is outside.
        fog = plate.air.fog_rate
        for x in range(veil.shape[0]):
            stretch = np.sqrt(_ONE + across[x] * across[x] + up * up)
            near = np.minimum(reach[y, x], HORIZON_M)
            is_sheltered = kinds[y, x] & SHELTERED != 0
            wet = np.minimum(near, gate[x]) if is_sheltered else near
            if is_inside:
                wet = _ZERO if is_sheltered else np.maximum(near - gate[x], _ZERO)
            veil[x] = (near * fog + wet * (rate - fog)) * stretch
    for x in range(veil.shape[0]):
        veil[x] = fade(np.minimum(veil[x], OPAQUE))


@part
def _add_air(plate: Plate, line: RowBuffers, y: int) -> None:
    """Fade everything into the air, which the ego's beams light."""
    kinds, spread = plate.kinds, plate.beam_spread
    light, veil = line.light, line.veil
    back = plate.air.halo * plate.halo[y]
    is_inside = plate.portal.is_ahead and plate.portal.is_inside
    for c in range(3):
        outside = plate.air.colour[c]
        inside = outside * plate.portal.air if is_inside else outside
        for x in range(veil.shape[0]):
            air = (inside if kinds[y, x] & SHELTERED else outside) + back * spread[1, x]
            light[c, x] = air + (light[c, x] - air) * veil[x]


@part
def _add_sky(plate: Plate, line: RowBuffers, y: int) -> None:
    """Paint the sky and its clouds, in part behind silhouettes."""
    sky, clear_sky, light = plate.sky, plate.clear_sky, line.light
    rows, columns = plate.cloud_rows, plate.cloud_columns
    cover, sheet, clouds = plate.clouds, plate.clouds.sheet, line.clouds
    is_sky = False
    for x in range(light.shape[1]):
        is_sky |= sky[y, x] > 0
    if not is_sky:
        return
    through = plate.air.sky_through
    low, between = np.int64(rows[y, 0]), rows[y, 1]
    for x in range(sheet.shape[1]):
        clouds[x] = sheet[low, x] + (sheet[low + 1, x] - sheet[low, x]) * between
    for x in range(light.shape[1]):
        if sky[y, x] == 0:
            continue
        turn = columns[x]
        i = np.uint64(np.int32(turn))
        cloud = clouds[i] + (clouds[i + np.uint64(1)] - clouds[i]) * (
            turn - np.float32(np.int32(turn))
        )
        share = cloud_share(cloud, cover.edge, cover.floor)
        grey = (cloud * CLOUD_GAIN + cover.shade) * cover.bright
        glow = plate.air.halo * plate.halo[y] * plate.beam_spread[1, x]
        behind = np.float32(sky[y, x]) * TINY
        for c in range(3):
            tinted = grey * CLOUD_TINT[c]
            colour = clear_sky[y, c] + (tinted - clear_sky[y, c]) * share
            if through < _ONE:
                air = plate.air.colour[c] + glow
                colour = air + (colour - air) * through
            if sky[y, x] == np.uint8(255):
                light[c, x] = colour
            else:
                light[c, x] += (colour - light[c, x]) * behind


@part
def _add_grain(plate: Plate, line: RowBuffers, y: int) -> None:
    """Add the noise of a camera in the dark."""
    light = line.light
    width = light.shape[1]
    first = np.uint32(y * width) + plate.noise
    for x in range(width):
        speck = grain(first + np.uint32(x))
        for c in range(3):
            light[c, x] += speck


@part
def _store(line: RowBuffers, image: U8, y: int) -> None:
    """Round a row into the picture."""
    light, top = line.light, np.float32(255.0)
    for x in range(light.shape[1]):
        for c in range(3):
            image[y, x, c] = np.uint8(np.minimum(np.maximum(light[c, x] + _HALF, _ZERO), top))
