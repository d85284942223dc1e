"""The lane of the ego, and its consequences for the actors that a recipe places."""

import re
from collections.abc import Mapping

import numpy as np

from oodscen._words.text import folded_words
from oodscen.author._knowledge.base import Counterpart, Drawn, Range, Recipe, RecipeActor
from oodscen.driving._motion.behaviours.table import BUILT_IN, having
from oodscen.prompts._digest import MapLine

_BESIDE_M = 2.0
"""Offset from a lane's centre beyond which an actor is beside the lane, m."""
_LANE_WIDTH_M = 3.5
_OTHER_LANE_SHARE = 0.75
"""Share of the scenes with the ego outside the rightmost lane, if the recipe permits it."""
_MIRRORED_SHARE = 0.5
"""Share of the scenes that are mirrored, if the recipe permits it."""
_REACHES_FARTHER = having(lambda row: row.reaches_farther)
_NAMES_LANE = re.compile(
    r"\b(?:left|right|nearside|offside|inside|outside|outer|inner|middle|centre|slow|fast|overtaking|"
    r"left-hand|right-hand|nearside \w+|kerbside|first|second|third) lane\b|"
    r"\blane (?:to|on) \w+ (?:left|right)\b",
    re.IGNORECASE,
)
_NAMES_SIDE = re.compile(
    r"\b(?:left|right|left-hand|right-hand|nearside|offside|shoulder|kerb|median|central)\b",
    re.IGNORECASE,
)


_SIDES = ("lanes", "lateral", "spin_deg")
"""Parameters of behaviours whose sign is a side."""
_OTHER_STATE = {
    "left": "right",
    "right": "left",
    "indicate_left": "indicate_right",
    "indicate_right": "indicate_left",
}


def with_variant(recipe: Recipe, text: str) -> Recipe:
    """Return a recipe with the changes of the first variant whose words occur in a text."""
    words = f" {folded_words(text)} "
    for variant in recipe.variants:
        if any(f" {folded_words(phrase)} " in words for phrase in variant.words):
            actors = tuple(_changed(actor, variant.actors.get(actor.id)) for actor in recipe.actors)
            return recipe.model_copy(update={"actors": actors})
    return recipe


def _changed(actor: RecipeActor, change: Counterpart | None) -> RecipeActor:
    if change is None:
        return actor
    fields = {
        name: getattr(change, name)
        for name in type(change).model_fields
        if getattr(change, name) is not None
    }
    if "lane" in fields:
        fields["lane"] = (fields["lane"],)
    if "parameters" in fields:
        fields["parameters"] = {**actor.parameters, **fields["parameters"]}
    return actor.model_copy(update=fields)


def with_ego_lane(
    recipe: Recipe, road: MapLine, text: str, rng: np.random.Generator
) -> tuple[Recipe, int]:
    """Choose the ego's lane for a recipe with placements for the rightmost one, unless the text names a lane or side.

    Returns:
        The recipe with placements for the chosen lane, and the lane, counted from the right.
    """
    fixed_lanes = [min(actor.lane) for actor in recipe.actors if len(actor.lane) == 1]
    least = max(0, -min(fixed_lanes, default=0))
    lane = min(least, road.lanes - 1)
    draw, other_lane = float(rng.random()), int(rng.integers(1, max(road.lanes, 2)))
    if recipe.ego_lane == "right" or road.lanes < 2 or _NAMES_LANE.search(text):
        return recipe, lane
    if recipe.ego_lane == "mirror":
        if draw >= _MIRRORED_SHARE or _NAMES_SIDE.search(text):
            return recipe, lane
        mirrored = tuple(map(_mirrored, recipe.actors))
        return recipe.model_copy(update={"actors": mirrored}), road.lanes - 1
    if recipe.ego_lane == "left":
        other_lane = road.lanes - 1
    elif draw >= _OTHER_LANE_SHARE:
        return recipe, lane
    actors = tuple(_at_the_kerb(actor, other_lane) for actor in recipe.actors)
    return recipe.model_copy(update={"actors": actors}), other_lane


def _at_the_kerb(actor: RecipeActor, lanes: int) -> RecipeActor:
    """Keep roadside objects in place for an ego some lanes further left.

    A pedestrian who crosses from the roadside has further to go, and starts earlier.
    """
    update: dict[str, object] = {}
    if actor.at == "start" and actor.lane == (0,) and max(actor.offset) < -_BESIDE_M:
        update["lane"] = (-lanes,)
        if actor.behaviour in _REACHES_FARTHER:
            further = _LANE_WIDTH_M * lanes
            low, high = _limits(actor, "distance", 12.0)
            update["parameters"] = {**actor.parameters, "distance": (low + further, high + further)}
            seconds = further / (0.5 * sum(_limits(actor, "speed", 1.4)))
            sooner = {"ttc": seconds, "distance": 10.0 * seconds}.get(actor.trigger.kind, 0.0)
            low, high = actor.trigger.value
            value = (low + sooner, high + sooner)
            update["trigger"] = actor.trigger.model_copy(update={"value": value})
    twin = actor.ordinary if isinstance(actor.ordinary, Counterpart) else Counterpart()
    is_aside = twin.lane is None and twin.offset is not None and max(twin.offset) < -_BESIDE_M
    if "lane" not in update and is_aside:
        update["ordinary"] = twin.model_copy(update={"lane": -lanes})
    return actor.model_copy(update=update)


def _limits(actor: RecipeActor, name: str, default: float) -> Range:
    limits = actor.parameters.get(name, (default, default))
    return (default, default) if limits == "ego" else limits


def _mirrored(actor: RecipeActor) -> RecipeActor:
    """Return an actor with left and right exchanged."""
    update: dict[str, object] = {
        "lane": tuple(-lane for lane in actor.lane),
        "offset": _negative(actor.offset),
        "heading_deg": _negative(actor.heading_deg),
        # Values are drawn in the order of the names, which stays that of the recipe.
        "parameters": _exchanged(
            {**actor.parameters, **_usual_sides(actor.behaviour), **actor.parameters}
        ),
        "spread_offset": -actor.spread_offset,
        "state": _OTHER_STATE.get(actor.state, actor.state),
    }
    twin = actor.ordinary
    if isinstance(twin, Counterpart):
        other = {
            "lane": None if twin.lane is None else -twin.lane,
            "offset": twin.offset and _negative(twin.offset),
            "heading_deg": twin.heading_deg and _negative(twin.heading_deg),
            "parameters": twin.parameters and _exchanged(twin.parameters),
            "state": twin.state and _OTHER_STATE.get(twin.state, twin.state),
        }
        update["ordinary"] = twin.model_copy(update=other)
    return actor.model_copy(update=update)


def _usual_sides(behaviour: str) -> dict[str, Drawn]:
    """Return the defaults of a behaviour's parameters whose sign is a side."""
    parameters = BUILT_IN[behaviour].kind.parameters if behaviour in BUILT_IN else {}
    usual = {name: parameters[name].default for name in _SIDES if name in parameters}
    return {name: (value, value) for name, value in usual.items()}


def _exchanged(parameters: Mapping[str, Drawn]) -> dict[str, Drawn]:
    """Return the parameters of a behaviour with left and right exchanged."""
    return {
        name: _negative(limits) if name in _SIDES and limits != "ego" else limits
        for name, limits in parameters.items()
    }


def _negative(limits: Range) -> Range:
    return (-limits[1], -limits[0])
