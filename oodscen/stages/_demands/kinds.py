"""The kinds of demands, and the order in which they are tried for a scene."""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from oodscen._seeding import stream
from oodscen.data._catalogue import Catalogue
from oodscen.data._category import Category
from oodscen.data._scene import RED_LIGHT, Actor, Scene
from oodscen.driving._motion.behaviours.off_centre import off_centre
from oodscen.driving._motion.behaviours.table import having
from oodscen.errors import DataError
from oodscen.stages._demands.crossings import red_light, zebra
from oodscen.stages._demands.flow import cyclist, leader, queue, slow_vehicle
from oodscen.stages._demands.joining import ambulance, merging_car
from oodscen.stages._demands.kerbside import bus_stop, refuse_lorry, works
from oodscen.stages._demands.setting import Draft, Setting

_ATTEMPTS = 2
"""Draws per kind that keep the scene's other traffic, and as many without it."""
_SHARPNESS = 4.0
"""Preference for draws that look like the rare scene; at 0 the look does not count."""
_BRAKES = having(lambda row: row.effect == "brakes")
_JOINS = having(lambda row: row.effect == "joins")
_CROSSES = having(lambda row: row.effect == "crosses")


class DemandKind(NamedTuple):
    """One kind of demand."""

    id: str
    draw: Callable[[Setting, np.random.Generator], Draft | None]
    weight: float
    """Preference for this kind over others."""
    assets: tuple[str, ...] = ()
    """Assets by which a rare scene looks like this kind."""
    categories: tuple[Category, ...] = ()
    """Categories of such assets."""
    behaviours: tuple[str, ...] = ()
    """Behaviours by which a rare scene looks like this kind, if actors of `category` have them."""
    category: Category = "vehicle"
    """Category of the actors whose behaviours count."""

    def is_like(self, actors: Iterable[Actor], catalogue: Catalogue) -> bool:
        """Return whether unusual actors look like this kind."""
        known = {asset.id: asset for asset in catalogue.assets}
        for actor in actors:
            asset = known.get(actor.asset)
            names = {actor.asset, *(asset.names if asset else ())}
            category = asset.category if asset else None
            if not names.isdisjoint(self.assets) or category in self.categories:
                return True
            if actor.behaviour.name in self.behaviours and category == self.category:
                return True
        return False

    def drawn(self, setting: Setting, rng: np.random.Generator) -> Draft | None:
        """Return a draw with its actors a little off the middle of their lanes, or `None` if the kind does not fit.

        Kinds name assets as the shipped ones are; actors get the ids of the catalogue.
        """
        try:
            draft = self.draw(setting, rng)
        except DataError:  # An actor would stand beyond what a scene can hold.
            return None
        if draft is None:
            return None
        actors = [
            actor.model_copy(update={"asset": setting.assets[actor.asset].id})
            for actor in draft.actors
        ]
        return draft._replace(actors=[off_centre(actor, rng) for actor in actors])


KINDS: tuple[DemandKind, ...] = (
    DemandKind("queue", queue, 0.8, assets=("temporary_light",), behaviours=("stand", *_BRAKES)),
    DemandKind(RED_LIGHT, red_light, 2.0, assets=("traffic_light", "pedestrian_light")),
    DemandKind("leader", leader, 1.3, behaviours=_BRAKES),
    DemandKind(
        "slow_vehicle",
        slow_vehicle,
        1.2,
        assets=("tractor", "forklift", "road_roller", "excavator", "cement_mixer"),
        behaviours=("follow_lane", *_BRAKES),
    ),
    DemandKind("cyclist", cyclist, 1.4, categories=("cyclist",)),
    DemandKind("refuse_lorry", refuse_lorry, 1.5, assets=("garbage_truck", "wheelie_bin")),
    DemandKind("bus_stop", bus_stop, 1.5, assets=("bus", "school_bus")),
    DemandKind(
        "works",
        works,
        1.0,
        assets=("excavator", "road_roller", "worker"),
        categories=("work_zone",),
    ),
    DemandKind(
        "zebra",
        zebra,
        2.4,
        categories=("pedestrian",),
        behaviours=_CROSSES,
        category="pedestrian",
    ),
    DemandKind(
        "ambulance",
        ambulance,
        0.6,
        assets=("ambulance", "police_car", "fire_truck", "tow_truck"),
    ),
    DemandKind("merging_car", merging_car, 1.3, behaviours=_JOINS),
)
"""All kinds."""


class Candidate(NamedTuple):
    """One draw of a kind."""

    kind: DemandKind
    draft: Draft
    company: tuple[Actor, ...]
    """Traffic of the rare scene that drives along."""

    @property
    def actors(self) -> tuple[Actor, ...]:
        return (*self.draft.actors, *self.company)


def ranked_candidates(
    scene: Scene, setting: Setting, seed: int, company: tuple[Actor, ...] = ()
) -> list[Candidate]:
    """Return draws of the kinds for a scene in the order in which they are tried.

    A kind that looks like the scene's own hazard is left out; the more alike a draw and the rare scene are in the
    number and the size of what stands before the ego, the earlier it comes, by chance. Otherwise how much there
    is to see would tell demands from rare scenes.
    """
    unusual = [actor for actor in scene.actors if actor.id in scene.hazard.actors]
    by_turn: list[tuple[bool, float, Candidate]] = []
    for kind in KINDS:
        if kind.is_like(unusual, setting.catalogue):
            continue
        for attempt in range(2 * _ATTEMPTS):
            rng = stream(seed, "demand", scene.id, kind.id, attempt)
            draft = kind.drawn(setting, rng)
            if draft is None:
                break
            is_alone = attempt >= _ATTEMPTS
            candidate = Candidate(kind, draft, () if is_alone else company)
            unlike = setting.look.difference(setting.look_of(candidate.actors))
            wait = float(rng.exponential()) / (kind.weight * math.exp(-_SHARPNESS * unlike))
            by_turn.append((is_alone, wait, candidate))
    by_turn.sort(key=lambda row: row[:2])
    return [candidate for _, _, candidate in by_turn]
