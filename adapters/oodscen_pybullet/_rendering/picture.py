"""Development of a raw shot into the picture that a camera would record."""

from collections.abc import Sequence
from itertools import pairwise
from threading import Thread

import numpy as np

from oodscen._seeding import stream
from oodscen.driving._sight.visibility import extinction
from oodscen.numerics._kernels import is_compiled
from oodscen_pybullet._lighting.glows import add_glare, add_glows
from oodscen_pybullet._lighting.lamps import ground_light
from oodscen_pybullet._lighting.reflections import add_reflections
from oodscen_pybullet._lighting.shadows import CELLS, FAR_CELLS, FAR_SIDE_M, SIDE_M, Shade
from oodscen_pybullet._rendering import postprocess as d
from oodscen_pybullet._rendering.particles import add_puffs
from oodscen_pybullet._rendering.postprocess_arrays import postprocess_arrays
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.triangles import GROUND, MIRROR
from oodscen_pybullet._rendering.weather import (
    SKY_M,
    add_rain,
    add_snow,
    air_colour,
    cloud_columns,
    cloud_cover,
    cloud_sheet,
    heaven,
)
from oodscen_pybullet._types import F32, U8

_WET = 0.62
"""Brightness of wet asphalt relative to dry."""
_MIRRORING = 0.62
"""Reflectivity of wet asphalt at grazing angles."""
_MIRRORED_LAMPS = 5.0
"""Gain of lamps mirrored in the dark, relative to their pixels; from half of daylight on there is none."""
_SPREADS = (0.42, 0.75)
"""Slopes to the side at which the ego's beams have fallen to 1 / e: on surfaces, and in the air."""
_HALO, _HALO_M = 104.0, 30.0
"""Brightness of thick fog in front of the ego's lamps, and the length at which fog of extinction 1 / length is thick, m."""
_HALO_BELOW, _HALO_HEIGHT = np.float32(0.06), np.float32(1.0 / 0.3)
"""Slope below the horizon up to which the halo is full, and 1 / the slope above that at which it is half."""
_BEAM = 1.15
"""Brightness of the ego's beams in the dark."""
_FULL_DAY, _HALO_ENDS, _GRAINY = 0.99, 0.6, 0.5
"""Daylight from which beams are not seen, above which fog has no halo, and below which pictures have grain."""
_LEAST_DARKNESS = 0.05
"""Least darkness of a shadow on level ground by which the sun's gain is computed."""
_CLOUDY, _OVERCAST = 0.02, 0.75
"""Cover from which there are clouds, and from which they leave no clear sky."""
_CLOUD_REACH, _CLOUD_SOFTNESS = 0.9, 0.12
"""Fall of the density at which clouds begin from a clear sky to a covered one, and from there to their soft edges."""
_NO_CLOUDS = 9.0
"""Density at which clouds begin that none reaches."""
_CLOUD_SHADE, _CLOUD_GLOOM = 0.86, 0.12
"""Brightness of thin clouds, and its fall from a clear sky to a covered one."""
_CLOUD_WHITE, _CLOUD_NIGHT = 243.0, 0.06
"""Brightness of a white cloud by day, 0 to 255, and the share of it by night."""
_LOW_M, _LOW_SLOPE = np.float32(0.16), np.float32(0.02)
"""Height up to which a surface counts as ground, m, and its growth per metre of distance."""
_SURFACES_END_M = np.float32(400.0)
"""Distance at which the height of a farther surface is taken, m."""
_NO_GRID = np.zeros((1, 1, 3), np.float32)
_NO_SHADE = np.zeros((1, 1), np.float32)
_TUNNEL = (1.03, 1.0, 0.93)
"""Colour of a tunnel's lamps."""
_ADD_DROPS = {"rain": add_rain, "snow": add_snow}


def postprocessed(picture: RawPicture) -> U8:
    """Apply light and weather: [height, width, 3] uint8; depends only on the argument."""
    view, light, weather, shot = picture.view, picture.light, picture.weather, picture.shot
    rate, air = extinction(weather), air_colour(weather, light)
    plate = _plate(picture, rate, air)
    if is_compiled():
        image = np.empty((view.height, view.width, 3), np.uint8)
        _in_bands(plate, image, picture.threads)
    else:
        image = postprocess_arrays(plate)
    if picture.balls:
        add_puffs(image, picture, rate, air)
    add_glows(image, view, shot.depth, picture.lamps, light, rate)
    is_raining = weather.precipitation == "rain"
    if is_compiled() and (is_raining or (plate.kinds & MIRROR).any()):
        add_reflections(
            image,
            shot.depth,
            plate.kinds,
            np.float32(_MIRRORING if is_raining else 0.0),
            np.float32(_MIRRORED_LAMPS * max(1.0 - 2.0 * light.daylight, 0.0)),
            np.uint32(picture.seed % 2**20),
        )
    add_glare(image, view, light, shot.depth)
    if weather.precipitation != "none":
        _ADD_DROPS[weather.precipitation](image, picture, plate.kinds)
    return image


def _in_bands(plate: d.Plate, image: U8, threads: int) -> None:
    """Let each of some threads develop a band of the picture."""
    edges = [len(image) * band // threads for band in range(threads + 1)]
    bands = [(plate, image, first, end) for first, end in pairwise(edges)]
    others = [Thread(target=d.postprocess_pixels, args=band) for band in bands[1:]]
    for other in others:
        other.start()
    d.postprocess_pixels(*bands[0])
    for other in others:
        other.join()


def _plate(picture: RawPicture, rate: float, air: Sequence[float]) -> d.Plate:
    """Return the inputs of the kernel: extinction in 1/m and the air's colour are given."""
    view, light, shot = picture.view, picture.light, picture.shot
    across, upwards = view.slopes()
    spread = [*(_spread(across, slope) for slope in _SPREADS), cloud_columns(view)]
    settings, shade = _settings(picture, rate, air), shot.shade
    grid = ground_light(view, picture.lamps, light) if is_compiled() else None
    settings[d.HAS_GRID] = float(grid is not None)
    return d.Plate(
        rgb=np.ascontiguousarray(np.moveaxis(shot.rgb, 2, 0)),
        depth=shot.depth,
        reach=shot.reach,
        lit=shot.lit,
        kinds=_kinds(picture),
        sky=shot.sky,
        settings=settings,
        across=across,
        upwards=upwards,
        axes=np.array([view.right, view.up, view.forward], np.float32),
        dark=light.darkness(),
        spread=np.stack(spread).astype(np.float32),
        halo=_halo(upwards),
        heaven=heaven(view, picture.weather, light),
        sheet=cloud_sheet(picture.seed),
        grid=_NO_GRID if grid is None else grid,
        heights=_NO_SHADE if shade is None else shade.heights,
        tiles=_NO_SHADE if shade is None else shade.tiles,
        far_heights=_NO_SHADE if shade is None else shade.far,
    )


def _kinds(picture: RawPicture) -> U8:
    """Return the surface flags; where unknown, low surfaces count as ground."""
    shot, view = picture.shot, picture.view
    if shot.kinds is not None:
        return shot.kinds
    _, upwards = view.slopes()
    near = np.minimum(shot.reach, _SURFACES_END_M)
    rise = upwards * np.float32(view.up[2]) + np.float32(view.forward[2])
    height = np.float32(view.eye[2] - picture.road_height) + near * rise[:, None]
    is_low = height < _LOW_M + near * _LOW_SLOPE
    return np.where((shot.rows < 0) & is_low, np.uint8(GROUND), np.uint8(0))


def _settings(picture: RawPicture, rate: float, air: Sequence[float]) -> F32:
    """Return the numbers that `postprocess_pixels` needs."""
    view, light, weather = picture.view, picture.light, picture.weather
    values = np.zeros(d.SETTINGS, np.float32)
    values[d.RATE] = rate
    values[d.AIR_R : d.AIR_B + 1] = air
    thickness = np.float32(min(rate * SKY_M, float(d.OPAQUE)))
    values[d.SKY_THROUGH] = d.fade(thickness) if rate > 0.0 else 1.0
    values[d.EYE_HEIGHT] = view.eye[2] - picture.road_height
    values[d.WET] = _WET if weather.precipitation == "rain" else 0.0
    _set_light(values, picture)
    if picture.shot.shade is not None:
        _set_shadow(values, picture, picture.shot.shade)
    _set_portal(values, picture)
    if light.daylight <= _HALO_ENDS and rate > 0.0 and view.is_lit:
        values[d.HALO] = _HALO * (1.0 - light.daylight) * min(1.0, rate * _HALO_M)
    _set_clouds(values, cloud_cover(weather), light.daylight)
    if light.daylight < _GRAINY:
        values[d.GRAIN] = 1.0
        noise = stream(picture.seed, "grain", round(picture.time, 3))
        values[d.NOISE] = int(noise.integers(1 << 22))
    return values


def _set_light(values: F32, picture: RawPicture) -> None:
    """Add the colours of daylight and of shade, and the ego's beams."""
    light = picture.light
    values[d.DAY_R : d.DAY_B + 1] = [tint * light.daylight for tint in light.tint]
    if light.daylight >= _FULL_DAY:
        values[d.DAY_R : d.DAY_B + 1] = light.tint
    elif picture.view.is_lit:
        values[d.BEAM] = _BEAM * (1.0 - light.daylight)
    shade = light.shade if picture.shot.shade else light.tint
    values[d.SHADE_R : d.SHADE_B + 1] = [
        values[d.DAY_R + e] / light.tint[e] * shade[e] for e in range(3)
    ]


def _set_shadow(values: F32, picture: RawPicture, shade: Shade) -> None:
    """Add the places of the fine and the coarse shadow map."""
    eye, light = picture.view.eye, picture.light
    z = eye[2] - shade.level
    near, far = CELLS / SIDE_M, FAR_CELLS / FAR_SIDE_M
    values[d.HAS_SHADOW] = 1.0
    for axis in range(2):
        place = eye[axis] - shade.lean[axis] * z
        values[d.SHADOW_X + axis] = (place - shade.corner[axis]) * near
        values[d.FAR_X + axis] = (place - shade.far_corner[axis]) * far
    values[d.SHADOW_Z], values[d.SHADOW_SCALE], values[d.FAR_SCALE] = z, near, far
    values[d.LEAN_X], values[d.LEAN_Y] = shade.lean
    darkness = float(light.darkness()[round(255 * light.sun[2])])
    values[d.SUN_GAIN] = 1.0 / max(darkness, _LEAST_DARKNESS)


def _set_clouds(values: F32, cover: float, daylight: float) -> None:
    """Add the density at which clouds begin, the share of the sky they hide everywhere, and their brightness.

    Args:
        values: The settings, changed in place.
        cover: Share of the sky that clouds cover.
        daylight: 0 at night to 1.
    """
    begins = 1.0 - _CLOUD_REACH * cover - _CLOUD_SOFTNESS
    values[d.CLOUD_EDGE] = begins if cover > _CLOUDY else _NO_CLOUDS
    values[d.CLOUD_FLOOR] = max(0.0, (cover - _OVERCAST) / (1.0 - _OVERCAST))
    values[d.CLOUD_SHADE] = _CLOUD_SHADE - _CLOUD_GLOOM * cover
    values[d.CLOUD_BRIGHT] = _CLOUD_WHITE * (_CLOUD_NIGHT + (1.0 - _CLOUD_NIGHT) * daylight)


def _set_portal(values: F32, picture: RawPicture) -> None:
    """Add the numbers that `postprocess_pixels` needs for a tunnel ahead."""
    portal, weather, daylight = picture.portal, picture.weather, picture.light.daylight
    if portal is None:
        return
    values[d.HAS_PORTAL], values[d.IS_INSIDE] = 1.0, float(portal.is_inside)
    values[d.PORTAL] = portal.distance
    values[d.PORTAL_RIGHT : d.PORTAL_AHEAD + 1] = portal.normal
    values[d.FOG_RATE] = extinction(weather.model_copy(update={"precipitation": "none"}))
    # A camera adapted to daylight hardly sees into the dark.
    dull, used = 0.6 + 0.15 * (1.0 - daylight), 1.06 - 0.26 * (1.0 - daylight)
    bright = dull + (used - dull) * portal.deep
    values[d.TUNNEL_R : d.TUNNEL_B + 1] = [bright * part for part in _TUNNEL]
    values[d.AIR_INSIDE] = 0.55 if daylight > 0.4 else 1.0


def _spread(across: F32, slope: float) -> F32:
    """Return the lateral falloff of the ego's beams, [width]."""
    aside = across * np.float32(1.0 / slope)
    return np.asarray(d.fade(np.minimum(aside * aside, d.OPAQUE)), np.float32)


def _halo(upwards: F32) -> F32:
    """Return the brightness of the air in front of the ego's lamps by row, [height]."""
    high = np.clip((upwards + _HALO_BELOW) * _HALO_HEIGHT, 0.0, 8.0)
    return np.asarray(np.float32(1.0) / (np.float32(1.0) + high * high), np.float32)
