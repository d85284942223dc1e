"""Checks of claims about weather, light, road and the ego's lane."""

import math
from collections.abc import Callable, Mapping

from oodscen.claims._actors import Verdict
from oodscen.claims._roads import is_so_or_has
from oodscen.data._catalogue import RoadMap
from oodscen.data._claim import Claim
from oodscen.data._scene import DARK_DEG, FOG_M, Scene, Weather
from oodscen.driving._trace import Trace

THICK_FOG_M, MIST_M = 200.0, 5000.0
"""Largest visual ranges of thick fog and mist, m."""
LIGHT_RAIN, HEAVY_RAIN = 2.5, 7.6
"""Upper limit of light rain and lower limit of heavy rain, mm/h (American Meteorological Society)."""
LIGHT_SNOW, HEAVY_SNOW = 2.0, 4.0
"""The same limits for snow, as water equivalent; visual range and road surface are separate claims."""
_TURN_RAD = math.radians(50.0)


def judge_surroundings(
    claim: Claim, scene: Scene, road: RoadMap | None, trace: Trace
) -> tuple[bool | None, str, str]:
    """Compare a claim of kind weather, time, road, lanes, own_lanes, ego or ego_speed with a scene.

    Returns:
        The verdict, what the scene shows, and the path in the scene.
    """
    if claim.kind in ("weather", "time"):
        test = {**_WEATHER, **_TIME}[claim.value]
        return test(scene.weather), f"it is {_words(scene.weather)}", "weather"
    if claim.kind == "ego_speed":
        kmh, own = float(claim.value), 3.6 * scene.ego.speed
        return (
            abs(own - kmh) <= max(6.0, 0.2 * kmh),
            f"the ego drives at {own:.0f} km/h",
            "ego.speed",
        )
    if claim.kind == "ego":
        holds, found = _ego(claim.value, scene, road, trace)
        return holds, found, "ego"
    if road is None:
        return None, f"nothing is known of {scene.map!r}", "map"
    holds = is_so_or_has(claim, road)
    return holds, f"the map is {road.description} ({scene.map})", "map"


def _ego(value: str, scene: Scene, road: RoadMap | None, trace: Trace) -> Verdict:
    if value.startswith("turns"):
        yaw = trace["yaw"][:, 0]
        turned = math.remainder(float(yaw[-1] - yaw[0]), math.tau)
        holds = turned > _TURN_RAD if value == "turns_left" else turned < -_TURN_RAD
        return holds, f"the ego turns by {math.degrees(turned):.0f} degrees to the left"
    if road is None:
        return None, f"nothing is known of {scene.map!r}"
    lane, last = scene.ego.lane, road.lanes - 1
    holds = {"left_lane": lane == last, "right_lane": lane == 0, "middle_lane": 0 < lane < last}[
        value
    ]
    return holds, f"the ego drives in lane {lane} of {road.lanes}, counted from the right"


def _words(weather: Weather) -> str:
    sun = weather.sun_elevation_deg
    rain = (
        "dry"
        if weather.precipitation == "none"
        else f"{weather.precipitation} of {weather.precipitation_mm_h:g} mm/h"
    )
    return (
        f"{rain}, the sun at {sun:g} degrees, visual range {weather.fog_visual_range_m:g} m, "
        f"cloud cover {weather.cloud_cover:g}, friction {weather.friction:g}"
    )


_WEATHER: Mapping[str, Callable[[Weather], bool]] = {
    "clear": lambda w: (
        w.precipitation == "none" and w.fog_visual_range_m > MIST_M and w.cloud_cover <= 0.5
    ),
    "cloudy": lambda w: w.cloud_cover >= 0.5,
    "dry": lambda w: w.precipitation == "none" and w.friction >= 0.75,
    "rain": lambda w: w.precipitation == "rain",
    "light_rain": lambda w: w.precipitation == "rain" and w.precipitation_mm_h <= LIGHT_RAIN,
    "heavy_rain": lambda w: w.precipitation == "rain" and w.precipitation_mm_h >= HEAVY_RAIN,
    "snow": lambda w: w.precipitation == "snow",
    "light_snow": lambda w: w.precipitation == "snow" and w.precipitation_mm_h <= LIGHT_SNOW,
    "heavy_snow": lambda w: w.precipitation == "snow" and w.precipitation_mm_h >= HEAVY_SNOW,
    "fog": lambda w: w.fog_visual_range_m <= FOG_M,
    "thick_fog": lambda w: w.fog_visual_range_m <= THICK_FOG_M,
    "mist": lambda w: w.fog_visual_range_m <= MIST_M,
    "wet_road": lambda w: w.precipitation == "rain" or w.friction <= 0.85,
    "slippery_road": lambda w: w.friction <= 0.55,
}
_TIME: Mapping[str, Callable[[Weather], bool]] = {
    "day": lambda w: w.sun_elevation_deg > 0.0,
    "night": lambda w: w.sun_elevation_deg < DARK_DEG,
    "twilight": lambda w: -9.0 <= w.sun_elevation_deg <= 6.0,
    "low_sun": lambda w: 0.0 < w.sun_elevation_deg <= 15.0,
}
