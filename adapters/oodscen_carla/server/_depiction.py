"""The scene and the bodies that pictures of the served world show."""

import math
import re
from collections.abc import Container, Iterable, Sequence
from typing import NamedTuple

from oodscen._words.wording import is_left_out
from oodscen.data import (
    Actor,
    Behaviour,
    Catalogue,
    Ego,
    Hazard,
    Placement,
    RoadMap,
    Scene,
    Trigger,
    Weather,
)
from oodscen_carla._lights import LAMPS_OF_STATE, VehicleLight
from oodscen_carla.server._actors import ServerActor
from oodscen_carla.server._cameras import PicturedBody, Pose
from oodscen_carla.server._values import Transform

_HEADLAMPS = VehicleLight.POSITION | VehicleLight.LOW_BEAM | VehicleLight.HIGH_BEAM
_BRAKING_MPS2 = -9.0
"""Acceleration at which every simulator shows brake lamps, m/s^2."""
_ROLE = re.compile(r"(?!(?:ego|default|autopilot|a\d+)$)[a-z0-9][a-z0-9_-]{0,40}")
"""Matches roles that can be the id of an actor in a scene, but for those that clients give to many vehicles."""


class LitVehicle(NamedTuple):
    """A client's vehicle with its lamps on."""

    name: str
    asset: str
    """Id of the asset that shows it."""


class Motion(NamedTuple):
    """The motion of one body of a staged scene."""

    pose: Pose
    speed: float
    acceleration: float
    """Along the heading, m/s^2."""


def name_of(role: str, actor_id: int, taken: Container[str]) -> str:
    """Return the name of a client's actor in pictures: its role, if that is telling and not taken."""
    is_telling = _ROLE.fullmatch(role) and not is_left_out(role)
    return role if is_telling and role not in taken else f"a{actor_id}"


def lit_vehicles(actors: Iterable[ServerActor]) -> tuple[LitVehicle, ...]:
    """Return every client's vehicle with its lamps on."""
    return tuple(
        LitVehicle(actor.name, actor.blueprint.asset.id)
        for actor in actors
        if actor.blueprint.asset is not None and actor.lights & _HEADLAMPS and not actor.staged
    )


def street_scene(road_map: RoadMap, catalogue: Catalogue) -> Scene:
    """Return a scene without a hazard, by which a simulator draws a road."""
    map_ids = {each.id for each in catalogue.maps}
    return Scene(
        id="carla",
        scenario_id="carla",
        map=road_map.id if road_map.id in map_ids else road_map.file,
        ego=Ego(speed=0.0),
        hazard=Hazard(weather=Weather()),
        decision=Trigger(),
    )


def pictured_scene(scene: Scene, weather: Weather, lit: Iterable[LitVehicle]) -> Scene:
    """Return a scene in a weather and with lit vehicles, for pictures only: it may hold more actors than others."""
    drivers = [
        Actor(
            id=vehicle.name,
            asset=vehicle.asset,
            placement=Placement(ahead_m=0.0),
            # Lamps are on in the dark for every behaviour but standing; those in a lane also hold the brake.
            behaviour=Behaviour(name="follow_route"),
        )
        for vehicle in lit
    ]
    return scene.model_copy(update={"weather": weather, "actors": (*scene.actors, *drivers)})


def staged_body(actor: ServerActor, motion: Motion) -> PicturedBody:
    """Return a body of the staged scene as pictures show it."""
    asset = actor.blueprint.asset
    assert asset is not None
    state = actor.attributes["state"]
    return PicturedBody(
        actor.id, actor.staged, asset, state, motion.pose, motion.speed, motion.acceleration
    )


def client_body(actor: ServerActor, place: Transform) -> PicturedBody:
    """Return a client's body, at its place in the world, as pictures show it."""
    asset = actor.blueprint.asset
    assert asset is not None
    x, y, z = place.location
    pose = (x, -y, z, -math.radians(place.rotation[1]))
    acceleration = actor.acceleration_along
    if actor.lights & VehicleLight.BRAKE:
        acceleration = min(acceleration, _BRAKING_MPS2)
    state = _state_of(actor, asset.states)
    return PicturedBody(actor.id, actor.name, asset, state, pose, actor.speed, acceleration)


def _state_of(actor: ServerActor, states: Sequence[str]) -> str:
    """Return the state that an actor shows: its blueprint's attribute, or that of its lights."""
    attribute = actor.attributes.get("state", "")
    if attribute in states:
        return attribute
    for state, lights in LAMPS_OF_STATE.items():
        if actor.lights & lights == lights and state in states:
            return state
    return ""
