"""Unusual things beside the ego's lane, which need no reaction: their wording and their place."""

import math
import re
from collections.abc import Mapping

from oodscen.author._knowledge.base import HazardKind, Recipe, RecipeActor
from oodscen.author._reading import phrases
from oodscen.prompts._digest import AssetLine

ASIDE_SHARE = 0.9
"""Share of the events set beside the lane, of those that could be."""
_IN_LANE = re.compile(
    r"\b(?:right )?(?:in|across|over|on|into) (?:the middle of )?(?:the ego's lane|the path of the ego vehicle)\b"
)
_CLOSES = re.compile(
    r"\b(?:block\w*|clos\w+|cover\w*|fill\w*|half|both|middle|hide\w*|stick\w*|hang\w*|dangl\w+|must|"
    r"stop|spread\w*|rolled|runs?|cuts?|opened|room|reach\w*|lanes)\b"
)
"""Words of events that make no sense beside the lane."""
_ASIDE = "beside the ego's lane"
_HALF_LANE_M = 1.9
"""Half the width of a lane, m."""
_USUAL_HALF_WIDTH_M = 0.5
"""Half the width of a thing that the catalogue does not have, m."""
_ROOM_M = (0.35, 0.75)
"""Room between the edge of the lane and a thing beside it, m."""
_WIDE = frozenset(
    "fallen_tree fallen_pole spilled_logs spilled_gravel flood_water overturned_truck trailer tram".split()
)
"""Assets for which there is no room beside the lane."""
_SPREAD_M = 1.5
"""Width of a row up to which there is room for it, m."""
_INSIDE_M = 1.2
"""Offset from the lane's centre up to which a thing counts as in the lane, m."""


def may_be_aside(hazard: HazardKind) -> bool:
    """Return whether a hazard is one thing that stands still in the lane and has no ordinary counterpart."""
    recipe = hazard.stage
    if recipe is None or not recipe.is_static:
        return False
    return all(_is_movable(actor) for actor in recipe.actors) and len(recipe.actors) == 1


def _is_movable(actor: RecipeActor) -> bool:
    """Return whether a plain and narrow thing lies in the lane."""
    is_plain = actor.at == "start" and actor.ordinary == "remove" and not actor.state
    is_narrow = not _WIDE & set(actor.asset) and abs(actor.spread_offset) * actor.count < _SPREAD_M
    is_in_lane = actor.lane == (0,) and max(map(abs, actor.offset)) <= _INSIDE_M
    return is_plain and is_narrow and is_in_lane


def event_aside(event: str) -> str:
    """Return an event with its thing beside the ego's lane; empty if the wording does not allow it."""
    match = _IN_LANE.search(event)
    if match is None:
        return ""
    rest = f"{event[: match.start()]}|{event[match.end() :]}"
    if _CLOSES.search(rest) or "lane" in rest or "path" in rest:
        return ""
    return f"{event[: match.start()]}{_ASIDE}{event[match.end() :]}"


def recipe_aside(recipe: Recipe, text: str, assets: Mapping[str, AssetLine]) -> Recipe:
    """Return the recipe with its thing to the right of the lane if the text says so."""
    if (
        not phrases.context("beside_lane").search(text)
        or len(recipe.actors) != 1
        or not _is_movable(recipe.actors[0])
    ):
        return recipe
    (actor,) = recipe.actors
    half_widths = [_half_width_m(actor, assets[name]) for name in actor.asset if name in assets]
    half_width = max(half_widths, default=_USUAL_HALF_WIDTH_M)
    half_width += max(actor.spread_offset, 0.0) * (actor.count - 1)
    low, high = (-(_HALF_LANE_M + half_width + room) for room in reversed(_ROOM_M))
    moved = actor.model_copy(update={"offset": (low, high)})
    return recipe.model_copy(update={"actors": (moved,), "ego_lane": "right", "width": 0.0})


def _half_width_m(actor: RecipeActor, asset: AssetLine) -> float:
    """Return the largest half extent across the road, m."""
    turns = [math.radians(turn) for turn in actor.heading_deg]
    return max(
        0.5 * (abs(math.sin(turn)) * asset.length_m + abs(math.cos(turn)) * asset.width_m)
        for turn in turns
    )
