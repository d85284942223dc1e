"""The setting that a demand has to fit: the road, the ego, and the bodies that the rare scene puts before it."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np

from oodscen.data._bird_sketch import Sketch
from oodscen.data._catalogue import Asset, Catalogue, RoadMap
from oodscen.data._claim import Claim, Kind
from oodscen.data._scene import Actor, Behaviour, Placement, Scene, Trigger
from oodscen.driving._motion.behaviours.table import STAYS
from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.driving._roads.corridor import DRIVABLE, Corridor
from oodscen.driving._trace import Trace

CARS = ("car", "suv", "van", "taxi", "pickup")
"""Everyday cars, drawn from wherever a kind says no more."""
LARGE = ("truck", "bus", "van", "tanker")
LARGE_M2 = 4.5
"""Frontal area above which the rare scene's body is matched by a large vehicle, square metres."""
PEOPLE = ("adult", "elderly_person", "person_with_stroller", "adult", "child")

FRONT_M = 2.3
"""Distance from the ego's centre to its bumper, m."""
_FAR_M = 30.0
"""Distance of the body where the rare scene has none ahead, m."""
_IN_LANE_M = 1.7
"""Offset from the ego's way up to which a body is in its lane, m."""
_IN_SIGHT_M = 80.0
"""Distance up to which a body in the lane counts, m."""
_USUAL_AREA_M2 = 2.8
"""Frontal area where the rare scene has no body ahead: a car's."""
_LEAST_AREA_M2 = 0.5
_LANE_M = 3.5
"""Usual width of a lane, m."""
_NEAREST_M = 5.0
"""Distance ahead up to which a body counts as beside the ego, m."""
_HARDLY = 2e-4
"""Extent of a body that is hardly seen."""


class Draft(NamedTuple):
    """One drawn demand."""

    actors: Sequence[Actor]
    event: str
    """A clause in lower case that tells the event."""
    claims: Sequence[Claim]


class NearbyBodies(NamedTuple):
    """The number and the size in view of the bodies around the ego at the decision."""

    bodies: int
    extent: float
    """Sum of frontal area over squared distance of the bodies in view."""

    @classmethod
    def of(cls, bodies: Iterable[tuple[float, float, float]]) -> Self:
        """Return the look of bodies, given by distance ahead and to the left, m, and frontal area, square metres."""
        bodies = list(bodies)
        in_view = [
            area / (x * x + y * y) for x, y, area in bodies if x > _NEAREST_M and abs(y) < 0.5 * x
        ]
        return cls(len(bodies), sum(in_view) + _HARDLY)

    def difference(self, other: "NearbyBodies") -> float:
        """Return the logarithm of the factor by which two looks differ in number and in size."""
        number = math.log((1 + self.bodies) / (1 + other.bodies))
        size = math.log(self.extent / other.extent)
        return abs(number) + abs(size)


@dataclass(frozen=True)
class Setting:
    """The moment of a rare scene's decision, without its hazard."""

    scene: Scene
    catalogue: Catalogue
    decision_m: float
    """Distance from the ego's start to its place at the decision, along the road, m."""
    speed: float
    """The ego's speed at the decision, m/s."""
    decision_s: float
    gap_m: float
    """Distance of the nearest body that the rare scene puts in the lane at the decision, m."""
    area_m2: float
    """Frontal area of that body."""
    look: NearbyBodies
    """The look of the rare scene at the decision."""

    @classmethod
    def of(
        cls, scene: Scene, catalogue: Catalogue, trace: Trace, sketch: Sketch | None
    ) -> "Setting":
        """Return the setting of a scene, from its approach up to the decision and the sketch of the decision."""
        catalogue = catalogue.for_scene(scene)
        corridor = load_corridor(scene.map, catalogue)
        areas_m2 = {
            actor.id: _frontal_area_m2(catalogue.asset(actor.asset)) for actor in scene.actors
        }
        bodies = {
            name: body for name, body in (sketch.bodies if sketch else {}).items() if name != "ego"
        }
        ahead = [(body.x, name) for name, body in bodies.items() if body.x > 0.0]
        in_lane = [
            (x, name) for x, name in ahead if abs(bodies[name].y) < _IN_LANE_M and x < _IN_SIGHT_M
        ]
        unusual = [(x, name) for x, name in ahead if name in scene.hazard.actors]
        gap_m, nearest = min(in_lane or unusual, default=(_FAR_M, ""))
        return cls(
            scene=scene,
            catalogue=catalogue,
            decision_m=float(trace["s"][-1, 0]) - corridor.start,
            speed=float(trace["speed"][-1, 0]),
            decision_s=float(trace["time"][-1, 0]),
            gap_m=gap_m,
            area_m2=max(areas_m2.get(nearest, _USUAL_AREA_M2), _LEAST_AREA_M2),
            look=NearbyBodies.of(
                (body.x, body.y, areas_m2[name])
                for name, body in bodies.items()
                if name in areas_m2
            ),
        )

    def look_of(self, actors: Iterable[Actor]) -> NearbyBodies:
        """Return the look that actors will have at the decision, as far as their placements tell."""
        bodies = []
        for actor in actors:
            placement, behaviour = actor.placement, actor.behaviour
            speed = 0.0 if behaviour.name in STAYS else behaviour.parameters.get("speed", 0.0)
            ahead_m = placement.ahead_m + speed * self.decision_s - self.decision_m
            left_m = _LANE_M * placement.lane + placement.offset_m
            bodies.append((ahead_m, left_m, _frontal_area_m2(self.assets[actor.asset])))
        return NearbyBodies.of(bodies)

    @cached_property
    def corridor(self) -> Corridor:
        return load_corridor(self.scene.map, self.catalogue)

    @cached_property
    def road(self) -> RoadMap:
        return find_map(self.scene.map, self.catalogue)

    @property
    def lane(self) -> int:
        """The ego's lane, counted from the right."""
        return self.scene.ego.lane

    @property
    def lanes(self) -> int:
        return len(self.corridor.ego_lanes)

    @property
    def same_way_lanes(self) -> range:
        """The lanes that lead the ego's way, counted to the left from its own."""
        return range(-self.lane, self.lanes - self.lane)

    @cached_property
    def assets(self) -> dict[str, Asset]:
        """The assets by id and by other names."""
        return self.catalogue.by_name

    def has(self, *traits: str) -> bool:
        return not set(traits).isdisjoint(self.road.traits)

    def choose(self, rng: np.random.Generator, *options: str) -> str:
        """Draw one of the assets that the simulator has; empty if it has none of them."""
        fitting = [option for option in options if option in self.assets]
        return fitting[int(rng.integers(len(fitting)))] if fitting else ""

    def length(self, asset: str) -> float:
        return self.assets[asset].length

    def lane_offsets(self, ahead: float) -> list[float]:
        """Return the offset of every driving lane to the left of the ego's, m."""
        corridor, s = self.corridor, self.corridor.start + ahead
        centre = corridor.centre(corridor.ego_lanes[self.lane], s)
        return [corridor.centre(index, s) - centre for index in corridor.driving]

    def edge(self, ahead: float, side: int = -1) -> float:
        """Return the distance from the middle of the ego's lane to the right (-1) or left (1) edge of the asphalt, m."""
        corridor, s = self.corridor, self.corridor.start + ahead
        index = corridor.ego_lanes[self.lane]
        centre = corridor.centre(index, s)
        while 0 <= index + side < len(corridor.strips):
            if corridor.strips[index + side].kind not in DRIVABLE:
                break
            index += side
        strip = corridor.strips[index]
        edge = strip.right if side < 0 else strip.left
        return abs(float(edge[self._sample(s)]) - centre)

    def half_width(self, ahead: float) -> float:
        """Return half the width of the ego's lane, m."""
        corridor, s = self.corridor, self.corridor.start + ahead
        strip = corridor.strips[corridor.ego_lanes[self.lane]]
        sample = self._sample(s)
        return 0.5 * float(strip.left[sample] - strip.right[sample])

    def _sample(self, s: float) -> int:
        return min(max(round(s / self.corridor.step), 0), len(self.corridor.s) - 1)

    def braking_m(self, deceleration: float, to_speed: float = 0.0) -> float:
        """Return the distance in which the ego loses its speed at a deceleration, m."""
        return max(0.0, self.speed - to_speed) ** 2 / (2.0 * deceleration)

    def gap_to(
        self, half_length: float, spare_m: float, deceleration: float, to_speed: float = 0.0
    ) -> float:
        """Return the distance at the decision of the middle of a body in the lane, m.

        It is that of the rare scene's body, or more where the ego needs more to brake.

        Args:
            half_length: Half the length of the body, m.
            spare_m: Distance that remains before the ego's bumper, m.
            deceleration: Deceleration that the body may ask of the ego, m/s^2.
            to_speed: Speed of the body, m/s.
        """
        braking_m = self.braking_m(deceleration, to_speed)
        return max(self.gap_m, half_length + FRONT_M + spare_m + braking_m)


def _frontal_area_m2(asset: Asset) -> float:
    return asset.width * asset.height


def actor(
    name: str,
    asset: str,
    ahead_m: float,
    *,
    lane: int = 0,
    offset_m: float = 0.0,
    heading_deg: float = 0.0,
    behaviour: str = "stand",
    start_s: float = 0.0,
    state: str = "",
    **parameters: float,
) -> Actor:
    """Return an actor ahead of the ego's start, offset to the left of a lane's middle, and when its behaviour starts."""
    return Actor(
        id=name,
        asset=asset,
        placement=Placement(
            ahead_m=round(ahead_m, 2),
            lane=lane,
            offset_m=round(offset_m, 2),
            heading_deg=round(heading_deg, 1),
        ),
        behaviour=Behaviour(
            name=behaviour,
            trigger=Trigger(kind="time", value=round(max(0.0, start_s), 2)),
            parameters={key: round(value, 2) for key, value in parameters.items()},
        ),
        state=state,
    )


def standing_vehicle(name: str, asset: str, ahead_m: float, lane: int = 0) -> Actor:
    """Return a vehicle of the traffic in a lane that does not move."""
    return actor(name, asset, ahead_m, lane=lane, behaviour="follow_lane", speed=0.0)


def beside(lane: int) -> str:
    """Return the id of a vehicle beside the ego; the sum keeps lanes to the right free of a minus sign."""
    return f"beside{lane + 3}"


def demand(
    actors: Sequence[Actor], subject: str, quote: str, *facts: tuple[Kind, str], rest: str = ""
) -> Draft:
    """Return a demand whose event is the quote and the rest; the quote claims that the subject is there, and the facts."""
    present: tuple[Kind, str] = ("thing", "present")
    claims = [
        Claim(kind=kind, value=value, subject=subject, quote=quote)
        for kind, value in (present, *facts)
    ]
    return Draft(actors, f"{quote}{rest}", claims)


_NAMES = {
    "suv": "car",
    "pickup": "pickup truck",
    "truck": "lorry",
    "tanker": "tanker lorry",
    "garbage_truck": "refuse lorry",
    "cement_mixer": "concrete mixer",
    "camper": "camper van",
    "adult": "person",
    "elderly_person": "person",
    "person_with_stroller": "person",
}


def everyday_name(asset: str) -> str:
    """Return the noun by which a text names an asset."""
    return _NAMES.get(asset, asset.replace("_", " "))


def with_article(noun: str) -> str:
    """Return a noun after its indefinite article."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
