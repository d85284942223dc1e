"""Drawing a scene's weather: what the text says, what the recipe demands, what can be shown."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from oodscen.llms.author.feasibility import WeatherLimits
from oodscen.llms.author.knowledge import Condition, Knowledge, Recipe
from oodscen.scene import Weather

_DRY = {"precipitation": "none", "precipitation_mm_h": 0.0}


def draw_weather(
    recipe: Recipe,
    told: tuple[Condition, ...],
    knowledge: Knowledge,
    limits: WeatherLimits,
    rng: np.random.Generator,
) -> tuple[Weather, Weather | None]:
    """Return the weather of a scene, and the ordinary weather where the weather is the hazard.

    Args:
        recipe: Of the hazard; its weather goes before what the text tells.
        told: Conditions that the text names, clear weather if none.
        knowledge: Knows what clear weather is.
        limits: What the simulator can show.
        rng: Draws from the ranges.
    """
    fields: dict[str, Any] = {}
    clear = knowledge.condition_keys.get("clear")
    layers = [clear.weather] if clear is not None else []
    layers += [
        c.weather for c in sorted(told, key=lambda c: c.weather.get("sun_elevation_deg", 0) != 0)
    ]
    for layer in (*layers, recipe.weather):
        fields.update(_drawn(layer, rng))
    dark = [c for c in told if _is_dark(c)]
    if dark and "sun_elevation_deg" not in recipe.weather:
        fields.update(_drawn({"sun_elevation_deg": dark[0].weather["sun_elevation_deg"]}, rng))
    weather = _shown(fields, limits)
    if not recipe.ordinary_weather:
        return weather, None
    ordinary = {**weather.model_dump(), **recipe.ordinary_weather}
    return weather, _shown(ordinary, limits)


def _is_dark(condition: Condition) -> bool:
    sun = condition.weather.get("sun_elevation_deg")
    return isinstance(sun, tuple) and sun[1] < 0.0


def _drawn(layer: Mapping[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    drawn: dict[str, Any] = {}
    for field in sorted(layer):
        value = layer[field]
        drawn[field] = value if isinstance(value, str) else round(float(rng.uniform(*value)), 2)
    return drawn


def _shown(fields: dict[str, Any], limits: WeatherLimits) -> Weather:
    """Bring weather within what can be shown."""
    kept = dict(fields)
    kinds = {"rain": limits.rain, "snow": limits.snow, "none": True}
    if not kinds[str(kept.get("precipitation", "none"))]:
        kept.update(_DRY)
    if kept.get("precipitation_mm_h"):
        kept["precipitation_mm_h"] = min(kept["precipitation_mm_h"], limits.intensity)
    if "fog_visual_range_m" in kept:
        kept["fog_visual_range_m"] = max(kept["fog_visual_range_m"], limits.fog_m)
    kept["friction"] = max(kept.get("friction", 1.0), limits.friction)
    if not limits.night:
        kept["sun_elevation_deg"] = max(kept.get("sun_elevation_deg", 45.0), 0.0)
    return Weather.model_validate(kept)
