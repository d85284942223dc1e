"""Weather as a viewer meets it: visual range, and differences that a person would notice."""

from typing import assert_never

from oodscen.data._base import ROUNDING
from oodscen.data._weather import CLEAR_AIR_M, FOG_M, Weather
from oodscen.numerics._exact import power

_LN_20 = 2.995732273553991
"""Number of extinction lengths over which contrast falls to 5 %: ln 20."""
_NIGHT_DEG = -18.0
"""Sun elevation at which twilight ends and below which no night looks darker, degrees."""


def is_noticeable(weather: Weather, ordinary: Weather) -> bool:
    """Return whether a person would notice at a glance that two kinds of weather differ.

    This holds for half the visual range or less (below 1 km), other precipitation or three times as
    much, night or dusk instead of day, a sun 15 degrees lower before twilight ends, 0.15 less
    friction, or half of the sky more or less covered.
    """
    near, far = sorted((weather.fog_visual_range_m, ordinary.fog_visual_range_m))
    little, much = sorted((weather.precipitation_mm_h, ordinary.precipitation_mm_h))
    suns = (weather.sun_elevation_deg, ordinary.sun_elevation_deg)
    low, high = sorted(max(_NIGHT_DEG, sun) for sun in suns)
    return (
        (near < FOG_M and near <= 0.5 * far)
        or (weather.precipitation != ordinary.precipitation and much >= 0.5)
        or (much >= 2.0 and much >= 3.0 * little - ROUNDING)
        or high - low >= 15.0 - ROUNDING
        or (low < 8.0 <= high and high - low >= 8.0 - ROUNDING)
        or abs(weather.friction - ordinary.friction) >= 0.15 - ROUNDING
        or abs(weather.cloud_cover - ordinary.cloud_cover) >= 0.5 - ROUNDING
    )


def extinction(weather: Weather) -> float:
    """Return the extinction coefficient, 1/m: fog (Koschmieder) plus rain or snow."""
    fog, intensity = weather.fog_visual_range_m, weather.precipitation_mm_h
    rate = _LN_20 / fog if fog < CLEAR_AIR_M else 0.0
    match weather.precipitation:
        case "none":
            return rate
        case "rain":
            return rate + 0.0011 * power(intensity, 0.67)
        case "snow":
            return rate + 0.0085 * power(intensity, 0.6)
        case kind:
            assert_never(kind)


def visual_range(weather: Weather) -> float:
    """Return the distance at which contrast falls to 5 % in fog, rain and snow together, m."""
    rate = extinction(weather)
    return min(CLEAR_AIR_M, _LN_20 / rate) if rate > 0.0 else CLEAR_AIR_M
