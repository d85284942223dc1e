"""From what the renderer saw to what a camera would have recorded."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen.scene import Weather
from oodscen.seeding import stream
from oodscen_pybullet.light import (
    Caster,
    Float,
    Glow,
    Light,
    add_glare,
    add_glows,
    illumination,
    line,
    shadow_mask,
    three,
)
from oodscen_pybullet.stage import Shot
from oodscen_pybullet.view import View
from oodscen_pybullet.weather import (
    SKY_M,
    Colour,
    air_colour,
    extinction,
    rain_streaks,
    sky,
    snow_flakes,
    veil,
    wet,
)

_OPAQUE = 8.0
"""Extinction times distance from which on nothing shows through the air."""


@dataclass(frozen=True, eq=False)
class Picture:
    """A raw picture and everything that decides how it is developed."""

    shot: Shot
    view: View
    weather: Weather
    light: Light
    casters: Sequence[Caster]
    glows: Sequence[Glow]
    time: float
    """Since the start, s; rain and snow differ from moment to moment."""
    seed: int
    road_height: float
    """Where the ground is below the camera, m."""


def develop(picture: Picture) -> NDArray[np.uint8]:
    """Apply light and weather: [height, width, 3] uint8; a function of its argument alone."""
    view, light, weather = picture.view, picture.light, picture.weather
    depth = picture.shot.reach
    image = picture.shot.rgb.astype(np.float32)
    across, upwards = view.slopes()
    stretch = np.sqrt(1.0 + across[None, :] ** 2 + upwards[:, None] ** 2).astype(np.float32)
    distance = depth * stretch
    rate, air = extinction(weather), air_colour(weather, light)
    ground = _ground(picture)
    _shade(image, picture, ground)
    if weather.precipitation == "rain":
        wet(
            image,
            ground,
            distance,
            (air[0] + 20.0, air[1] + 22.0, air[2] + 26.0) if light.daylight > 0.5 else air,
        )
    if light.daylight < 0.99:
        image *= illumination(view, depth, light, picture.glows, picture.road_height)
    else:
        image *= line(light.tint, view.width)
    air_around = _lit_air(air, picture)
    veil(image, distance, rate, air_around)
    _add_sky(image, picture, rate, air_around)
    add_glows(image, view, picture.shot.depth, picture.glows, light, rate)
    add_glare(image, view, light, picture.shot.depth)
    _precipitation(image, picture)
    if light.daylight < 0.5:
        rng = stream(picture.seed, "grain", round(picture.time, 3))
        grain = rng.integers(-4, 5, image.shape[:2], dtype=np.int8)
        image += three(grain.astype(np.float32))
    image += np.float32(0.5)
    np.clip(image, 0.0, 255.0, out=image)
    return image.astype(np.uint8)


def _add_sky(image: Float, picture: Picture, rate: float, air: Colour | Float) -> None:
    """Put the sky, faded as everything is, behind everything else, in place."""
    import cv2

    share = picture.shot.sky
    some = np.flatnonzero(share.any(axis=1))
    if len(some) == 0:
        return
    rows, width = int(some[-1]) + 1, picture.view.width
    air_there = air[:rows] if isinstance(air, np.ndarray) else line(air, width)
    if rate * SKY_M > _OPAQUE:
        behind = np.ascontiguousarray(np.broadcast_to(air_there, (rows, width, 3)))
    else:
        behind = sky(picture.view, picture.weather, picture.light, picture.seed, rows=rows)
        if rate > 0.0:
            far = np.full((rows, width), SKY_M, np.float32)
            behind = veil(behind, far, rate, air_there)
    share, upper = share[:rows], image[:rows]
    is_sky = share == 255
    cv2.copyTo(behind, is_sky.view(np.uint8), upper)
    edge = np.nonzero((share > 0) & ~is_sky)
    part = share[edge].astype(np.float32)[:, None] * np.float32(1 / 255)
    upper[edge] += (behind[edge] - upper[edge]) * part


def _ground(picture: Picture) -> Float:
    """Return 1 for every pixel that shows the ground, 0 elsewhere."""
    view = picture.view
    _, upwards = view.slopes()
    near = np.minimum(picture.shot.reach, np.float32(400.0))
    height = near * (upwards * np.float32(view.up[2]) + np.float32(view.forward[2]))[:, None]
    height += np.float32(view.eye[2] - picture.road_height)
    limit = np.float32(0.16) + near * np.float32(0.02)
    return np.asarray((picture.shot.rows < 0) & (height < limit), np.float32)


def _shade(image: Float, picture: Picture, ground: Float) -> None:
    """Darken the ground where something stands between it and the light, in place."""
    light = picture.light
    if not picture.casters or light.daylight < 0.2:
        return
    mask = shadow_mask(picture.view, picture.casters, light.sun, picture.road_height)
    mask *= ground
    image *= three(np.float32(1.0) - np.float32(light.shadow) * mask)


def _lit_air(air: Colour, picture: Picture) -> Colour | Float:
    """Return the air's colour; at night the ego's own beams light it up before the car."""
    light, view = picture.light, picture.view
    if light.daylight > 0.6 or extinction(picture.weather) <= 0.0:
        return air
    import cv2

    across, upwards = view.slopes()
    spread = cv2.exp(-((across / np.float32(0.75)) ** 2).reshape(1, -1)).astype(np.float32)
    low = np.float32(1.0) / (np.float32(1.0) + np.clip((upwards + 0.06) / 0.3, 0.0, 8.0) ** 2)
    back = spread * low.astype(np.float32)[:, None] * np.float32(104.0 * (1.0 - light.daylight))
    thick = np.float32(min(1.0, extinction(picture.weather) * 30.0))
    back *= thick
    return np.asarray(cv2.merge([back + np.float32(v) for v in air]), np.float32)


def _precipitation(image: Float, picture: Picture) -> None:
    """Add streaks or flakes, in place."""
    weather, light = picture.weather, picture.light
    if weather.precipitation == "rain":
        streaks = rain_streaks(picture.view, weather, picture.seed, picture.time)
        image += three(streaks * np.float32(0.25 + 0.5 * light.daylight))
    elif weather.precipitation == "snow":
        cover = snow_flakes(picture.view, weather, picture.shot.reach, picture.seed, picture.time)
        flake = np.array([246.0, 248.0, 252.0], np.float32) * np.float32(
            0.42 + 0.58 * light.daylight
        )
        where = np.nonzero(cover)
        image[where] += (flake - image[where]) * cover[where][:, None]
