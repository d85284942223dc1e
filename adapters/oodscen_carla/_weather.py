"""Weather in CARLA's parameters and back."""

from typing import NamedTuple

from oodscen.data import Weather
from oodscen.data._weather import CLEAR_AIR_M, Precipitation

_DENSE_M = 2_000.0
"""Visual range of fog of density 1, m; the range falls as the density grows."""
_HEAVY_MM_H = 50.0
"""Rain that CARLA shows with precipitation 100, mm/h."""
_FALLOFF = 0.1
"""CARLA's default falloff of fog."""
_DEPOSITS = 60.0
"""Puddles that CARLA shows in rain, percent."""
_SNOW_FALLOFF = 5.0
"""CARLA has no snow: this fog falloff, which none of its presets has, marks precipitation as snow."""
_OWN_DISTANCE = 0.0
"""Distance at which all fog of scenes begins, m; that of CARLA's presets never does."""
_HAZE_DENSITY = 7.0
"""Greatest fog density of CARLA's presets by day, all of which are clear."""
_MIDNIGHT_DEG = -90.0
"""Elevation of the sun in CARLA's presets by night."""
_NIGHT_AIR = frozenset({(60.0, 75.0), (60.0, 0.75), (100.0, 0.75)})
"""Densities and distances of fog in CARLA's presets by night, all of which are clear."""
_LEAST_FRICTION = 0.05
"""Friction of the wettest road; that of wet ice."""


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
    fog_falloff: float = _FALLOFF
    wetness: float = 0.0
    scattering_intensity: float = 1.0
    mie_scattering_scale: float = 0.03
    rayleigh_scattering_scale: float = 0.0331
    dust_storm: float = 0.0


def to_carla(weather: Weather) -> WeatherParameters:
    """Return CARLA's parameters for a weather."""
    is_rain, is_snow = weather.precipitation == "rain", weather.precipitation == "snow"
    visual_range_m = weather.fog_visual_range_m
    return WeatherParameters(
        cloudiness=100.0 * weather.cloud_cover,
        precipitation=min(100.0, 100.0 * weather.precipitation_mm_h / _HEAVY_MM_H),
        precipitation_deposits=_DEPOSITS if is_rain else 0.0,
        sun_altitude_angle=weather.sun_elevation_deg,
        fog_density=min(100.0, _DENSE_M / visual_range_m) if visual_range_m < CLEAR_AIR_M else 0.0,
        fog_distance=_OWN_DISTANCE,
        fog_falloff=_SNOW_FALLOFF if is_snow else _FALLOFF,
        wetness=100.0 * (1.0 - min(1.0, weather.friction)),
    )


def from_carla(parameters: WeatherParameters) -> Weather:
    """Return the weather that parameters describe; the air of CARLA's presets is clear.

    Values of `to_carla` with at most six digits come back unchanged from the 32-bit floats of the
    wire, if CARLA's parameters reach them: fog from 20 m to 10 km, precipitation up to 50 mm/h,
    friction from 0.05 to 1.
    """
    share = _within(0.0, parameters.precipitation, 100.0) / 100.0
    amount_mm_h = _six_digits(_HEAVY_MM_H * share)
    kind: Precipitation = "none"
    if amount_mm_h > 0.0:
        kind = "snow" if parameters.fog_falloff == _SNOW_FALLOFF else "rain"
    visual_range_m = CLEAR_AIR_M
    if not _is_clear(parameters):
        visual_range_m = _within(1.0, _DENSE_M / parameters.fog_density, CLEAR_AIR_M)
    friction = _within(_LEAST_FRICTION, 1.0 - parameters.wetness / 100.0, 1.0)
    return Weather(
        sun_elevation_deg=_six_digits(_within(-90.0, parameters.sun_altitude_angle, 90.0)),
        cloud_cover=_six_digits(_within(0.0, parameters.cloudiness / 100.0, 1.0)),
        precipitation=kind,
        precipitation_mm_h=amount_mm_h,
        fog_visual_range_m=_six_digits(visual_range_m),
        friction=round(friction, 6),
    )


def _is_clear(parameters: WeatherParameters) -> bool:
    """Return whether parameters have no fog, or the haze with which CARLA's presets are clear."""
    air = parameters.fog_density, parameters.fog_distance
    if parameters.sun_altitude_angle == _MIDNIGHT_DEG and air in _NIGHT_AIR:
        return True
    haze = 0.0 if parameters.fog_distance == _OWN_DISTANCE else _HAZE_DENSITY
    return parameters.fog_density <= haze


def _within(least: float, value: float, most: float) -> float:
    return max(least, min(most, value))


def _six_digits(value: float) -> float:
    """Return a value without the noise of 32-bit floats."""
    return float(f"{value:.6g}")
