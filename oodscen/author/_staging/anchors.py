"""Anchors of a recipe's actors: the ego's start, a landmark of the map, or another actor."""

from oodscen.author._knowledge.base import Range, Recipe, RecipeActor
from oodscen.data._catalogue import LANDMARKS
from oodscen.errors import LLMError
from oodscen.prompts._digest import MapLine
from oodscen.prompts._landmarks import Landmark


def landmarks_needed(recipe: Recipe) -> tuple[str, ...]:
    """Return the landmarks from which a recipe measures, each once."""
    return tuple(dict.fromkeys(actor.at for actor in recipe.actors if actor.at in LANDMARKS))


def has_landmarks(road: MapLine, recipe: Recipe | None) -> bool:
    """Return whether a map has the landmarks from which a recipe measures."""
    there = {mark.kind for mark in road.landmarks} | set(road.somewhere)
    return recipe is None or there.issuperset(landmarks_needed(recipe))


def marks(road: MapLine, actor: RecipeActor) -> tuple[Landmark, ...]:
    """Return the landmarks at which an actor is placed: all traffic lights, or the first landmark of another kind.

    Raises:
        LLMError: If the map has none.
    """
    landmarks = tuple(mark for mark in road.landmarks if mark.kind == actor.at)
    if not landmarks:
        raise LLMError(f"{road.id} has no {actor.at.replace('_', ' ')}", model="builtin")
    return landmarks if actor.at == "traffic_light" else landmarks[:1]


def anchors(recipe: Recipe, actor: RecipeActor) -> list[RecipeActor]:
    """Return an actor, the actor from which it is measured, and so on to the one that is measured from none."""
    by_id = {recipe_actor.id: recipe_actor for recipe_actor in recipe.actors}
    chain = [actor]
    while chain[-1].at in by_id:
        chain.append(by_id[chain[-1].at])
    return chain


def ahead_of_start(recipe: Recipe, actor: RecipeActor) -> Range | None:
    """Return an actor's distance ahead of the ego's start, m; `None` if it depends on the map."""
    chain = anchors(recipe, actor)
    if chain[-1].at in LANDMARKS:
        return None
    low, high = actor.ahead
    for recipe_actor in chain[1:]:
        low, high = low + recipe_actor.ahead[0], high + recipe_actor.ahead[1]
    return low, high
