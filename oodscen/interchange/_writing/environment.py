"""Environment: weather, light and friction."""

import math

from oodscen.data._scene import Weather
from oodscen.interchange._writing.elements import Element, child, within

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
ZENITH_LUX = 100_000.0
"""Illuminance of an overhead sun, lx."""


def write_environment(actions: Element, weather: Weather) -> None:
    """Append the action that sets weather, light and friction."""
    action = within(actions, "GlobalAction", "EnvironmentAction")
    environment = child(action, "Environment", name="environment")
    elevation = math.radians(weather.sun_elevation_deg)
    hour = 12 if weather.sun_elevation_deg > 0.0 else 0
    child(environment, "TimeOfDay", animation=False, dateTime=f"2026-06-21T{hour:02d}:00:00")
    sky = child(environment, "Weather", fractionalCloudCover=OKTAS[round(8 * weather.cloud_cover)])
    light = max(0.0, ZENITH_LUX * math.sin(elevation))
    child(sky, "Sun", azimuth=0.0, elevation=elevation, illuminance=light)
    child(sky, "Fog", visualRange=weather.fog_visual_range_m)
    child(
        sky,
        "Precipitation",
        precipitationType="dry" if weather.precipitation == "none" else weather.precipitation,
        precipitationIntensity=weather.precipitation_mm_h,
    )
    child(environment, "RoadCondition", frictionScaleFactor=weather.friction)
