"""Staging: from a text and a catalogue's digest to the draft of a scene, by recipe."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from oodscen.errors import LLMError
from oodscen.llms.author import approach
from oodscen.llms.author.company import company
from oodscen.llms.author.feasibility import WeatherLimits
from oodscen.llms.author.knowledge import (
    Counterpart,
    Hazard,
    Knowledge,
    Place,
    Range,
    Recipe,
    RecipeActor,
    RecipeTrigger,
    TrafficActor,
)
from oodscen.llms.author.lanes import settled, varied
from oodscen.llms.author.recognise import Recogniser
from oodscen.llms.author.weather import draw_weather
from oodscen.prompts import SceneDraft, StageScene
from oodscen.prompts.digest import CatalogueDigest, MapLine
from oodscen.scene import Actor, Behaviour, Ego, Placement, Trigger
from oodscen.scene import Hazard as Unusual
from oodscen.seeding import stream

_DISTANCE = re.compile(r"\b(\d{1,3})\s?(?:m|metres?|meters?)\b")
_LEAST_SPEED = 3.0
"""m/s"""
_LATE = 0.75
"""Share of late decisions where there is a distance from which only a change of lane helps."""
_URGENT = 0.55
"""Share of the others that come where emergency braking suffices and calm braking hardly does."""
_SMALL, _SEEN = 1.2, 45.0
"""m: what is less wide than the first is not made out from farther than the second."""
_ASIDE = 0.4
"""m by which an obstacle that calls for a change of lane lies on the other side of its lane."""
_INSIDE = 1.2
"""m from its lane's centre within which something is in the way."""
_SLOWED = frozenset({"vehicle", "cyclist"})
"""Categories whose speeds go down with the road's limit."""


@dataclass
class _Set:
    """What is known when the actors are placed."""

    digest: CatalogueDigest
    road: MapLine
    recipe: Recipe
    rng: np.random.Generator
    speed: float
    """Of the ego, m/s."""
    slowed: float
    """Factor on the speed of other vehicles, where the road's limit slows the ego down."""
    ego_lane: int
    escape: int = 0
    """Where only a change of lane helps its direction: 1 left, -1 right; 0 otherwise."""

    @property
    def ego(self) -> tuple[float, float]:
        """Its speed as a range."""
        return (self.speed, self.speed)

    def draw(self, limits: Range) -> float:
        return round(float(self.rng.uniform(*limits)), 2)

    def choose(self, options: tuple[str, ...]) -> str:
        offered = {asset.id for asset in self.digest.assets}
        fitting = [option for option in options if option in offered] or list(options)
        return fitting[int(self.rng.integers(len(fitting)))]


class Stager:
    """Answers `StageScene`."""

    def __init__(self, knowledge: Knowledge, recogniser: Recogniser) -> None:
        """Stage with the recipes of a knowledge base."""
        self.knowledge = knowledge
        self.recogniser = recogniser

    def stage(self, prompt: StageScene, seed: int, attempt: int) -> SceneDraft:
        """Set up a scene for a text.

        Args:
            prompt: The text and what the simulator offers.
            seed: Of the author.
            attempt: 0 at first; another attempt draws other values.

        Raises:
            LLMError: When the text shows nothing that the author can stage.
        """
        hazard = self._hazard(prompt)
        assert hazard.stage is not None
        recipe = varied(hazard.stage, prompt.text)
        rng = stream(seed, "stage", prompt.text, attempt)
        place = self._place(prompt.text, hazard, rng)
        road = _map_for(place, hazard, prompt.catalogue)
        told = self.recogniser.conditions(prompt.text, hazard)
        limits = WeatherLimits.of(prompt.catalogue.weather)
        weather, ordinary = draw_weather(recipe, told, self.knowledge, limits, rng)
        distance = _distance(prompt.text)
        recipe, lane = settled(recipe, road, prompt.text, rng)
        scene = _set(prompt.catalogue, road, recipe, place, lane, rng)
        shift, decision = _timing(scene, weather.friction, distance)
        recipe = scene.recipe
        actors: list[Actor] = []
        unusual: dict[str, Actor | None] = {}
        for part in recipe.actors:
            for actor, counterpart in _actors(part, scene, shift):
                actors.append(actor)
                if part.hazard:
                    unusual[actor.id] = counterpart
        traffic = self.recogniser.traffic(prompt.text)
        if traffic is not None and traffic.actor is not None and attempt < 2:
            actors += _traffic(traffic.actor, scene)
        if traffic is None and recipe.company and attempt < 2:
            decisive = decision.actor or next(iter(unusual), None)
            actors += company(
                self.knowledge.company,
                road,
                (scene.ego_lane, scene.speed),
                [*actors, *(twin for twin in unusual.values() if twin is not None)],
                (decision, decisive),
                rng,
                free=scene.escape,
            )
        if ordinary is None and not unusual:
            raise LLMError(f"the recipe for {hazard.label!r} has no hazard", model="builtin")
        return SceneDraft(
            reasoning=(
                f"The text is about: {hazard.label}. It fits {road.description}; the ego drives "
                f"at {scene.speed:g} m/s."
            ),
            map=road.id,
            ego=Ego(speed=scene.speed, lane=scene.ego_lane),
            weather=weather,
            actors=actors,
            hazard=Unusual(actors=unusual, weather=ordinary),
            decision=decision,
            horizon_s=recipe.horizon,
        )

    def _hazard(self, prompt: StageScene) -> Hazard:
        """Recognise the hazard from the text, or failing that from its kind."""
        hazard = self.recogniser.recognise(prompt.text).hazard
        if hazard is None and prompt.path:
            hazard, _ = self.recogniser.label(prompt.path[-1])
        if hazard is None:
            raise LLMError("the built-in author does not recognise the text", model="builtin")
        if hazard.stage is None:
            raise LLMError(
                f"the built-in author has no recipe to stage {hazard.label!r}", model="builtin"
            )
        return hazard

    def _place(self, text: str, hazard: Hazard, rng: np.random.Generator) -> Place:
        told = self.recogniser.place(text, hazard.places)
        if told is not None and told.key in hazard.places:
            return told
        fitting = [p for key in hazard.places for p in self.knowledge.place_keys.get(key, ())]
        if told is not None:
            alike = max(len(set(told.traits) & set(p.traits)) for p in fitting)
            fitting = [p for p in fitting if len(set(told.traits) & set(p.traits)) == alike]
        return fitting[int(rng.integers(len(fitting)))]


def _distance(text: str) -> float | None:
    found = _DISTANCE.search(text)
    return float(found.group(1)) if found else None


def _map_for(place: Place, hazard: Hazard, digest: CatalogueDigest) -> MapLine:
    """Return the map that shares most traits with the place."""
    needed = set(hazard.needs.traits)
    fitting = [road for road in digest.maps if needed <= set(road.traits)]
    if not fitting:
        raise LLMError("no map of the simulator fits the text", model="builtin")
    return max(fitting, key=lambda road: len(set(place.traits) & set(road.traits)))


def _set(
    digest: CatalogueDigest,
    road: MapLine,
    recipe: Recipe,
    place: Place,
    lane: int,
    rng: np.random.Generator,
) -> _Set:
    """Choose the ego's speed."""
    limits = place.speed if approach.scales(recipe) else recipe.speed
    wanted = round(float(rng.uniform(*limits)), 2)
    speed = round(min(wanted, road.speed_limit), 2)
    return _Set(
        digest=digest,
        road=road,
        recipe=recipe,
        rng=rng,
        speed=speed,
        slowed=speed / wanted,
        ego_lane=lane,
    )


def _timing(scene: _Set, friction: float, distance: float | None) -> tuple[float, Trigger]:
    """Return by how far all actors move along the road, and the decision's trigger.

    A distance in the text is where the scene starts: the decision comes later.
    """
    recipe, decision = scene.recipe, scene.recipe.decision
    value = scene.draw(decision.value)
    actor = approach.decisive(recipe)
    shift = 0.0
    if actor is not None and approach.scales(recipe):
        away = _room(scene, actor, friction)
        middle = 0.5 * sum(actor.ahead)
        value = away(scene.speed)
        if distance is not None:
            while scene.speed > _LEAST_SPEED and value + 0.7 * scene.speed > distance:
                scene.speed = round(0.95 * scene.speed, 2)
                value = away(scene.speed)
            value = min(value, max(distance - 2.0, 1.0))
            shift = distance - middle
        else:
            shift = value + scene.speed * float(scene.rng.uniform(1.6, 3.0)) - middle
    elif actor is not None and distance is not None:
        low, high = actor.ahead
        shift = min(max(distance, low), high) - 0.5 * (low + high)
    return round(shift, 2), Trigger(kind=decision.kind, value=round(value, 2), actor=decision.actor)


def _room(scene: _Set, actor: RecipeActor, friction: float) -> Callable[[float], float]:
    """Choose how much room the decision leaves, and return it as a function of the speed, m.

    There is room to stop calmly or to change lane; or just to brake hard; or, where the speed is
    such that this takes longer, just to change lane.
    """
    recipe, spare = scene.recipe, approach.spare(scene.recipe)
    late, urgent, share = (float(draw) for draw in scene.rng.random(3))
    is_inside = max(map(abs, actor.offset)) < _INSIDE
    if recipe.width and is_inside and late < _LATE and scene.road.lanes > 1:
        low = approach.swerving(scene.speed, recipe.width, _ASIDE)
        high = approach.braking(scene.speed, friction)
        if low + 0.5 <= high - 1.5:
            scene.escape = 1 if scene.ego_lane + 1 < scene.road.lanes else -1
            aside = -scene.escape * _ASIDE
            moved = actor.model_copy(update={"offset": (aside - 0.05, aside + 0.05)})
            actors = tuple(moved if a is actor else a for a in recipe.actors)
            scene.recipe = recipe.model_copy(update={"actors": actors})
            value = low + share * (high - 1.5 - low)
            return lambda speed: value
    is_unseen = 0.0 < recipe.width < _SMALL and approach.room(scene.speed) > _SEEN
    if urgent < _URGENT or is_unseen:
        return lambda speed: approach.braking(speed, friction) + (0.55 + 0.2 * share) * spare
    return lambda speed: approach.room(speed, friction) + (0.9 + 0.4 * share) * spare


def _actors(part: RecipeActor, scene: _Set, shift: float) -> list[tuple[Actor, Actor | None]]:
    """Draw an actor, or a row of them, each with its ordinary counterpart."""
    decides = approach.decisive(scene.recipe) is part
    low, high = part.ahead
    if shift and decides:
        low = high = 0.5 * (low + high)
    elif shift:
        middle = 0.5 * (low + high)
        low, high = middle - 0.25 * (high - low), middle + 0.25 * (high - low)
    first = scene.draw((low, high)) + shift
    aside, asset = scene.draw(part.offset), scene.choose(part.asset)
    lane = _lane(part.lane, scene)
    drawn = []
    for number, name in enumerate(part.names):
        actor = Actor(
            id=name,
            asset=asset if part.count == 1 else scene.choose(part.asset),
            placement=Placement(
                ahead_m=round(first + number * part.spread_ahead, 2),
                lane=lane,
                offset_m=round(aside + number * part.spread_offset, 2),
                heading_deg=scene.draw(part.heading_deg),
            ),
            behaviour=Behaviour(
                name=part.behaviour,
                trigger=_trigger(part.trigger, scene),
                parameters=_parameters(part.behaviour, part.parameters, scene, asset),
            ),
            state=_state(asset, part.state, scene.digest),
        )
        ordinary = part.ordinary
        counterpart = None if ordinary == "remove" else _ordinary(actor, ordinary, scene)
        drawn.append((actor, counterpart))
    return drawn


def _lane(options: tuple[int, ...], scene: _Set) -> int:
    """Choose a lane that the road has."""
    lanes = scene.road.lanes + scene.road.oncoming_lanes
    fitting = [lane for lane in options if 0 <= scene.ego_lane + lane < lanes] or list(options)
    return fitting[int(scene.rng.integers(len(fitting)))]


def _trigger(trigger: RecipeTrigger, scene: _Set) -> Trigger:
    return Trigger(kind=trigger.kind, value=scene.draw(trigger.value), actor=trigger.actor)


def _ordinary(actor: Actor, change: Counterpart, scene: _Set) -> Actor:
    """Return what stands in an actor's place in the ordinary twin."""
    old, behaviour = actor.placement, actor.behaviour
    name = change.behaviour or behaviour.name
    trigger = behaviour.trigger if name == behaviour.name else Trigger()
    if change.trigger is not None:
        trigger = _trigger(change.trigger, scene)
    asset = scene.choose(change.asset) if change.asset else actor.asset
    drawn: dict[str, Range | Literal["ego"]] = {}
    drawn.update((key, (value, value)) for key, value in behaviour.parameters.items())
    parameters = _parameters(name, drawn, scene)
    parameters.update(_parameters(name, change.parameters or {}, scene, asset))
    state = actor.state if change.state is None else change.state
    return Actor(
        id=actor.id,
        asset=asset,
        placement=Placement(
            ahead_m=old.ahead_m if change.ahead is None else scene.draw(change.ahead),
            lane=old.lane if change.lane is None else _there(change.lane, scene),
            offset_m=old.offset_m if change.offset is None else scene.draw(change.offset),
            heading_deg=(
                old.heading_deg if change.heading_deg is None else scene.draw(change.heading_deg)
            ),
        ),
        behaviour=Behaviour(name=name, trigger=trigger, parameters=parameters),
        state=_state(asset, state, scene.digest),
    )


def _there(lane: int, scene: _Set) -> int:
    """Return a lane that the road has: on the ego's other side, if there is none on this."""
    lanes = scene.road.lanes + scene.road.oncoming_lanes
    return lane if 0 <= scene.ego_lane + lane < lanes else -lane


def _parameters(
    name: str,
    limits: Mapping[str, Range | Literal["ego"]],
    scene: _Set,
    asset: str | None = None,
) -> dict[str, float]:
    """Draw the parameters that a behaviour has, within what the catalogue allows.

    Args:
        name: Of the behaviour.
        limits: Ranges to draw from; what the behaviour does not have is left out.
        scene: Gives the draws.
        asset: Whose speed goes down where the road's limit slows the ego down; `None` if it has.
    """
    category = next((line.category for line in scene.digest.assets if line.id == asset), "")
    line = next((b.parameters for b in scene.digest.behaviours if b.id == name), "")
    allowed = {
        key: (float(low), float(high))
        for key, low, high in re.findall(r"(\w+) (-?[\d.e+]+?)\.\.(-?[\d.e+]+) ", line)
    }
    drawn = {}
    for key, limit in limits.items():
        value = scene.draw(scene.ego if limit == "ego" else limit)
        if key not in allowed:
            continue
        if key == "speed" and limit != "ego" and category in _SLOWED:
            value = round(value * scene.slowed, 2)
        low, high = allowed[key]
        drawn[key] = min(max(value, low), high)
    return drawn


def _state(asset: str, state: str, digest: CatalogueDigest) -> str:
    known = next((line.states for line in digest.assets if line.id == asset), ())
    return state if state in known else ""


def _traffic(part: TrafficActor, scene: _Set) -> list[Actor]:
    """Add the ordinary road user that the text mentions, where the road has a lane for it."""
    left = scene.road.lanes - scene.ego_lane
    lane = left if part.side == "oncoming" else 1
    there = scene.road.oncoming_lanes > 0 if part.side == "oncoming" else left > 1
    if not there:
        return []
    return [
        Actor(
            id=part.id,
            asset=scene.choose(part.asset),
            placement=Placement(ahead_m=scene.draw(part.ahead), lane=lane),
            behaviour=Behaviour(
                name=part.behaviour,
                parameters=_parameters(part.behaviour, part.parameters, scene),
            ),
        )
    ]
