"""The exposure of a raw picture: the plate that says in what light and weather its pixels are seen."""

from collections.abc import Sequence

import numpy as np

from oodscen._seeding import stream
from oodscen.data._weather import Weather
from oodscen.driving._sight.weather import extinction
from oodscen.numerics._kernels import is_compiled
from oodscen_pybullet._lighting.lamps import camera_row, ground_light
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shadows import CELLS, FAR_CELLS, FAR_SIDE_M, SIDE_M, Shade
from oodscen_pybullet._lighting.shelter import Portal
from oodscen_pybullet._rendering.clouds import cloud_columns, cloud_rows, clouds
from oodscen_pybullet._rendering.headlamps import FULL_DAY, beam, beam_spreads, halo, halo_rows
from oodscen_pybullet._rendering.optics import OPAQUE, fade
from oodscen_pybullet._rendering.plate import Air, Daylight, Plate, PortalPlane, ShadowMaps
from oodscen_pybullet._rendering.sky import SKY_M, clear_sky
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.triangles import GROUND
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import U8

_WET = 0.62
"""Brightness of wet asphalt relative to dry."""
_GRAINY = 0.5
"""Daylight below which pictures have grain."""
_GRAINS = 1 << 22
"""Places at which the sequence of grain may start."""
_LEAST_DARKNESS = 0.05
"""Least darkness of a shadow on level ground by which the sun's gain is computed."""
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
        clouds=clouds(weather, light, picture.seed),
        portal=_portal_plane(picture.portal, light.daylight) if picture.portal else _NO_PORTAL,
        beam=beam(view, light),
        beam_spread=beam_spreads(across),
        halo=halo_rows(upwards),
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
    near = np.minimum(shot.reach, _SURFACES_END_M)
    height = np.float32(view.eye[2] - picture.road_height) + near * view.rises()[:, None]
    is_low = height < _LOW_M + near * _LOW_SLOPE
    return np.where((shot.rows < 0) & is_low, np.uint8(GROUND), np.uint8(0))


def _air(picture: RawPicture, rate: float, colour: Sequence[float]) -> Air:
    """Return the air, lit by the ego's beams in the dark."""
    through = _ONE
    if rate > 0.0:
        through = np.float32(fade(np.float32(min(rate * SKY_M, float(OPAQUE)))))
    return Air(
        rate=np.float32(rate),
        fog_rate=np.float32(_fog_rate(picture.weather)),
        colour=np.array(colour, np.float32),
        halo=halo(picture.view, picture.light, rate),
        sky_through=through,
    )


def _fog_rate(weather: Weather) -> float:
    """Return the extinction by fog alone, 1/m."""
    return extinction(weather.model_copy(update={"precipitation": "none"}))


def _daylight(light: Light, *, has_shadows: bool) -> Daylight:
    """Return the colours of daylight and of shade."""
    is_full = light.daylight >= FULL_DAY
    level = 1.0 if is_full else light.daylight
    direct = np.array([tint * level for tint in light.tint], np.float32)
    colour = light.shadow_tint if has_shadows else light.tint
    shade = [direct[e] / light.tint[e] * colour[e] for e in range(3)]
    return Daylight(direct, np.array(shade, np.float32), light.darkness())


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


def _noise(picture: RawPicture) -> int:
    """Return the start of the sequence of grain, another one in every picture."""
    return int(stream(picture.seed, "grain", round(picture.time, 3)).integers(_GRAINS))
