"""The kernel that turns raw colours into a camera's picture in one pass over the rows.

It applies shadows, wetness, lamps, fog, sky and grain in scalar arithmetic on 32-bit numbers, so
the bits do not depend on the processor. Functions written with `np.minimum` and the like accept
both scalars and arrays: `postprocess_arrays` does the same without numba.
"""

from typing import Any, NamedTuple

import numpy as np

from oodscen.numerics._kernels import Kernel, inlined, part
from oodscen_pybullet._rendering.triangles import GROUND, SHELTERED, SHINING, SOFT
from oodscen_pybullet._types import F32, U8

GRID_AHEAD, GRID_ASIDE, GRID_CELL = 192, 160, 0.5
"""Cells ahead of and across the camera in which lamps light the ground, and their size, m."""
SETTINGS = 56
(
    RATE, AIR_R, AIR_G, AIR_B, SKY_THROUGH, EYE_HEIGHT, DAY_R, DAY_G, DAY_B, BEAM, HAS_SHADOW,
    SHADOW_X, SHADOW_Y, SHADOW_Z, SHADOW_SCALE, LEAN_X, LEAN_Y, WET, HALO, GRAIN, CLOUD_EDGE,
    CLOUD_FLOOR, CLOUD_SHADE, CLOUD_BRIGHT, HAS_GRID, NOISE, SHADE_R, SHADE_G, SHADE_B, SUN_GAIN,
    FAR_X, FAR_Y, FAR_SCALE, FOG_RATE, HAS_PORTAL, IS_INSIDE, PORTAL, PORTAL_RIGHT, PORTAL_UP,
    PORTAL_AHEAD, TUNNEL_R, TUNNEL_G, TUNNEL_B, AIR_INSIDE,
) = range(44)  # fmt: skip
"""Indices in the settings of `postprocess_pixels`."""
_ONE, _HALF, _ZERO = np.float32(1.0), np.float32(0.5), np.float32(0.0)
TINT_G, TINT_B = np.float32(0.97), np.float32(0.88)
"""Green and blue of the ego's beams, relative to red."""
CLOUD_TINT = (np.float32(0.971), np.float32(0.984), _ONE)
"""Colour of clouds."""
FARTHEST = np.float32(400.0)
"""Distance beyond which lamps are alike, m."""
SHADOWS_END = np.float32(78.0)
"""Distance beyond which only the coarse shadow map is used, m."""
HORIZON = np.float32(1e6)
"""Distance that stands for none: of the sky, and of a portal that is not ahead, m."""
OPAQUE = np.float32(40.0)
"""Optical depth beyond which nothing is seen; the limit of `fade`."""
CLOUD_GAIN = np.float32(0.22)
"""Growth of a cloud's brightness with its density."""
_BEAM_HALVED = np.float32(1.0 / 36.0)
"""1 / distance at which the ego's beams are half as bright, 1/m."""
_CUT_OFF, _CUT_SOFT, _CUT_SPREAD = np.float32(0.9), np.float32(0.25), np.float32(0.03)
"""Height of the beams' cut-off, m; the width of its edge, m, and its growth per metre of distance."""
_STRAY, _BELOW = np.float32(0.42), np.float32(0.58)
"""Fractions of the beams that reach above their cut-off, and only below it."""
_LEVEL_BIAS, _FAR_BIAS = np.float32(0.03), np.float32(0.001)
"""Height by which a surface must be in shadow, m, and its growth per metre of distance."""
_UPRIGHT_BIAS, _SLANT_BIAS = np.float32(0.05), np.float32(0.25)
"""The same in addition for objects, m, and at a grazing sun."""
_COARSE_BIAS = np.float32(0.3)
"""The same in addition on the coarse shadow map, m."""
_ENTERS = np.float32(1.0 / 7.0)
"""1 / distance at which the daylight in a tunnel has halved, 1/m."""
_GRAIN = 4
"""Largest grain, of 255."""
TINY = np.float32(1.0 / 255.0)
"""One step of a byte as a fraction."""


@inlined
def fade(optical_depth: Any) -> Any:
    """Return exp(-x) for 0 <= x <= 40, accurate to about 0.1 % where it matters."""
    y = optical_depth * np.float32(1.0 / 16.0)
    grown = _ONE + y * (
        _ONE + y * (_HALF + y * (np.float32(1.0 / 6.0) + y * np.float32(1.0 / 24.0)))
    )
    two = grown * grown
    four = two * two
    eight = four * four
    return _ONE / (eight * eight)


@part
def lit_share(heights: Any, u: Any, v: Any, z: Any) -> Any:
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


@inlined
def beam(near: Any, height: Any, spread: Any, strength: Any) -> Any:
    """Return the ego's low-beam light on a surface; the beams have a soft cut-off in height."""
    reach = near * _BEAM_HALVED
    cut = (_CUT_OFF - height) / (_CUT_SOFT + near * _CUT_SPREAD)
    cut = np.minimum(np.maximum(cut, _ZERO), _ONE)
    return strength * spread / (_ONE + reach * reach) * (_STRAY + _BELOW * cut)


@inlined
def cloud_share(cloud: Any, edge: Any, floor: Any) -> Any:
    """Return the fraction of the blue sky hidden by a cloud of some density."""
    share = (cloud - edge) * np.float32(3.2)
    return np.maximum(np.minimum(np.maximum(share, _ZERO), _ONE), floor)


@inlined
def grain(number: Any) -> Any:
    """Return noise between -4 and 4 from a pixel's index; uint32 in."""
    # numba multiplies in 64 bits, NumPy in 32.
    mixed = np.uint32(number * np.uint32(2654435761))
    mixed = np.uint32((mixed ^ (mixed >> np.uint32(15))) * np.uint32(2246822519))
    mixed = np.uint32(mixed ^ (mixed >> np.uint32(13)))
    return np.float32(mixed % np.uint32(2 * _GRAIN + 1)) - np.float32(_GRAIN)


class Plate(NamedTuple):
    """The inputs of the postprocessing of a picture."""

    rgb: U8
    """[3, height, width] raw colours."""
    depth: F32
    """[height, width] m, at the pixels' centres."""
    reach: F32
    """[height, width] mean depth of the part that is not sky."""
    lit: U8
    """[height, width] incidence of the sun on the surface, 0 (grazing) to 255 (perpendicular)."""
    kinds: U8
    """[height, width] surface flags, `triangles.SHINING` and so on."""
    sky: U8
    """[height, width] fraction of sky, 0 to 255."""
    settings: F32
    """[SETTINGS], see the names above."""
    across: F32
    """[width] x / depth."""
    upwards: F32
    """[height] y / depth."""
    axes: F32
    """[3, 3] the camera's right, up and forward."""
    dark: F32
    """[256] the sun's fraction of the light, by `lit`."""
    spread: F32
    """[3, width] lateral falloff of the ego's beams on objects, and in the air; column of `sheet`."""
    halo: F32
    """[height] brightness of the ego's beams in the air."""
    heaven: F32
    """[height, 5] colour of the clear sky, row of the cloud sheet and weight of the next row."""
    sheet: F32
    """[n, m] density of clouds by height and heading, one column more than a full turn."""
    grid: F32
    """[GRID_AHEAD, GRID_ASIDE, 3] light of other lamps on the ground."""
    heights: F32
    """Heights of the shadow map."""
    tiles: F32
    """Tiles of the shadow map."""
    far_heights: F32
    """Heights of the coarse shadow map."""


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
    settings, width = plate.settings, plate.depth.shape[1]
    rows, clouds = np.empty((5, width), np.float32), np.empty(plate.sheet.shape[1], np.float32)
    light = np.empty((3, width), np.float32)
    line = RowBuffers(rows[0], rows[1], rows[2], rows[3], light, rows[4], clouds)
    line.sunny[:] = _ONE
    line.indoors[:] = _ZERO
    has_portal = settings[HAS_PORTAL] > _ZERO
    for y in range(first, end):
        for x in range(width):
            line.clear[x] = _ONE
        if settings[HAS_SHADOW] > _ZERO:
            _find_shadows(plate, line, y)
        if has_portal:
            _find_tunnel(plate, line, y)
        _add_daylight(plate, line)
        if settings[BEAM] > _ZERO:
            _add_beams(plate, line, y)
        if settings[HAS_GRID] > _ZERO:
            _add_lamps(plate, line, y)
        if has_portal:
            _add_tunnel_lamps(plate, line)
        _colour(plate, line, y)
        if settings[WET] > _ZERO:
            _wet(plate, line, y)
        if settings[RATE] > _ZERO:
            _find_veil(plate, line, y)
            _add_air(plate, line, y)
        _add_sky(plate, line, y)
        if settings[GRAIN] > _ZERO:
            _add_grain(plate, line, y)
        _store(line, image, y)


@part
def _near_light(tiles: Any, heights: Any, u: Any, v: Any, z: Any) -> Any:
    """Return the fraction of sunlight that reaches a point of the shadow map near the camera."""
    i, j = np.uint64(np.int32(u)), np.uint64(np.int32(v))
    if tiles[j >> np.uint64(4), i >> np.uint64(4)] > z:
        return lit_share(heights, u, v, z)
    return _ONE


@part
def _far_light(heights: Any, u: Any, v: Any, z: Any) -> Any:
    """Return the fraction of sunlight that reaches a point by the coarse shadow map."""
    cells = np.float32(heights.shape[0] - 1)
    if _ZERO <= u < cells and _ZERO <= v < cells:
        return lit_share(heights, u, v, z + _COARSE_BIAS)
    return _ONE


@part
def _find_shadows(plate: Plate, line: RowBuffers, y: int) -> None:
    """Look up which pixels of a row are in the sun, and how bright those in shadow are."""
    settings, axes, across, dark = plate.settings, plate.axes, plate.across, plate.dark
    depth, lit, kinds = plate.depth, plate.lit, plate.kinds
    heights, tiles, far_heights = plate.heights, plate.tiles, plate.far_heights
    clear, sunny = line.clear, line.sunny
    is_inside = settings[IS_INSIDE] > _ZERO
    cells = np.float32(heights.shape[0] - 1)
    scale = settings[SHADOW_SCALE]
    far_share = settings[FAR_SCALE] / scale
    right_x = (axes[0, 0] - settings[LEAN_X] * axes[0, 2]) * scale
    right_y = (axes[0, 1] - settings[LEAN_Y] * axes[0, 2]) * scale
    up = plate.upwards[y]
    rise = up * axes[1, 2] + axes[2, 2]
    step_x = (axes[2, 0] + up * axes[1, 0] - settings[LEAN_X] * rise) * scale
    step_y = (axes[2, 1] + up * axes[1, 1] - settings[LEAN_Y] * rise) * scale
    for x in range(across.shape[0]):
        kind = kinds[y, x]
        is_sheltered = kind & SHELTERED != 0
        sunny[x] = _ZERO
        if lit[y, x] == 0 or kind & SHINING or (is_sheltered and not is_inside):
            continue
        far = depth[y, x]
        z = settings[SHADOW_Z] + far * rise + _LEVEL_BIAS + far * _FAR_BIAS
        if not kind & GROUND:
            # Objects have faces at all angles and therefore need a larger tolerance.
            slant = _ONE - np.float32(lit[y, x]) * TINY
            z += _UPRIGHT_BIAS + _SLANT_BIAS * slant
        aside, along = step_x + across[x] * right_x, step_y + across[x] * right_y
        u, v = settings[SHADOW_X] + far * aside, settings[SHADOW_Y] + far * along
        edge = np.minimum(np.minimum(u, cells - u), np.minimum(v, cells - v))
        share = np.minimum(SHADOWS_END - far, edge * np.float32(0.25))
        share = np.minimum(share * np.float32(0.07), _ONE)
        sun = _ONE
        if share > _ZERO:
            sun = _near_light(tiles, heights, u, v, z)
        else:
            share = _ZERO
        if share < _ONE:
            u = settings[FAR_X] + far * aside * far_share
            v = settings[FAR_Y] + far * along * far_share
            wide = _far_light(far_heights, u, v, z)
            sun = wide + (sun - wide) * share
        loss = _HALF if is_sheltered else dark[lit[y, x]]
        clear[x] = _ONE - loss * (_ONE - sun)
        sunny[x] = np.minimum(sun * loss * settings[SUN_GAIN], _ONE)


@part
def _find_tunnel(plate: Plate, line: RowBuffers, y: int) -> None:
    """Find the distance of the portal in each pixel, and how far daylight enters."""
    settings, across, kinds, reach = plate.settings, plate.across, plate.kinds, plate.reach
    clear, sunny, indoors, gate = line.clear, line.sunny, line.indoors, line.gate
    up = plate.upwards[y]
    for x in range(across.shape[0]):
        towards = (
            settings[PORTAL_AHEAD] + up * settings[PORTAL_UP] + across[x] * settings[PORTAL_RIGHT]
        )
        gate[x] = HORIZON
        if towards > np.float32(1e-4):
            gate[x] = settings[PORTAL] / towards
        indoors[x] = _ZERO
        if kinds[y, x] & SHELTERED:
            # Daylight enters for some metres.
            way = np.minimum(reach[y, x], FARTHEST) * towards - settings[PORTAL]
            way = way * _ENTERS
            indoors[x] = clear[x]
            clear[x] = clear[x] / (_ONE + way * way)
            sunny[x] = _ZERO


@part
def _add_daylight(plate: Plate, line: RowBuffers) -> None:
    """Start a row with the light of the sun and the sky."""
    settings, clear, sunny, light = plate.settings, line.clear, line.sunny, line.light
    for c in range(3):
        shade = settings[SHADE_R + c]
        gain = settings[DAY_R + c] - shade
        for x in range(clear.shape[0]):
            light[c, x] = (shade + gain * sunny[x]) * clear[x]


@part
def _add_beams(plate: Plate, line: RowBuffers, y: int) -> None:
    """Add the ego's low beams."""
    settings, axes, spread = plate.settings, plate.axes, plate.spread
    kinds, reach = plate.kinds, plate.reach
    light = line.light
    rise = plate.upwards[y] * axes[1, 2] + axes[2, 2]
    for x in range(light.shape[1]):
        near = np.minimum(reach[y, x], FARTHEST)
        is_ground = kinds[y, x] & (GROUND | SOFT) == GROUND
        aloft = _ZERO if is_ground else settings[EYE_HEIGHT] + near * rise
        bright = beam(near, aloft, spread[0, x], settings[BEAM])
        light[0, x] += bright
        light[1, x] += bright * TINT_G
        light[2, x] += bright * TINT_B


@part
def _add_lamps(plate: Plate, line: RowBuffers, y: int) -> None:
    """Add the light of other lamps."""
    settings, axes, across, grid = plate.settings, plate.axes, plate.across, plate.grid
    kinds, reach = plate.kinds, plate.reach
    light = line.light
    rise = plate.upwards[y] * axes[1, 2] + axes[2, 2]
    one = np.uint64(1)
    for x in range(light.shape[1]):
        near = np.minimum(reach[y, x], FARTHEST)
        u = near * np.float32(1.0 / GRID_CELL)
        v = near * across[x] * np.float32(1.0 / GRID_CELL) + np.float32(GRID_ASIDE / 2)
        if not (u < np.float32(GRID_AHEAD - 1) and _ZERO <= v < np.float32(GRID_ASIDE - 1)):
            continue
        i, j = np.uint64(np.int32(u)), np.uint64(np.int32(v))
        fu, fv = u - np.float32(np.int32(u)), v - np.float32(np.int32(v))
        aloft = np.maximum(settings[EYE_HEIGHT] + near * rise, _ZERO) * np.float32(0.2)
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
        bright = plate.settings[TUNNEL_R + c]
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
    kinds, light, left = plate.kinds, line.light, plate.settings[WET]
    for c in range(3):
        for x in range(light.shape[1]):
            if kinds[y, x] & (GROUND | SHELTERED | SOFT) == GROUND:
                light[c, x] *= left


@part
def _find_veil(plate: Plate, line: RowBuffers, y: int) -> None:
    """Find the fraction of the light that the air lets through."""
    settings, across, kinds, reach = plate.settings, plate.across, plate.kinds, plate.reach
    gate, veil = line.gate, line.veil
    rate, up = settings[RATE], plate.upwards[y]
    is_inside = settings[IS_INSIDE] > _ZERO
    for x in range(veil.shape[0]):
        stretch = np.sqrt(_ONE + across[x] * across[x] + up * up)
        far = np.minimum(reach[y, x], HORIZON) * stretch
        veil[x] = far * rate
    if settings[HAS_PORTAL] > _ZERO:
        # Rain and snow obscure only what is outside.
        fog = settings[FOG_RATE]
        for x in range(veil.shape[0]):
            stretch = np.sqrt(_ONE + across[x] * across[x] + up * up)
            near = np.minimum(reach[y, x], HORIZON)
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
    settings, kinds, spread = plate.settings, plate.kinds, plate.spread
    light, veil = line.light, line.veil
    back = settings[HALO] * plate.halo[y]
    is_inside = settings[HAS_PORTAL] > _ZERO and settings[IS_INSIDE] > _ZERO
    for c in range(3):
        outside = settings[AIR_R + c]
        inside = outside * settings[AIR_INSIDE] if is_inside else outside
        for x in range(veil.shape[0]):
            air = (inside if kinds[y, x] & SHELTERED else outside) + back * spread[1, x]
            light[c, x] = air + (light[c, x] - air) * veil[x]


@part
def _add_sky(plate: Plate, line: RowBuffers, y: int) -> None:
    """Paint the sky and its clouds, in part behind silhouettes."""
    settings, spread, sky = plate.settings, plate.spread, plate.sky
    heaven, sheet, clouds = plate.heaven, plate.sheet, line.clouds
    light = line.light
    is_sky = False
    for x in range(light.shape[1]):
        is_sky |= sky[y, x] > 0
    if not is_sky:
        return
    through = settings[SKY_THROUGH]
    low, between = np.int64(heaven[y, 3]), heaven[y, 4]
    for x in range(sheet.shape[1]):
        clouds[x] = sheet[low, x] + (sheet[low + 1, x] - sheet[low, x]) * between
    for x in range(light.shape[1]):
        if sky[y, x] == 0:
            continue
        turn = spread[2, x]
        i = np.uint64(np.int32(turn))
        cloud = clouds[i] + (clouds[i + np.uint64(1)] - clouds[i]) * (
            turn - np.float32(np.int32(turn))
        )
        share = cloud_share(cloud, settings[CLOUD_EDGE], settings[CLOUD_FLOOR])
        grey = (cloud * CLOUD_GAIN + settings[CLOUD_SHADE]) * settings[CLOUD_BRIGHT]
        glow = settings[HALO] * plate.halo[y] * spread[1, x]
        behind = np.float32(sky[y, x]) * TINY
        for c in range(3):
            tinted = grey * CLOUD_TINT[c]
            colour = heaven[y, c] + (tinted - heaven[y, c]) * share
            if through < _ONE:
                air = settings[AIR_R + c] + glow
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
    first = np.uint32(y * width) + np.uint32(plate.settings[NOISE])
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
