"""Weather of a scene, drawn from the text, the recipe and the limits of the simulator."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from oodscen.author._knowledge.base import Conditions, Knowledge, Range, Recipe
from oodscen.author._staging.told import Told
from oodscen.data._weather import Weather
from oodscen.prompts._weather_line import WeatherLimits

_DRY = {"precipitation": "none", "precipitation_mm_h": 0.0}


def draw_weather(
    recipe: Recipe,
    told: Told,
    knowledge: Knowledge,
    limits: WeatherLimits,
    rng: np.random.Generator,
) -> tuple[Weather, Weather | None]:
    """Return the weather of a scene, and the ordinary weather if the weather is the hazard.

    The recipe's weather takes precedence over the text's conditions, and the claims of the text over both of
    what is left open. Without conditions the weather is clear.
    """
    fields: dict[str, Any] = {}
    clear = knowledge.condition_keys.get("clear")
    # Conditions that set the sun come last.
    ordered = sorted(
        told.conditions, key=lambda condition: condition.weather.get("sun_elevation_deg", 0) != 0
    )
    layers = [conditions.weather for conditions in (clear, *ordered) if conditions is not None]
    for layer in (*layers, recipe.weather):
        fields.update(_drawn(layer, rng))
    dark = [condition for condition in told.conditions if _is_dark(condition)]
    if dark and "sun_elevation_deg" not in recipe.weather:
        fields.update(_drawn({"sun_elevation_deg": dark[0].weather["sun_elevation_deg"]}, rng))
    claimed = {claim.value for claim in told.claims if claim.kind in ("weather", "time")}
    _agree(fields, claimed, recipe, rng)
    weather = _within_limits(fields, limits)
    if not recipe.ordinary_weather:
        return weather, None
    ordinary = {**weather.model_dump(), **recipe.ordinary_weather}
    return weather, _within_limits(ordinary, limits)


def _agree(
    fields: dict[str, Any], claimed: set[str], recipe: Recipe, rng: np.random.Generator
) -> None:
    """Adjust the weather to the claims of the text, in place, except for fields that the recipe sets.

    The number of draws is the same for every text.
    """
    draw = float(rng.random())
    for value, rule in _RULES.items():
        fixed = recipe.weather.keys() & {rule.field, *rule.others}
        if value not in claimed or fixed:
            continue
        least, most = rule.permitted
        low, high = rule.drawn
        current = float(fields.get(rule.field, Weather.model_fields[rule.field].default))
        if not least <= current <= most:
            fields[rule.field] = round(low + draw * (high - low), 2)
            fields.update(rule.others)


class _Rule(NamedTuple):
    """The weather that a claim requires."""

    field: str
    permitted: Range
    """Values for which the claim holds."""
    drawn: Range
    """Range to draw from if it does not hold."""
    others: Mapping[str, str] = {}
    """Fields to set with it."""


_RAIN, _SNOW = {"precipitation": "rain"}, {"precipitation": "snow"}
_RULES: Mapping[str, _Rule] = {
    "clear": _Rule("cloud_cover", (0.0, 0.4), (0.0, 0.3)),
    "cloudy": _Rule("cloud_cover", (0.7, 1.0), (0.85, 1.0)),
    "light_rain": _Rule("precipitation_mm_h", (0.1, 2.5), (0.8, 2.4), _RAIN),
    "heavy_rain": _Rule("precipitation_mm_h", (8.0, 100.0), (9.0, 16.0), _RAIN),
    "light_snow": _Rule("precipitation_mm_h", (0.1, 2.0), (0.6, 1.9), _SNOW),
    "heavy_snow": _Rule("precipitation_mm_h", (4.0, 100.0), (5.0, 9.0), _SNOW),
    "wet_road": _Rule("friction", (0.1, 0.8), (0.65, 0.75)),
    "slippery_road": _Rule("friction", (0.1, 0.5), (0.25, 0.4)),
    "fog": _Rule("fog_visual_range_m", (0.0, 900.0), (180.0, 400.0)),
    "thick_fog": _Rule("fog_visual_range_m", (0.0, 180.0), (50.0, 110.0)),
    "day": _Rule("sun_elevation_deg", (1.0, 90.0), (25.0, 45.0)),
    "night": _Rule("sun_elevation_deg", (-90.0, -6.0), (-28.0, -18.0)),
    "twilight": _Rule("sun_elevation_deg", (-6.0, 5.0), (-2.5, -0.9)),
    "low_sun": _Rule("sun_elevation_deg", (1.0, 14.0), (4.0, 9.0)),
}
"""Rules by value of a claim."""


def _is_dark(condition: Conditions) -> bool:
    sun = condition.weather.get("sun_elevation_deg")
    return isinstance(sun, tuple) and sun[1] < 0.0


def _drawn(layer: Mapping[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    drawn: dict[str, Any] = {}
    for field in sorted(layer):
        value = layer[field]
        drawn[field] = value if isinstance(value, str) else round(float(rng.uniform(*value)), 2)
    return drawn


def _within_limits(fields: dict[str, Any], limits: WeatherLimits) -> Weather:
    """Limit weather to what the simulator can show."""
    limited = dict(fields)
    if not limits.offers(limited.get("precipitation", "none")):
        limited.update(_DRY)
    if limited.get("precipitation_mm_h"):
        limited["precipitation_mm_h"] = min(limited["precipitation_mm_h"], limits.intensity)
    if "fog_visual_range_m" in limited:
        limited["fog_visual_range_m"] = max(limited["fog_visual_range_m"], limits.fog_m)
    limited["friction"] = max(limited.get("friction", 1.0), limits.friction)
    limited["sun_elevation_deg"] = max(limited.get("sun_elevation_deg", 45.0), limits.sun_deg)
    return Weather.model_validate(limited)
