"""The kinds of demands, and the order in which they are tried for a scene."""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import RED_LIGHT, Actor, Scene
from oodscen.driving._motion.behaviours import having_effect
from oodscen.stages._demands.crossings import red_light, zebra
from oodscen.stages._demands.flow import cyclist, leader, queue, slow_vehicle
from oodscen.stages._demands.joining import ambulance, merging_car
from oodscen.stages._demands.kerbside import bus_stop, refuse_lorry, works
from oodscen.stages._demands.setting import Draft, Setting

_SHARPNESS = 0.6
"""Preference for kinds of the rare body's size; at 0 size does not count."""
_BRAKES, _JOINS = having_effect("brakes"), having_effect("joins")
_CROSSES = having_effect("crosses")


class DemandKind(NamedTuple):
    """One kind of demand."""

    id: str
    draw: Callable[[Setting, np.random.Generator], Draft | None]
    size_m2: float
    """Frontal area of what it puts before the ego."""
    weight: float = 1.0
    assets: tuple[str, ...] = ()
    """Assets by which a rare scene looks like this kind."""
    categories: tuple[str, ...] = ()
    """Categories of such assets."""
    does: tuple[str, ...] = ()
    """Behaviours of vehicles by which a rare scene looks like this kind."""

    def is_like(self, actors: Iterable[Actor], catalogue: Catalogue) -> bool:
        """Return whether unusual actors look like this kind."""
        known = {asset.id: asset.category for asset in catalogue.assets}
        return any(
            one.asset in self.assets
            or known.get(one.asset) in self.categories
            or (one.behaviour.name in self.does and self._is_one(known.get(one.asset, "")))
            for one in actors
        )

    def _is_one(self, category: str) -> bool:
        return category == ("pedestrian" if self.does == _CROSSES else "vehicle")


KINDS: tuple[DemandKind, ...] = (
    DemandKind("queue", queue, 3.0, 0.8, ("temporary_light",), (), ("stand", *_BRAKES)),
    DemandKind(RED_LIGHT, red_light, 1.5, 2.2, ("traffic_light", "pedestrian_light")),
    DemandKind("leader", leader, 3.0, 1.3, (), (), _BRAKES),
    DemandKind(
        "slow_vehicle",
        slow_vehicle,
        7.0,
        1.2,
        ("tractor", "forklift", "road_roller", "excavator", "cement_mixer"),
        (),
        ("follow_lane", *_BRAKES),
    ),
    DemandKind("cyclist", cyclist, 1.0, 1.4, (), ("cyclist",)),
    DemandKind("refuse_lorry", refuse_lorry, 8.0, 0.9, ("garbage_truck", "wheelie_bin")),
    DemandKind("bus_stop", bus_stop, 8.0, 1.0, ("bus", "school_bus")),
    DemandKind("works", works, 1.5, 0.8, ("excavator", "road_roller", "worker"), ("work_zone",)),
    DemandKind("zebra", zebra, 1.0, 2.4, (), ("pedestrian",), _CROSSES),
    DemandKind(
        "ambulance", ambulance, 5.0, 0.4, ("ambulance", "police_car", "fire_truck", "tow_truck")
    ),
    DemandKind("merging_car", merging_car, 3.0, 1.3, (), (), _JOINS),
)
"""All kinds."""


def in_turn(scene: Scene, at: Setting, rng: np.random.Generator) -> list[DemandKind]:
    """Return the kinds for a scene in the order in which they are tried.

    A kind that looks like the scene's own hazard is left out; the nearer a kind is to the rare body in size, the
    earlier it comes, by chance.
    """
    unusual = [one for one in scene.actors if one.id in scene.hazard.actors]
    fitting = [kind for kind in KINDS if not kind.is_like(unusual, at.catalogue)]
    waits = {
        kind.id: float(rng.exponential())
        / (kind.weight * math.exp(-_SHARPNESS * abs(math.log(kind.size_m2 / at.area_m2))))
        for kind in fitting
    }
    return sorted(fitting, key=lambda kind: waits[kind.id])
