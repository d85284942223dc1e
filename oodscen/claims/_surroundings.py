"""Checks of claims about weather, light, road and the ego's lane."""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from oodscen.claims._actors import Verdict
from oodscen.claims._roads import holds_on
from oodscen.data._catalogue import RoadMap
from oodscen.data._claim import Claim
from oodscen.data._scene import Scene
from oodscen.data._weather import DARK_DEG, FOG_M, Weather
from oodscen.driving._trace import Trace

THICK_FOG_M, MIST_M = 200.0, 5000.0
"""Largest visual ranges of thick fog and mist, m."""
LIGHT_RAIN, HEAVY_RAIN = 2.5, 7.6
"""Upper limit of light rain and lower limit of heavy rain, mm/h (American Meteorological Society)."""
LIGHT_SNOW, HEAVY_SNOW = 2.0, 4.0
"""The same limits for snow, as water equivalent; visual range and road surface are separate claims."""
_HALF_COVER = 0.5
"""Largest cloud cover of a clear sky, and least of a cloudy one."""
_WET_FRICTION, _SLIPPERY_FRICTION = 0.85, 0.55
"""Largest friction of wet and of slippery roads; of dry asphalt it is 1, of wet asphalt about 0.7."""
_TWILIGHT_DEG = (-9.0, 6.0)
"""Sun elevations of dusk and dawn, degrees: civil twilight and the minutes beside it."""
_LOW_SUN_DEG = 15.0
"""Largest elevation of a low sun, degrees."""
_SPEED_KMH, _SPEED_SHARE = 6.0, 0.2
"""Permitted difference between a stated speed of the ego and its own: km/h or a share, whichever is more."""
_TURN_RAD = math.radians(50.0)
"""Least change of heading that counts as a turn, rad."""


class Judgement(NamedTuple):
    """A verdict on a claim, with its reason."""

    holds: bool | None
    """`None` if it cannot be decided."""
    found: str
    """Description of the content of the scene."""
    path: str
    """Path of the relevant part of the scene."""


def judge_surroundings(claim: Claim, scene: Scene, road: RoadMap | None, trace: Trace) -> Judgement:
    """Compare a claim of kind weather, time, road, lanes, own_lanes, ego or ego_speed with a scene."""
    if claim.kind in _TESTS:
        holds = _TESTS[claim.kind][claim.value](scene.weather)
        return Judgement(holds, f"it is {_described(scene.weather)}", "weather")
    if claim.kind == "ego_speed":
        claimed_kmh, speed_kmh = float(claim.value), 3.6 * scene.ego.speed
        is_near = abs(speed_kmh - claimed_kmh) <= max(_SPEED_KMH, _SPEED_SHARE * claimed_kmh)
        return Judgement(is_near, f"the ego drives at {speed_kmh:.0f} km/h", "ego.speed")
    if claim.kind == "ego":
        if claim.value.startswith("turns"):
            return Judgement(*_judge_turn(claim.value, trace), "ego")
        return Judgement(*_judge_lane(claim.value, scene, road), "ego")
    if road is None:
        return Judgement(None, f"nothing is known of {scene.map!r}", "map")
    holds = holds_on(claim, road)
    return Judgement(holds, f"the map is {road.description} ({scene.map})", "map")


def _judge_turn(value: str, trace: Trace) -> Verdict:
    yaw = np.unwrap(trace["yaw"][:, 0])
    turned = float(yaw[-1] - yaw[0])
    side = "left" if turned > 0.0 else "right"
    found = f"the ego turns by {math.degrees(abs(turned)):.0f} degrees to the {side}"
    return value == f"turns_{side}" and abs(turned) > _TURN_RAD, found


def _judge_lane(value: str, scene: Scene, road: RoadMap | None) -> Verdict:
    if road is None:
        return None, f"nothing is known of {scene.map!r}"
    lane, last = scene.ego.lane, road.lanes - 1
    match value:
        case "left_lane":
            holds = lane == last
        case "right_lane":
            holds = lane == 0
        case _:
            holds = 0 < lane < last
    return holds, f"the ego drives in lane {lane} of {road.lanes}, counted from the right"


def _described(weather: Weather) -> str:
    if weather.precipitation == "none":
        precipitation = "dry"
    else:
        precipitation = f"{weather.precipitation} of {weather.precipitation_mm_h:g} mm/h"
    return (
        f"{precipitation}, the sun at {weather.sun_elevation_deg:g} degrees, visual range {weather.fog_visual_range_m:g} m, "
        f"cloud cover {weather.cloud_cover:g}, friction {weather.friction:g}"
    )


_WEATHER: Mapping[str, Callable[[Weather], bool]] = {
    "clear": lambda w: (
        w.precipitation == "none" and w.fog_visual_range_m > MIST_M and w.cloud_cover <= _HALF_COVER
    ),
    "cloudy": lambda w: w.cloud_cover >= _HALF_COVER,
    "dry": lambda w: w.precipitation == "none",
    "rain": lambda w: w.precipitation == "rain",
    "light_rain": lambda w: w.precipitation == "rain" and w.precipitation_mm_h <= LIGHT_RAIN,
    "heavy_rain": lambda w: w.precipitation == "rain" and w.precipitation_mm_h >= HEAVY_RAIN,
    "snow": lambda w: w.precipitation == "snow",
    "light_snow": lambda w: w.precipitation == "snow" and w.precipitation_mm_h <= LIGHT_SNOW,
    "heavy_snow": lambda w: w.precipitation == "snow" and w.precipitation_mm_h >= HEAVY_SNOW,
    "fog": lambda w: w.fog_visual_range_m <= FOG_M,
    "thick_fog": lambda w: w.fog_visual_range_m <= THICK_FOG_M,
    "mist": lambda w: w.fog_visual_range_m <= MIST_M,
    "wet_road": lambda w: w.precipitation == "rain" or w.friction <= _WET_FRICTION,
    "slippery_road": lambda w: w.friction <= _SLIPPERY_FRICTION,
}
_TIME: Mapping[str, Callable[[Weather], bool]] = {
    "day": lambda w: w.sun_elevation_deg > 0.0,
    "night": lambda w: w.sun_elevation_deg < DARK_DEG,
    "twilight": lambda w: _TWILIGHT_DEG[0] <= w.sun_elevation_deg <= _TWILIGHT_DEG[1],
    "low_sun": lambda w: 0.0 < w.sun_elevation_deg <= _LOW_SUN_DEG,
}
_TESTS: Mapping[str, Mapping[str, Callable[[Weather], bool]]] = {"weather": _WEATHER, "time": _TIME}
"""Tests of weather by kind and value of a claim.

They are tolerant: a road with snow or ice is wet, too, and a sky half covered is both clear and cloudy.
"""
