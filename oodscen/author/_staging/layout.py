"""The layout of a scene, and the actors that are drawn for it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from oodscen.author._knowledge.base import Range, Recipe, RecipeActor
from oodscen.claims._things import Thing
from oodscen.data._scene import Actor, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._motion.behaviours.row import Course
from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.prompts._digest import AssetLine, CatalogueDigest, MapLine

_DIRECTIONS: Mapping[Course, float] = {"lane": 1.0, "against": -1.0}
"""Directions of courses along the road; oncoming lanes are ignored."""
_EYE_M, _FOCAL_PX = 1.4, 554.0
"""Height of the dash camera and its focal length."""


@dataclass(frozen=True)
class Layout:
    """Road, ego, weather and decision of a scene, with the recipe and the stream from which its actors are drawn."""

    digest: CatalogueDigest
    road: MapLine
    recipe: Recipe
    rng: np.random.Generator
    speed: float
    """Speed of the ego, m/s."""
    slowed: float
    """Factor on the speed of other vehicles if the road's limit slows the ego down."""
    ego_lane: int
    weather: Weather = field(default_factory=Weather)
    ordinary_weather: Weather | None = None
    """Weather of the twin, if the weather is the hazard."""
    named: tuple[Thing, ...] = ()
    """Things that the text names; an actor with several possible assets becomes one of these."""
    is_followed: bool = False
    """True if a vehicle drives close behind the ego."""
    escape: int = 0
    """Direction of the lane change if nothing else helps: 1 left, -1 right; 0 otherwise."""
    decision: Trigger = field(default_factory=Trigger)
    shift_m: float = 0.0
    """Displacement of the actors that are measured from the ego's start, along the road, m."""

    @cached_property
    def assets(self) -> Mapping[str, AssetLine]:
        """The assets of the catalogue by id and by other names."""
        return self.digest.by_name

    def draw(self, limits: Range) -> float:
        """Draw a value from a range."""
        return round(float(self.rng.uniform(*limits)), 2)

    def choose(self, options: tuple[str, ...], named: tuple[Thing, ...] | None = None) -> str:
        """Choose an asset that the simulator offers and the text may mean, by default by the things of the scene.

        Returns:
            Its id; the name itself if the simulator offers none.
        """
        offered = [option for option in options if option in self.assets] or list(options)
        fitting = _named_options(offered, self.assets, self.named if named is None else named)
        name = fitting[int(self.rng.integers(len(fitting)))]
        return self.assets[name].id if name in self.assets else name

    def has_lane(self, lane: int) -> bool:
        """Return whether the road has a lane, counted to the left of the ego's."""
        return 0 <= self.ego_lane + lane < self.road.lanes + self.road.oncoming_lanes

    def reach(self, actor: RecipeActor) -> float:
        """Return the largest half extent along the road of the assets that an actor may be, m."""
        return max((0.5 * along for along, _, _ in self._extents(actor)), default=0.0)

    def along(self, actor: RecipeActor) -> float:
        """Return an actor's mean speed along the ego's road, m/s; negative towards the ego."""
        limits = actor.parameters.get("speed", (0.0, 0.0))
        speed = self.speed if limits == "ego" else 0.5 * sum(limits)
        course = BUILT_IN[actor.behaviour].course if actor.behaviour in BUILT_IN else ""
        if course == "heading":
            return speed * math.cos(math.radians(0.5 * sum(actor.heading_deg)))
        return speed * _DIRECTIONS.get(course, 0.0)

    def pixels(self, actor: RecipeActor, distance_m: float) -> float:
        """Return the smallest area that an actor at a distance may cover in the dash camera's image, square pixels."""
        areas = (
            across * (height + _EYE_M * along / distance_m) * (_FOCAL_PX / distance_m) ** 2
            for along, across, height in self._extents(actor)
        )
        return min(areas, default=math.inf)

    def _extents(self, actor: RecipeActor) -> Iterator[tuple[float, float, float]]:
        """Yield length along the road, width across it and height of the assets that an actor may be, m."""
        heading = math.radians(0.5 * sum(actor.heading_deg))
        cosine, sine = abs(math.cos(heading)), abs(math.sin(heading))
        for name in actor.asset:
            if (asset := self.assets.get(name)) is not None:
                along = cosine * asset.length_m + sine * asset.width_m
                yield along, cosine * asset.width_m + sine * asset.length_m, asset.height_m


def _named_options(
    options: list[str], assets: Mapping[str, AssetLine], named: tuple[Thing, ...]
) -> list[str]:
    """Return the assets that a text names; all of them if it names none or all."""
    if len(options) < 2:
        return options
    by_thing = [
        [option for option in options if option in assets and thing.fits(assets[option])]
        for thing in named
    ]
    telling = [fitting for fitting in by_thing if 0 < len(set(fitting)) < len(set(options))]
    if not telling:
        return options
    common = [option for option in options if all(option in fitting for fitting in telling)]
    return common or [option for option in options if any(option in fitting for fitting in telling)]


class Cast(NamedTuple):
    """The actors of a scene."""

    actors: Sequence[Actor]
    unusual: Mapping[str, Actor | None]
    """The ordinary counterparts of the unusual actors, by id; `None` for plain removal."""

    @property
    def everyone(self) -> list[Actor]:
        """Actors and counterparts."""
        return [*self.actors, *filter(None, self.unusual.values())]

    @property
    def tied(self) -> set[str | None]:
        """Ids of the actors that tow or carry another."""
        return {actor.behaviour.other for actor in self.everyone}

    def joined_by(self, actors: Sequence[Actor]) -> "Cast":
        """Return the cast with further ordinary actors."""
        return self._replace(actors=[*self.actors, *actors])
