"""The air and what falls through it: sky, fog, rain and snow, added to a picture from depth.

Fog follows Koschmieder's law: contrast falls to 5 % at the visual range.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from oodscen.scene import Weather
from oodscen.seeding import stream
from oodscen_pybullet.light import Light, line, three
from oodscen_pybullet.view import View

Float = NDArray[np.float32]
Colour = tuple[float, float, float]

CLEAR_AIR_M = 10_000.0
"""Visual range from which on air takes nothing away."""
SKY_M = 6_000.0
"""How far the sky is away for the fog."""


def extinction(weather: Weather) -> float:
    """Return how quickly contrast fades, 1/m: fog, and rain or snow on top of it."""
    fog = weather.fog_visual_range_m
    total = math.log(20.0) / fog if fog < CLEAR_AIR_M else 0.0
    if weather.precipitation == "rain":
        total += 0.0011 * math.pow(weather.precipitation_mm_h, 0.67)
    elif weather.precipitation == "snow":
        total += 0.0085 * math.pow(weather.precipitation_mm_h, 0.6)
    return total


def air_colour(weather: Weather, light: Light) -> Colour:
    """Return the colour into which everything fades, 0 to 255."""
    grey: Colour = (196.0, 201.0, 207.0)
    if weather.precipitation == "rain":
        grey = (158.0, 164.0, 171.0)
    elif weather.precipitation == "snow":
        grey = (208.0, 212.0, 219.0)
    bright = 0.045 + 0.955 * light.daylight
    return (
        grey[0] * bright * light.tint[0],
        grey[1] * bright * light.tint[1],
        grey[2] * bright * light.tint[2],
    )


def veil(image: Float, distance: Float, rate: float, air: Colour | Float) -> Float:
    """Fade a picture into the air, in place.

    Args:
        image: [height, width, 3], 0 to 255.
        distance: From the eye, m; at infinity there is nothing but air.
        rate: Extinction, 1/m; 0 leaves the picture as it is.
        air: Colour of the air, one or per pixel.
    """
    if rate <= 0.0:
        return image
    import cv2

    through = cv2.exp(np.minimum(distance, np.float32(1e6)) * np.float32(-rate))
    target = air if isinstance(air, np.ndarray) else line(air, image.shape[1])
    image -= target
    image *= three(through)
    image += target
    return image


def sky(view: View, weather: Weather, light: Light, seed: int, *, rows: int) -> Float:
    """Paint the sky for the uppermost rows of pixels, [rows, width, 3], 0 to 255.

    Below the horizon it is the haze over distant ground.
    """
    import cv2

    across, upwards = view.slopes()
    upwards = upwards[:rows]
    rise = upwards * np.float32(view.up[2]) + np.float32(view.forward[2])
    high = np.clip(rise * np.float32(1.6), 0.0, 1.0)[:, None, None]
    horizon, zenith = (204.0, 222.0, 240.0), (92.0, 148.0, 222.0)
    night_horizon, night_zenith = (26.0, 30.0, 44.0), (7.0, 9.0, 20.0)
    low = 1.0 - min(1.0, max(0.0, weather.sun_elevation_deg) / 14.0)
    dusk = low * max(0.0, min(1.0, (weather.sun_elevation_deg + 8.0) / 8.0))
    day = light.daylight
    bottom = [n + (h - n) * day for h, n in zip(horizon, night_horizon, strict=True)]
    glow = (248.0, 186.0, 128.0)
    mix = 0.6 * dusk
    bottom = [b + (g * max(day, 0.5) - b) * mix for b, g in zip(bottom, glow, strict=True)]
    top = [n + (h - n) * day for h, n in zip(zenith, night_zenith, strict=True)]
    clear = (
        np.array(bottom, np.float32)
        + (np.array(top, np.float32) - np.array(bottom, np.float32)) * high
    )
    painted = np.broadcast_to(clear, (rows, view.width, 3)).astype(np.float32)
    cover = max(weather.cloud_cover, 1.0 if weather.precipitation != "none" else 0.0)
    if cover > 0.02:
        sheet = _cloud_sheet(seed)
        heading = math.atan2(view.forward[1], view.forward[0])
        turn = (heading / math.tau) % 1.0
        column = (np.float32(turn * 1024.0) - across * np.float32(1024.0 / math.tau)) % np.float32(
            1024
        )
        row = np.clip(rise * np.float32(420.0), 0.0, 255.0)
        map_x = np.broadcast_to(column[None, :], (rows, view.width)).astype(np.float32)
        map_y = np.broadcast_to(row[:, None], (rows, view.width)).astype(np.float32)
        cloud = cv2.remap(sheet, map_x, map_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        edge = np.float32(1.0 - 0.9 * cover)
        share = np.clip((cloud - edge + np.float32(0.12)) * np.float32(3.2), 0.0, 1.0)
        share = np.maximum(share, np.float32(max(0.0, (cover - 0.75) * 4.0)))
        shade = cloud * np.float32(0.22) + np.float32(0.86 - 0.12 * cover)
        grey = [shade * np.float32(v * (0.06 + 0.94 * day)) for v in (236.0, 239.0, 243.0)]
        clouds = np.asarray(cv2.merge(grey), np.float32)
        clouds -= painted
        clouds *= three(share)
        painted += clouds
    return painted


@lru_cache(maxsize=8)
def _cloud_sheet(seed: int) -> Float:
    """Return cloud density by heading and height, [256, 1024], seamless around."""
    import cv2

    rng = stream(seed, "clouds")
    sheet = np.zeros((256, 1024), np.float32)
    for rows, columns, weight in ((12, 64, 0.7), (40, 256, 0.3)):
        noise = rng.uniform(0.0, 1.0, (rows, columns)).astype(np.float32)
        wrapped = np.hstack([noise[:, -2:], noise, noise[:, :2]])
        cell = 1024 // columns
        wide = cv2.resize(wrapped, (1024 + 4 * cell, 256), interpolation=cv2.INTER_CUBIC)
        sheet += np.float32(weight) * wide[:, 2 * cell : 2 * cell + 1024]
    sheet.flags.writeable = False
    return sheet


def wet(image: Float, ground: Float, distance: Float, sheen: Colour) -> Float:
    """Darken wet ground and let it mirror the sky at flat angles, in place.

    Args:
        image: [height, width, 3].
        ground: [height, width], 1 where a pixel shows the ground.
        distance: m
        sheen: Colour of what it mirrors.
    """
    import cv2

    flat = np.minimum(distance, np.float32(200.0))
    flat /= flat + np.float32(22.0)
    mirror = np.float32(0.46) * flat * flat * ground
    image *= three((np.float32(1.0) - np.float32(0.34) * ground) * (np.float32(1.0) - mirror))
    image += cv2.merge([mirror * np.float32(v) for v in sheen])
    return image


def rain_streaks(view: View, weather: Weather, seed: int, time: float) -> Float:
    """Return how much light falling drops add, [height, width], 0 to 255."""
    import cv2

    rng = stream(seed, "rain", round(time, 3))
    area = view.width * view.height / (640 * 480)
    layer = np.zeros((view.height, view.width), np.uint8)
    intensity = weather.precipitation_mm_h / 50.0
    scale = view.height / 480
    for share, length, weight, bright in (
        (1.0, 16.0, 1, 92),
        (0.35, 38.0, 1, 110),
        (0.05, 80.0, 2, 84),
    ):
        count = int(area * share * (140 + 640 * math.sqrt(intensity)))
        x = rng.uniform(-20, view.width + 20, count)
        y = rng.uniform(-40, view.height, count)
        size = rng.uniform(0.6, 1.3, count) * length * scale
        shade = rng.uniform(0.4, 1.0, count) * bright
        for index in range(count):
            start = (int(x[index]), int(y[index]))
            end = (int(x[index] - 0.10 * size[index]), int(y[index] + size[index]))
            cv2.line(layer, start, end, float(shade[index]), weight, cv2.LINE_AA)
    return np.asarray(cv2.blur(layer, (2, 2)), np.float32)


def snow_flakes(view: View, weather: Weather, depth: Float, seed: int, time: float) -> Float:
    """Return how much of each pixel flakes cover, [height, width], 0 to 1."""
    import cv2

    rng = stream(seed, "snow", round(time, 3))
    intensity = min(1.0, weather.precipitation_mm_h / 12.0)
    count = int(700 + 5200 * intensity)
    ahead = 0.9 + 26.0 * rng.uniform(0.0, 1.0, count) ** 1.3
    across = rng.uniform(-1.0, 1.0, count) * ahead * view.width / view.focal * 0.55
    upwards = rng.uniform(-1.0, 1.0, count) * ahead * view.height / view.focal * 0.55
    column = view.width / 2 + view.focal * across / ahead
    row = view.height / 2 - view.focal * upwards / ahead
    radius = view.focal * 0.009 / ahead
    layer = np.zeros((view.height, view.width), np.uint8)
    u, v = column.astype(np.int64), row.astype(np.int64)
    inside = (column > -1) & (u < view.width) & (row > -1) & (v < view.height)
    inside[inside] = depth[v[inside], u[inside]] >= ahead[inside]
    small = inside & (radius < 0.8)
    layer[v[small], u[small]] = 150
    for index in np.flatnonzero(inside & ~small).tolist():
        spot = (int(u[index]), int(v[index]))
        cv2.circle(layer, spot, int(radius[index] + 0.5), 225, -1, cv2.LINE_AA)
    soft = cv2.GaussianBlur(layer, (3, 3), 0.7)
    return np.asarray(soft * np.float32(1 / 255), np.float32)
