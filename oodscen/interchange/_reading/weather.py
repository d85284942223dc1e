"""The weather of an OpenSCENARIO file."""

import math
import re

from oodscen.data._weather import CLEAR_AIR_M, PRECIPITATIONS, Precipitation, Weather
from oodscen.interchange._reading.tree import Element
from oodscen.interchange._writing.environment import OKTAS

_CLOUDS = {
    "free": 0.0,
    "skyOff": 0.0,
    "cloudy": 0.5,
    "overcast": 1.0,
    "rainy": 1.0,
    **{name: eighths / 8.0 for eighths, name in enumerate(OKTAS)},
    "nineOktas": 1.0,
}
"""Cloud cover by the cloud states of version 1.0 and 1.1, and by the oktas of later ones."""
_UNSEEN = {"skyOff", "nineOktas"}
"""States that say more than a cloud cover: no sky is drawn, or it cannot be seen."""
_MAX_MM_H = 100.0
"""Largest precipitation of a scene, mm/h."""
_MAX_INTENSITY_MM_H = 50.0
"""Precipitation for an intensity of 1 in version 1.0, mm/h."""


def weather_of(root: Element) -> Weather:
    """Return the weather of the first environment of a file, or ordinary weather."""
    environment = next(root.within("Environment"), None)
    if environment is None:
        return Weather()
    sky = environment.first("Weather") or environment
    sun, fog = sky.first("Sun"), sky.first("Fog")
    elevation_deg = _sun_elevation_deg(environment, sun)
    kind, amount_mm_h = _precipitation(sky)
    return Weather(
        sun_elevation_deg=round(elevation_deg, 2),
        fog_visual_range_m=round(_visual_range_m(fog), 2),
        precipitation=kind,
        precipitation_mm_h=amount_mm_h,
        cloud_cover=_cloud_cover(sky),
        friction=round(_friction(environment), 3),
    )


def _sun_elevation_deg(environment: Element, sun: Element | None) -> float:
    if sun is not None:
        elevation_deg = math.degrees(sun.number("elevation"))
        return sun.bounded(elevation_deg, -90.0, 90.0, "an elevation in degrees of")
    day = environment.first("TimeOfDay")
    return Weather().sun_elevation_deg if day is None else _elevation_by_hour_deg(day)


def _elevation_by_hour_deg(day: Element) -> float:
    """Return a plausible elevation of the sun at a time of day, degrees."""
    match = re.search(r"T([0-9]{2}):", day.get("dateTime"))
    hour = int(match[1]) if match else 12
    elevation_deg = round(50.0 * math.sin((hour - 6.0) / 12.0 * math.pi), 2)
    day.note(f"the hour is read as {hour}, with the sun at {elevation_deg:g} degrees")
    return elevation_deg


def _visual_range_m(fog: Element | None) -> float:
    """Return the visual range, m, which in clear air is always the same."""
    if fog is None:
        return CLEAR_AIR_M
    range_m = min(fog.number("visualRange", CLEAR_AIR_M), CLEAR_AIR_M)
    return fog.bounded(range_m, 1.0, CLEAR_AIR_M, "a visual range of")


def _friction(environment: Element) -> float:
    road = environment.first("RoadCondition")
    if road is None:
        return 1.0
    return road.bounded(road.number("frictionScaleFactor", 1.0), 0.01, 1.5, "a friction of")


def _cloud_cover(sky: Element) -> float:
    oktas, state = sky.get("fractionalCloudCover"), sky.get("cloudState")
    clouds = oktas or state
    cover = _CLOUDS.get(clouds, Weather().cloud_cover)
    if clouds and (clouds not in _CLOUDS or clouds in _UNSEEN):
        sky.note(f"clouds {clouds[:40]!r} are read as a cover of {cover:g}")
    if oktas and state and _CLOUDS.get(state) != cover:
        sky.note(f"cloudState={state[:40]!r} is left out")
    return cover


def _precipitation(sky: Element) -> tuple[Precipitation, float]:
    """Return the kind of precipitation, and its amount, mm/h."""
    node = sky.first("Precipitation")
    if node is None:
        return "none", 0.0
    name, amount_mm_h = node.get("precipitationType"), _intensity_mm_h(node)
    kind: Precipitation = next((kind for kind in PRECIPITATIONS if kind == name), "none")
    if kind == "none" and name not in ("dry", "none"):
        node.note(f"precipitation of kind {name[:40]!r} is left out")
    elif kind == "none" and amount_mm_h > 0.0:
        node.note(f"{amount_mm_h:g} mm/h of nothing are left out")
    bounded_mm_h = node.bounded(amount_mm_h, 0.0, _MAX_MM_H, "an intensity in mm/h of")
    amount_mm_h = round(bounded_mm_h, 2)
    return (kind, amount_mm_h) if kind != "none" and amount_mm_h > 0.0 else ("none", 0.0)


def _intensity_mm_h(node: Element) -> float:
    if node.get("precipitationIntensity"):
        return node.number("precipitationIntensity")
    share = node.number("intensity", 0.0)
    if share:
        node.note(f"an intensity from 0 to 1 is read as up to {_MAX_INTENSITY_MM_H:g} mm/h")
    return _MAX_INTENSITY_MM_H * share
