"""Placement of a recipe's actors on the road, each with its ordinary counterpart."""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from oodscen.author._knowledge.base import (
    Counterpart,
    Drawn,
    Range,
    Recipe,
    RecipeActor,
    RecipeTrigger,
    TrafficActor,
)
from oodscen.author._staging.anchors import marks
from oodscen.author._staging.decision_timing import decisive
from oodscen.claims._things import Thing
from oodscen.data._catalogue import LANDMARKS
from oodscen.data._details import Details
from oodscen.data._scene import Actor, Behaviour, Placement, Trigger
from oodscen.driving._motion.behaviour_row import Course
from oodscen.driving._motion.behaviours import BUILT_IN
from oodscen.prompts._digest import AssetLine, CatalogueDigest, MapLine

_SLOWED = frozenset({"vehicle", "cyclist"})
"""Categories whose speeds decrease with the road's speed limit."""
_DIRECTIONS: Mapping[Course, float] = {"lane": 1.0, "against": -1.0}
"""Directions of courses along the road; oncoming lanes are ignored."""
_EYE, _FOCAL = 1.4, 554.0
"""Height of the dash camera, m, and its focal length, pixels."""
_FARTHEST = 150.0
"""Largest lateral starting distance of crossing traffic, m."""


@dataclass
class SceneDraftState:
    """The state of a scene while its actors are placed."""

    digest: CatalogueDigest
    road: MapLine
    recipe: Recipe
    rng: np.random.Generator
    speed: float
    """Speed of the ego, m/s."""
    slowed: float
    """Factor on the speed of other vehicles if the road's limit slows the ego down."""
    ego_lane: int
    is_followed: bool = False
    """True if a vehicle drives close behind the ego."""
    escape: int = 0
    """Direction of the lane change if nothing else helps: 1 left, -1 right; 0 otherwise."""
    named: tuple[Thing, ...] = ()
    """Things that the text names; an actor with several possible assets becomes one of these."""
    placed: dict[str, Actor] = field(default_factory=dict)
    """The actors placed so far, by id in the recipe; for a row, its first actor."""

    def draw(self, limits: Range) -> float:
        """Draw a value from a range."""
        return round(float(self.rng.uniform(*limits)), 2)

    def choose(self, options: tuple[str, ...], named: tuple[Thing, ...] | None = None) -> str:
        """Choose an asset that the simulator offers and the text may mean, by default by the things of the scene."""
        offered = {asset.id: asset for asset in self.digest.assets}
        fitting = [option for option in options if option in offered] or list(options)
        fitting = _meant(fitting, offered, self.named if named is None else named)
        return fitting[int(self.rng.integers(len(fitting)))]

    def reach(self, actor: RecipeActor) -> float:
        """Return the largest half extent along the road of the assets that an actor may be, m."""
        heading = math.radians(0.5 * sum(actor.heading_deg))
        extents = [
            0.5 * (abs(math.cos(heading)) * one.length_m + abs(math.sin(heading)) * one.width_m)
            for one in self.digest.assets
            if one.id in actor.asset
        ]
        return max(extents, default=0.0)

    def along(self, actor: RecipeActor) -> float:
        """Return an actor's mean speed along the ego's road, m/s; negative towards the ego."""
        limits = actor.parameters.get("speed", (0.0, 0.0))
        speed = self.speed if limits == "ego" else 0.5 * sum(limits)
        course = BUILT_IN[actor.behaviour].course if actor.behaviour in BUILT_IN else ""
        if course == "heading":
            return speed * math.cos(math.radians(0.5 * sum(actor.heading_deg)))
        return speed * _DIRECTIONS.get(course, 0.0)

    def pixels(self, actor: RecipeActor, away: float) -> float:
        """Return the smallest area that an actor some metres away may cover in the dash camera's image, square pixels."""
        heading = math.radians(0.5 * sum(actor.heading_deg))
        cosine, sine = abs(math.cos(heading)), abs(math.sin(heading))
        areas = []
        for one in self.digest.assets:
            if one.id in actor.asset:
                across = cosine * one.width_m + sine * one.length_m
                along = cosine * one.length_m + sine * one.width_m
                standing = one.height_m + _EYE * along / away
                areas.append(across * standing * (_FOCAL / away) ** 2)
        return min(areas, default=math.inf)


def _meant(
    options: list[str], assets: Mapping[str, AssetLine], named: tuple[Thing, ...]
) -> list[str]:
    """Return the assets that a text names; all of them if it names none or all."""
    if len(options) < 2:
        return options
    chosen = [
        [option for option in options if option in assets and thing.fits(assets[option])]
        for thing in named
    ]
    exact = [found for found in chosen if 0 < len(set(found)) < len(set(options))]
    if not exact:
        return options
    common = [option for option in options if all(option in found for found in exact)]
    return common or [option for option in options if any(option in found for found in exact)]


class _AnchorSpot(NamedTuple):
    """The anchor from which an actor is measured."""

    ahead: float
    """Distance ahead of the ego's start, m."""
    lane: int
    offset: float


def cast(
    part: RecipeActor, scene: SceneDraftState, shift: float
) -> list[tuple[Actor, Actor | None]]:
    """Draw an actor, or a row of them, each with its ordinary counterpart; the first is recorded in `placed`.

    Actors that are measured from the ego's start are shifted along the road, m.
    """
    first = _ahead(part, scene, shift)
    aside, asset = scene.draw(part.offset), scene.choose(part.asset)
    lane = 0 if part.at in scene.placed else _lane(part.lane, scene)
    drawn = []
    spots = [spot for spot in _spots(part, scene) for _ in part.names]
    for number, (name, spot) in enumerate(zip(_names(part, len(spots)), spots, strict=True)):
        behaviour = Behaviour(
            name=part.behaviour,
            trigger=_trigger(part.trigger, scene),
            parameters=_parameters(part.behaviour, part.parameters, scene, asset),
            other=part.other,
        )
        heading = scene.draw(part.heading_deg)
        row = number if part.count > 1 else 0
        ahead = spot.ahead + first + row * part.spread_ahead
        offset = spot.offset + aside + row * part.spread_offset
        if part.meets is not None:
            offset = _away(scene, ahead, heading, behaviour, scene.draw(part.meets))
        actor = Actor(
            id=name,
            asset=asset if part.count == 1 else scene.choose(part.asset),
            placement=Placement(
                ahead_m=round(ahead, 2),
                lane=spot.lane + lane,
                offset_m=round(offset, 2),
                heading_deg=heading,
            ),
            behaviour=behaviour,
            state=_state(asset, part.state, scene.digest),
            details=_details(part.details, scene.digest),
        )
        scene.placed.setdefault(part.id, actor)
        ordinary = part.ordinary
        counterpart = None if ordinary == "remove" else _ordinary(actor, ordinary, scene, part)
        drawn.append((actor, counterpart))
    return drawn


def _names(part: RecipeActor, count: int) -> tuple[str, ...]:
    if count == len(part.names):
        return part.names
    return tuple(f"{part.id}-{number}" for number in range(1, count + 1))


def _ahead(part: RecipeActor, scene: SceneDraftState, shift: float) -> float:
    """Draw the distance of an actor ahead of its anchor; a shift narrows the range."""
    low, high = part.ahead
    if part.at != "start" or not shift:
        return scene.draw((low, high))
    middle = 0.5 * (low + high)
    share = 0.0 if decisive(scene.recipe) is part else 0.25
    reach = share * (high - low)
    return scene.draw((middle - reach, middle + reach)) + shift


def _spots(part: RecipeActor, scene: SceneDraftState) -> Iterator[_AnchorSpot]:
    if part.at in LANDMARKS:
        for mark in marks(scene.road, part):
            is_light = part.at == "traffic_light"
            yield _AnchorSpot(mark.ahead_m, -scene.ego_lane if is_light else 0, mark.left_m)
    elif part.at in scene.placed:
        place = scene.placed[part.at].placement
        yield _AnchorSpot(place.ahead_m, place.lane, place.offset_m)
    else:
        yield _AnchorSpot(0.0, 0, 0.0)


def _away(
    scene: SceneDraftState, ahead: float, heading_deg: float, behaviour: Behaviour, late: float
) -> float:
    """Return the lateral start of traffic that crosses some way ahead, late after the ego, s; m to the left.

    A positive heading comes from the right.
    """
    seconds = max(ahead / scene.speed + late, 0.5)
    away = min(behaviour.parameters.get("speed", 0.0) * seconds, _FARTHEST)
    return -away if heading_deg > 0.0 else away


def _lane(options: tuple[int, ...], scene: SceneDraftState) -> int:
    """Choose one of the lanes that the road has."""
    lanes = scene.road.lanes + scene.road.oncoming_lanes
    fitting = [lane for lane in options if 0 <= scene.ego_lane + lane < lanes] or list(options)
    return fitting[int(scene.rng.integers(len(fitting)))]


def _trigger(trigger: RecipeTrigger, scene: SceneDraftState) -> Trigger:
    return Trigger(kind=trigger.kind, value=scene.draw(trigger.value), actor=trigger.actor)


def _ordinary(
    actor: Actor, change: Counterpart, scene: SceneDraftState, part: RecipeActor
) -> Actor:
    """Return the counterpart of an actor in the ordinary twin."""
    old, behaviour = actor.placement, actor.behaviour
    name = change.behaviour or behaviour.name
    trigger = behaviour.trigger if name == behaviour.name else Trigger()
    if change.trigger is not None:
        trigger = _trigger(change.trigger, scene)
    asset = scene.choose(change.asset) if change.asset else actor.asset
    drawn: dict[str, Drawn] = {key: (one, one) for key, one in behaviour.parameters.items()}
    parameters = _parameters(name, drawn, scene)
    parameters.update(_parameters(name, change.parameters or {}, scene, asset))
    state = actor.state if change.state is None else change.state
    offset = old.offset_m if change.offset is None else scene.draw(change.offset)
    if part.meets is not None:
        offset = abs(offset) if old.offset_m > 0.0 else -abs(offset)
    return Actor(
        id=actor.id,
        asset=asset,
        placement=Placement(
            ahead_m=old.ahead_m if change.ahead is None else scene.draw(change.ahead),
            lane=old.lane if change.lane is None else _there(change.lane, scene),
            offset_m=offset,
            heading_deg=(
                old.heading_deg if change.heading_deg is None else scene.draw(change.heading_deg)
            ),
        ),
        behaviour=Behaviour(
            name=name,
            trigger=trigger,
            parameters=parameters,
            other=behaviour.other if name == behaviour.name else None,
        ),
        state=_state(asset, state, scene.digest),
    )


def _there(lane: int, scene: SceneDraftState) -> int:
    """Return a lane that the road has; if there is none on this side of the ego, one on the other."""
    lanes = scene.road.lanes + scene.road.oncoming_lanes
    return lane if 0 <= scene.ego_lane + lane < lanes else -lane


def _parameters(
    name: str,
    limits: Mapping[str, Drawn],
    scene: SceneDraftState,
    asset: str | None = None,
) -> dict[str, float]:
    """Draw the parameters that a behaviour has, within the limits of the catalogue; others are ignored.

    The speed of an asset is scaled down if the road's limit slows the ego down.
    """
    category = next((line.category for line in scene.digest.assets if line.id == asset), "")
    line = next((b.parameters for b in scene.digest.behaviours if b.id == name), "")
    allowed = {
        key: (float(low), float(high))
        for key, low, high in re.findall(r"(\w+) (-?[\d.e+]+?)\.\.(-?[\d.e+]+) ", line)
    }
    drawn = {}
    for key, limit in limits.items():
        value = scene.draw((scene.speed, scene.speed) if limit == "ego" else limit)
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


def _details(wanted: Details | None, digest: CatalogueDigest) -> Details | None:
    """Return the details of an actor, `None` if the simulator cannot show all of them."""
    if wanted is None:
        return None
    is_posed = not wanted.pose or wanted.pose in digest.poses
    return wanted if is_posed and set(wanted.parts) <= set(digest.parts) else None


def named_traffic(
    part: TrafficActor, scene: SceneDraftState, named: tuple[Thing, ...]
) -> list[Actor]:
    """Return the ordinary road user that the text mentions, if the road has a lane for it."""
    left = scene.road.lanes - scene.ego_lane
    lane = left if part.side == "oncoming" else 1
    there = scene.road.oncoming_lanes > 0 if part.side == "oncoming" else left > 1
    if not there:
        return []
    return [
        Actor(
            id=part.id,
            asset=scene.choose(part.asset, named),
            placement=Placement(ahead_m=scene.draw(part.ahead), lane=lane),
            behaviour=Behaviour(
                name=part.behaviour,
                parameters=_parameters(part.behaviour, part.parameters, scene),
            ),
        )
    ]
