"""From where a recipe's actors are measured: the ego's start, a landmark of the map, another actor."""

from typing import get_args

from oodscen.author._knowledge.base import LandmarkName, Range, Recipe, RecipeActor
from oodscen.errors import LLMError
from oodscen.prompts._digest import MapLine
from oodscen.prompts._landmarks import Landmark

LANDMARKS: frozenset[str] = frozenset(get_args(LandmarkName))
"""What `RecipeActor.at` may name besides `start` and the ids of actors."""


def landmarks_needed(recipe: Recipe) -> tuple[str, ...]:
    """Return the kinds of landmarks that a recipe needs, in order."""
    return tuple(dict.fromkeys(actor.at for actor in recipe.actors if actor.at in LANDMARKS))


def has_landmarks(road: MapLine, recipe: Recipe | None) -> bool:
    """Tell whether a map has every landmark of a recipe."""
    there = {mark.kind for mark in road.landmarks} | set(road.somewhere)
    return recipe is None or there.issuperset(landmarks_needed(recipe))


def marks(road: MapLine, actor: RecipeActor) -> tuple[Landmark, ...]:
    """Return the landmarks at which an actor is placed: all lights, or the first of another kind.

    Raises:
        LLMError: When the map has none.
    """
    found = tuple(mark for mark in road.landmarks if mark.kind == actor.at)
    if not found:
        raise LLMError(f"{road.id} has no {actor.at.replace('_', ' ')}", model="builtin")
    return found if actor.at == "traffic_light" else found[:1]


def root(recipe: Recipe, actor: RecipeActor) -> RecipeActor:
    """Return the actor from which a chain of actors is measured; itself where it is the first."""
    by_id = {one.id: one for one in recipe.actors}
    while actor.at in by_id:
        actor = by_id[actor.at]
    return actor


def ahead_of_start(recipe: Recipe, actor: RecipeActor) -> Range | None:
    """Return how far ahead of the ego's start an actor is, m; `None` where the map decides."""
    by_id = {one.id: one for one in recipe.actors}
    low, high = actor.ahead
    while actor.at in by_id:
        actor = by_id[actor.at]
        low, high = low + actor.ahead[0], high + actor.ahead[1]
    return None if actor.at in LANDMARKS else (low, high)
