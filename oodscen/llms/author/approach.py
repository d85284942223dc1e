"""How fast the ego comes and how far away it must decide, for a recipe on a kind of road."""

from dataclasses import dataclass

from oodscen.llms.author.knowledge import Hazard, Place, Recipe, RecipeActor

_COMFORTABLE = 3.5
"""m/s^2: braking that most cars do without drama."""
_LANE_CHANGE_S = 2.4
"""s that a change of lane takes."""


@dataclass(frozen=True)
class Approach:
    """The ego's way towards what it meets."""

    speed: tuple[float, float]
    """m/s"""
    ahead: tuple[float, float]
    """m from the ego's start to the actor that the decision is about."""


def room(speed: float, friction: float = 1.0) -> float:
    """Return the distance in which a car can stop calmly or change lane, m."""
    return max(speed * speed / (2.0 * _COMFORTABLE * friction), _LANE_CHANGE_S * speed)


def spare(recipe: Recipe) -> float:
    """Return what a recipe's decision distance has beyond `room`, m."""
    low, high = recipe.speed
    return max(0.5 * sum(recipe.decision.value) - room(0.5 * (low + high)), 3.0)


def scales(recipe: Recipe) -> bool:
    """Tell whether a recipe may be played at the usual speed of any road: nothing in it moves."""
    return recipe.is_static and recipe.decision.kind == "distance"


def decisive(recipe: Recipe) -> RecipeActor | None:
    """Return the actor to which the decision is measured, else the first unusual one."""
    for actor in recipe.actors:
        if recipe.decision.actor in actor.names:
            return actor
    unusual = [actor for actor in recipe.actors if actor.hazard]
    return next(iter(unusual or recipe.actors), None)


def approach(hazard: Hazard, place: Place) -> Approach:
    """Return speeds and distances that suit a hazard on a kind of road."""
    recipe = hazard.stage
    if recipe is not None:
        actor = decisive(recipe)
        if actor is not None and not scales(recipe):
            return Approach(recipe.speed, actor.ahead)
        if actor is not None:
            speed = 0.5 * sum(place.speed)
            decision = room(speed) + spare(recipe)
            return Approach(place.speed, (decision + 1.6 * speed, decision + 3.0 * speed))
    speed = 0.5 * sum(place.speed)
    return Approach(place.speed, (3.5 * speed, 6.0 * speed))
