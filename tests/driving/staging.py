"""Scenes and catalogues that the driving tests share."""

from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

CATALOGUE = FLAT_CATALOGUE


def actor(
    name: str,
    asset: str = "car",
    behaviour: str = "stand",
    *,
    ahead: float = 30.0,
    lane: int = 0,
    offset: float = 0.0,
    heading: float = 0.0,
    trigger: Trigger | None = None,
    **parameters: float,
) -> Actor:
    return Actor(
        id=name,
        asset=asset,
        placement=Placement(ahead_m=ahead, lane=lane, offset_m=offset, heading_deg=heading),
        behaviour=Behaviour(name=behaviour, trigger=trigger or Trigger(), parameters=parameters),
    )


def scene(
    *actors: Actor,
    map: str = "urban_avenue",
    speed: float = 10.0,
    lane: int = 0,
    friction: float = 1.0,
    hazard: Hazard | None = None,
    decision: Trigger | None = None,
) -> Scene:
    return Scene(
        id="test",
        scenario_id="test",
        map=map,
        ego=Ego(speed=speed, lane=lane),
        weather=Weather(friction=friction),
        actors=actors,
        hazard=hazard or Hazard(weather=Weather(cloud_cover=1.0)),
        decision=decision or Trigger(kind="time", value=1.0),
    )


def world(staged: Scene, seed: int = 0) -> KinematicWorld:
    corridor = load_corridor(CATALOGUE.map(staged.map))
    return KinematicWorld(corridor, staged, CATALOGUE, seed)
