"""Weather in CARLA's parameters and back."""

from typing import NamedTuple

from oodscen.data import Weather
from oodscen.data._scene import Precipitation

CLEAR_M = 10_000.0
"""Visual range from which the air counts as clear, m."""
_DENSE_M = 2_000.0
"""Visual range of fog of density 1, m; the range falls as the density grows."""
_HEAVY_MM_H = 50.0
"""Rain that CARLA shows with precipitation 100, mm/h."""
_SNOW_FALLOFF = 5.0
"""CARLA has no snow: a fog falloff of 5, the strongest, marks precipitation as snow."""
_DEFAULT_FOG = (2.0, 0.75)
"""Density and distance of fog in CARLA's default air, which is clear."""
_ROUNDING = 1e-6


class WeatherParameters(NamedTuple):
    """The values of `carla.WeatherParameters`, in the order of the wire."""

    cloudiness: float = 5.0
    precipitation: float = 0.0
    precipitation_deposits: float = 0.0
    wind_intensity: float = 10.0
    sun_azimuth_angle: float = 0.0
    sun_altitude_angle: float = 50.0
    fog_density: float = 2.0
    fog_distance: float = 0.75
    fog_falloff: float = 0.1
    wetness: float = 0.0
    scattering_intensity: float = 1.0
    mie_scattering_scale: float = 0.03
    rayleigh_scattering_scale: float = 0.0331
    dust_storm: float = 0.0


def to_carla(weather: Weather) -> WeatherParameters:
    """Return CARLA's parameters for a weather."""
    is_wet = weather.precipitation == "rain"
    fog = weather.fog_visual_range_m
    snow = weather.precipitation == "snow"
    return WeatherParameters(
        cloudiness=100.0 * weather.cloud_cover,
        precipitation=min(100.0, 100.0 * weather.precipitation_mm_h / _HEAVY_MM_H),
        precipitation_deposits=60.0 if is_wet else 0.0,
        sun_altitude_angle=weather.sun_elevation_deg,
        fog_density=min(100.0, _DENSE_M / fog) if fog < CLEAR_M else 0.0,
        fog_distance=0.0,
        fog_falloff=_SNOW_FALLOFF if snow else 0.1,
        wetness=100.0 * (1.0 - min(1.0, weather.friction)),
    )


def from_carla(given: WeatherParameters) -> Weather:
    """Return the weather that parameters describe.

    CARLA's default air, with a fog density of 2, is clear. Values are rounded, so that they come
    back unchanged from the 32-bit floats of the wire.
    """
    fall = max(0.0, min(100.0, given.precipitation)) * _HEAVY_MM_H / 100.0
    kind: Precipitation = "none"
    if round(fall, 3) > 0.0:
        kind = "snow" if given.fog_falloff >= _SNOW_FALLOFF else "rain"
    is_default = all(
        abs(value - usual) < _ROUNDING
        for value, usual in zip((given.fog_density, given.fog_distance), _DEFAULT_FOG, strict=True)
    )
    is_default |= given.fog_density <= 0.0
    fog = CLEAR_M if is_default else max(1.0, min(CLEAR_M, _DENSE_M / given.fog_density))
    return Weather(
        sun_elevation_deg=round(max(-90.0, min(90.0, given.sun_altitude_angle)), 4),
        cloud_cover=round(max(0.0, min(1.0, given.cloudiness / 100.0)), 6),
        precipitation=kind,
        precipitation_mm_h=round(fall, 3) if kind != "none" else 0.0,
        fog_visual_range_m=float(f"{fog:.6g}"),
        friction=round(max(0.05, 1.0 - max(0.0, given.wetness) / 100.0), 6),
    )
