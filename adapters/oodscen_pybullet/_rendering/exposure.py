"""The exposure of a raw picture: the plate that says in what light and weather its pixels are seen."""

from collections.abc import Sequence

import numpy as np

from oodscen._seeding import stream
from oodscen.data._scene import Weather
from oodscen.driving._sight.visibility import extinction
from oodscen.numerics._kernels import is_compiled
from oodscen_pybullet._lighting.lamps import camera_row, ground_light
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shadows import CELLS, FAR_CELLS, FAR_SIDE_M, SIDE_M, Shade
from oodscen_pybullet._lighting.shelter import Portal
from oodscen_pybullet._rendering.optics import OPAQUE, fade
from oodscen_pybullet._rendering.plate import Air, Clouds, Daylight, Plate, PortalPlane, ShadowMaps
from oodscen_pybullet._rendering.sky import (
    SKY_M,
    clear_sky,
    cloud_columns,
    cloud_cover,
    cloud_rows,
    cloud_sheet,
)
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.triangles import GROUND
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32, U8

_WET = 0.62
"""Brightness of wet asphalt relative to dry."""
_SPREADS = (0.42, 0.75)
"""Slopes to the side at which the ego's beams have fallen to 1 / e: on surfaces, and in the air."""
_HALO, _HALO_M = 104.0, 30.0
"""Brightness of thick fog in front of the ego's lamps, and the length at which fog of extinction 1 / length is thick, m."""
_HALO_BELOW, _HALO_HEIGHT = np.float32(0.06), np.float32(1.0 / 0.3)
"""Slope below the horizon up to which the halo is full, and 1 / the slope above that at which it is half."""
_HIGHEST = 8.0
"""Height above the halo, in units of that slope, from which the halo no longer falls."""
_BEAM = 1.15
"""Brightness of the ego's beams in the dark."""
_FULL_DAY, _HALO_ENDS, _GRAINY = 0.99, 0.6, 0.5
"""Daylight from which beams are not seen, above which fog has no halo, and below which pictures have grain."""
_GRAINS = 1 << 22
"""Places at which the sequence of grain may start."""
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
_TUNNEL = (1.03, 1.0, 0.93)
"""Colour of a tunnel's lamps."""
_DULL, _DULL_AT_NIGHT = 0.6, 0.15
"""Brightness of a tunnel to a camera adapted to daylight, which hardly sees into the dark, and its rise by night."""
_USED, _USED_AT_NIGHT = 1.06, 0.26
"""Brightness of a tunnel to a camera that has adapted to it, and its fall by night."""
_BRIGHT_OUTSIDE, _HAZE_INSIDE = 0.4, 0.55
"""Daylight above which the air in a tunnel is darker than that outside, and its brightness relative to it."""
_ONE = np.float32(1.0)
_NO_GRID = np.zeros((1, 1, 3), np.float32)
_NO_MAP = np.zeros((1, 1), np.float32)
_NO_SHADOWS = ShadowMaps(_NO_MAP, _NO_MAP, _NO_MAP)
_NO_PORTAL = PortalPlane(np.zeros(3, np.float32))


def expose(picture: RawPicture, rate: float, air: Sequence[float]) -> Plate:
    """Return the plate of a raw picture.

    Args:
        picture: The picture, and all that is around it.
        rate: Extinction of the air, 1/m.
        air: Colour of the air, 0 to 255.
    """
    view, light, weather, shot = picture.view, picture.light, picture.weather, picture.shot
    across, upwards = view.slopes()
    axes = (view.right, view.up, view.forward)
    grid = ground_light(view, picture.lamps, light) if is_compiled() else None
    has_grain = light.daylight < _GRAINY
    return Plate(
        rgb=np.ascontiguousarray(np.moveaxis(shot.rgb, 2, 0)),
        depth=shot.depth,
        reach=shot.reach,
        lit=shot.lit,
        kinds=_kinds(picture),
        sky=shot.sky,
        across=across,
        upwards=upwards,
        axes=np.array(axes, np.float32),
        eye_height=np.float32(view.eye[2] - picture.road_height),
        air=_air(picture, rate, air),
        daylight=_daylight(light, has_shadows=shot.shade is not None),
        shadow=_shadow_map(view, light, shot.shade) if shot.shade else _NO_SHADOWS,
        clouds=_clouds(cloud_cover(weather), light.daylight, cloud_sheet(picture.seed)),
        portal=_portal_plane(picture.portal, light.daylight) if picture.portal else _NO_PORTAL,
        beam=_beam(view, light),
        beam_spread=np.stack([_beam_spread(across, slope) for slope in _SPREADS]),
        halo=_halo(upwards),
        clear_sky=clear_sky(view, weather, light),
        cloud_rows=cloud_rows(view),
        cloud_columns=cloud_columns(view),
        level=np.array([view.level(x, y) for x, y, _ in axes], np.float32),
        has_grid=grid is not None,
        grid=_NO_GRID if grid is None else grid,
        grid_row=np.float32(camera_row(view)),
        wet=np.float32(_WET if weather.precipitation == "rain" else 0.0),
        has_grain=has_grain,
        noise=np.uint32(_noise(picture) if has_grain else 0),
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


def _air(picture: RawPicture, rate: float, colour: Sequence[float]) -> Air:
    """Return the air, lit by the ego's beams in the dark."""
    daylight, halo, through = picture.light.daylight, 0.0, _ONE
    if daylight <= _HALO_ENDS and rate > 0.0 and picture.view.is_lit:
        halo = _HALO * (1.0 - daylight) * min(1.0, rate * _HALO_M)
    if rate > 0.0:
        through = np.float32(fade(np.float32(min(rate * SKY_M, float(OPAQUE)))))
    return Air(
        rate=np.float32(rate),
        fog_rate=np.float32(_fog_rate(picture.weather)),
        colour=np.array(colour, np.float32),
        halo=np.float32(halo),
        sky_through=through,
    )


def _fog_rate(weather: Weather) -> float:
    """Return the extinction by fog alone, 1/m."""
    return extinction(weather.model_copy(update={"precipitation": "none"}))


def _daylight(light: Light, *, has_shadows: bool) -> Daylight:
    """Return the colours of daylight and of shade."""
    is_full = light.daylight >= _FULL_DAY
    level = 1.0 if is_full else light.daylight
    direct = np.array([tint * level for tint in light.tint], np.float32)
    colour = light.shadow_tint if has_shadows else light.tint
    shade = [direct[e] / light.tint[e] * colour[e] for e in range(3)]
    return Daylight(direct, np.array(shade, np.float32), light.darkness())


def _beam(view: CameraView, light: Light) -> np.float32:
    """Return the brightness of the ego's beams."""
    is_seen = view.is_lit and light.daylight < _FULL_DAY
    return np.float32(_BEAM * (1.0 - light.daylight) if is_seen else 0.0)


def _shadow_map(view: CameraView, light: Light, shade: Shade) -> ShadowMaps:
    """Return the fine and the coarse shadow map, and the camera's place in them."""
    eye, z = view.eye, view.eye[2] - shade.level
    near, far = CELLS / SIDE_M, FAR_CELLS / FAR_SIDE_M
    x, y = (eye[axis] - shade.lean[axis] * z for axis in range(2))
    darkness = float(light.darkness()[round(255 * light.sun[2])])
    return ShadowMaps(
        is_cast=True,
        x=np.float32((x - shade.corner[0]) * near),
        y=np.float32((y - shade.corner[1]) * near),
        z=np.float32(z),
        scale=np.float32(near),
        far_x=np.float32((x - shade.far_corner[0]) * far),
        far_y=np.float32((y - shade.far_corner[1]) * far),
        far_scale=np.float32(far),
        lean_x=np.float32(shade.lean[0]),
        lean_y=np.float32(shade.lean[1]),
        sun_gain=np.float32(1.0 / max(darkness, _LEAST_DARKNESS)),
        heights=shade.heights,
        tiles=shade.tiles,
        far_heights=shade.far,
    )


def _clouds(cover: float, daylight: float, sheet: F32) -> Clouds:
    """Return the clouds that cover a share of the sky."""
    begins = 1.0 - _CLOUD_REACH * cover - _CLOUD_SOFTNESS
    return Clouds(
        edge=np.float32(begins if cover > _CLOUDY else _NO_CLOUDS),
        floor=np.float32(max(0.0, (cover - _OVERCAST) / (1.0 - _OVERCAST))),
        shade=np.float32(_CLOUD_SHADE - _CLOUD_GLOOM * cover),
        bright=np.float32(_CLOUD_WHITE * (_CLOUD_NIGHT + (1.0 - _CLOUD_NIGHT) * daylight)),
        sheet=sheet,
    )


def _portal_plane(portal: Portal, daylight: float) -> PortalPlane:
    """Return the end of a tunnel, whose lamps look the brighter the more the camera has adapted to them."""
    dark = 1.0 - daylight
    dull, used = _DULL + _DULL_AT_NIGHT * dark, _USED - _USED_AT_NIGHT * dark
    bright = dull + (used - dull) * portal.adaptation
    right, up, forward = (np.float32(part) for part in portal.normal)
    return PortalPlane(
        is_ahead=True,
        is_inside=portal.is_inside,
        distance=np.float32(portal.distance),
        right=right,
        up=up,
        forward=forward,
        lamps=np.array([bright * part for part in _TUNNEL], np.float32),
        air=np.float32(_HAZE_INSIDE) if daylight > _BRIGHT_OUTSIDE else _ONE,
    )


def _beam_spread(across: F32, slope: float) -> F32:
    """Return the lateral falloff of the ego's beams, [width]."""
    aside = across * np.float32(1.0 / slope)
    return np.asarray(fade(np.minimum(aside * aside, OPAQUE)), np.float32)


def _halo(upwards: F32) -> F32:
    """Return the brightness of the air in front of the ego's lamps by row, [height]."""
    high = np.clip((upwards + _HALO_BELOW) * _HALO_HEIGHT, 0.0, _HIGHEST)
    return np.asarray(_ONE / (_ONE + high * high), np.float32)


def _noise(picture: RawPicture) -> int:
    """Return the start of the sequence of grain, another one in every picture."""
    return int(stream(picture.seed, "grain", round(picture.time, 3)).integers(_GRAINS))
