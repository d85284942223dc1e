"""The kind of land around a road."""

from typing import Literal, cast, get_args

from oodscen.data._catalogue import RoadMap
from oodscen.driving._roads.corridor import Corridor

Theme = Literal["residential", "urban", "highway", "rural"]
"""Kinds of land; of several traits of one map, the first counts."""


def theme_of(road: RoadMap, corridor: Corridor) -> Theme:
    """Return the kind of land that a map's traits name; without any, urban by a pavement, else rural."""
    for theme in get_args(Theme):
        if theme in road.traits:
            return cast("Theme", theme)
    return "urban" if any(strip.kind == "sidewalk" for strip in corridor.strips) else "rural"
