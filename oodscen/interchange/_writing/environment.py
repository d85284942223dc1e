"""Environment: weather, light and friction."""

import math

from oodscen.data._weather import Weather
from oodscen.interchange._writing.elements import Element, Value, child, within

OKTAS = (
    "zeroOktas",
    "oneOktas",
    "twoOktas",
    "threeOktas",
    "fourOktas",
    "fiveOktas",
    "sixOktas",
    "sevenOktas",
    "eightOktas",
)
"""Cloud cover by eighths of the sky."""
_ZENITH_LUX = 100_000.0
"""Illuminance of an overhead sun, lx."""
_CLOUD_STATES = ((0.25, "free"), (0.75, "cloudy"), (1.01, "overcast"))
"""Cloud states of version 1.0 by the cloud cover below which they hold."""
_HEAVIEST_MM_H = 50.0
"""Precipitation that version 1.0 calls an intensity of 1, mm/h."""


def write_environment(actions: Element, weather: Weather, *, minor: int) -> None:
    """Append the action that sets weather, light and friction, for version 1.`minor`: 0 or 2."""
    action = within(actions, "GlobalAction", "EnvironmentAction")
    environment = child(action, "Environment", name="environment")
    elevation = math.radians(weather.sun_elevation_deg)
    light = max(0.0, math.sin(elevation))
    precipitation_mm_h = weather.precipitation_mm_h
    cover: dict[str, Value]
    sun: dict[str, Value]
    amount: dict[str, Value]
    if minor == 0:
        clouds = next(name for below, name in _CLOUD_STATES if weather.cloud_cover < below)
        cover, sun = {"cloudState": clouds}, {"intensity": light}
        amount = {"intensity": min(1.0, precipitation_mm_h / _HEAVIEST_MM_H)}
    else:
        cover = {"fractionalCloudCover": OKTAS[round(8 * weather.cloud_cover)]}
        sun = {"illuminance": _ZENITH_LUX * light}
        amount = {"precipitationIntensity": precipitation_mm_h}
    hour = 12 if weather.sun_elevation_deg > 0.0 else 0
    child(environment, "TimeOfDay", animation=False, dateTime=f"2026-06-21T{hour:02d}:00:00")
    sky = child(environment, "Weather", **cover)
    child(sky, "Sun", azimuth=0.0, elevation=elevation, **sun)
    child(sky, "Fog", visualRange=weather.fog_visual_range_m)
    kind = "dry" if weather.precipitation == "none" else weather.precipitation
    child(sky, "Precipitation", precipitationType=kind, **amount)
    child(environment, "RoadCondition", frictionScaleFactor=weather.friction)
