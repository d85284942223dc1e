"""The served world: its map, weather, settings and actors, and what one tick does to them."""

import math
import tempfile
from collections.abc import Sequence
from functools import reduce
from pathlib import Path
from typing import Literal

from oodscen.data import Catalogue, Scene, Weather
from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.driving._roads.building import find_map
from oodscen.errors import OodscenError, UsageError
from oodscen_carla._blueprints import own_id
from oodscen_carla._catalogue import load_catalogue
from oodscen_carla._weather import WeatherParameters, from_carla, to_carla
from oodscen_carla.server._actors import ZERO, ServerActor
from oodscen_carla.server._blueprints import (
    FRICTION_TRIGGER,
    SPECTATOR,
    STRING,
    Blueprint,
    BlueprintLibrary,
)
from oodscen_carla.server._cameras import PicturedBody
from oodscen_carla.server._collisions import Pair, collide
from oodscen_carla.server._depiction import (
    Motion,
    client_body,
    lit_vehicles,
    name_of,
    pictured_scene,
    staged_body,
    street_scene,
)
from oodscen_carla.server._geometry import OrientedBox, mounted, rotated
from oodscen_carla.server._kinematics import FrictionBox, Surface, move
from oodscen_carla.server._roads import RECEIVED, ServedMap
from oodscen_carla.server._staging import HERO, ServedScene, carla_place
from oodscen_carla.server._values import (
    CallError,
    Description,
    Transform,
    Vector,
    WorldSettings,
)

STEP_S = 0.05
"""Duration of a tick without a fixed one, and the longest time that bodies move between checks for collisions, s."""
MAX_ACTORS = 2_000
SPECTATOR_ID = 23
"""Id of the spectator; actors follow."""
Kind = Literal["", "vehicle", "walker"]
"""Beginning of the id of an actor's blueprint; empty for any."""


class World:
    """All state that clients see and change; calls must not overlap."""

    def __init__(self, catalogue: Catalogue, scenes: Sequence[Scene] = (), seed: int = 0) -> None:
        """Open the first scene, or an empty street.

        Args:
            catalogue: The drawing simulator's catalogue.
            scenes: Scenes that clients can load by their ids.
            seed: Seed of motion, scenery and paints.

        Raises:
            SceneError: If the first scene cannot be staged.
            UsageError: If two things that can be loaded have one name.
        """
        _check_names([scene.id for scene in scenes], catalogue)
        self.catalogue = catalogue
        self.library = BlueprintLibrary(load_catalogue(), catalogue)
        self.scenes = {scene.id: scene for scene in scenes}
        self.seed = seed
        self.frame, self.time, self.episode = 0, 0.0, 0
        # Ids are never used again: a client returns to streams that it knew by their numbers.
        self._next_id = SPECTATOR_ID + 1
        self._folder = tempfile.TemporaryDirectory(prefix="oodscen-carla-")
        self._received: ServedMap | None = None
        self._drawn: tuple[object, Scene] | None = None
        self.settings = WorldSettings()
        self.weather = WeatherParameters()
        self._has_clients_weather = True
        self.staged: ServedScene | None = None
        self.collisions: dict[Pair, Vector] = {}
        """The vehicles and what they touch in this tick, with the impulse as they meet, N s."""
        self.map: ServedMap
        """The map of this episode."""
        self.actors: dict[int, ServerActor] = {}
        try:
            self.load(next(iter(self.scenes), catalogue.maps[0].id))
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Remove the files of received maps."""
        self._folder.cleanup()

    @property
    def map_names(self) -> list[str]:
        """The names that `load` knows."""
        return [*self.scenes, *_map_names(self.catalogue)]

    def receive(self, text: str) -> None:
        """Keep a client's OpenDRIVE document for the next `load` of `OpenDriveMap`.

        Raises:
            CallError: If the document cannot be used.
        """
        try:
            self._received = ServedMap.received(text, Path(self._folder.name), self.catalogue)
        except OodscenError as error:
            raise CallError(f"the OpenDRIVE map cannot be used: {error}") from None

    def load(self, name: str = "", *, resets: bool = True) -> None:
        """Begin a new episode.

        Args:
            name: Id of a scene or a map, `OpenDriveMap` for the received one; empty for the same again.
            resets: Whether the settings return to the defaults.

        Raises:
            CallError: If there is no such map.
            SceneError: If the scene cannot be staged.
        """
        short = name.rsplit("/", 1)[-1] or self.map.name
        staged = None
        if short in self.scenes:
            scene = self.scenes[short]
            staged = ServedScene(scene, self.catalogue, self.seed)
            served_map = ServedMap.of(find_map(scene.map, self.catalogue), short)
        elif short == RECEIVED and self._received is not None:
            served_map = self._received
        elif any(road.id == short and road.file for road in self.catalogue.maps):
            served_map = ServedMap.of(self.catalogue.map(short))
        else:
            raise CallError(f"no map {short[:80]!r}; get_available_maps() names all")
        self.map, self.staged = served_map, staged
        self.episode += 1
        self.actors = {SPECTATOR_ID: _spectator()}
        self.weather = WeatherParameters() if staged is None else to_carla(staged.scene.weather)
        self._has_clients_weather = staged is None
        if resets:
            self.settings = WorldSettings()
        if staged is not None:
            self._insert_bodies(staged)

    def _insert_bodies(self, staged: ServedScene) -> None:
        for name, asset, state in staged.world.bodies():
            role = HERO if name == "ego" else name
            blueprint = self.library[own_id(asset)]
            attributes = (("role_name", STRING, role), ("state", STRING, state))
            description = Description(0, blueprint.id, attributes)
            place = Transform(ZERO, ZERO)
            self._add(ServerActor(self._next_id, description, blueprint, place, staged=name))
        self._sync_staged_actors()

    def leave(self) -> list[int]:
        """Return to the map's beginning after the last client has gone; return the ids of the removed actors.

        Weather and map stay, because scripts that only set them end before the next one begins.
        """
        removed = list(self.actors)
        weather, is_clients = self.weather, self._has_clients_weather
        self.load()
        if is_clients:
            self.set_weather(weather)
        return removed

    def set_weather(self, weather: WeatherParameters) -> None:
        """Change the weather; in a staged scene its wetness is the road's friction, too."""
        self.weather, self._has_clients_weather = weather, True
        if self.staged is not None:
            self.staged.world.alter(friction=self.friction)

    @property
    def friction(self) -> float:
        """The road's friction: that of the scene, or that of the weather's wetness."""
        return self._shown_weather().friction

    def _shown_weather(self) -> Weather:
        """Return the scene's weather, or what a client has set since."""
        if self.staged is not None and not self._has_clients_weather:
            return self.staged.scene.weather
        return from_carla(self.weather)

    def scene(self) -> Scene:
        """Return the scene whose map, weather and lit vehicles the pictures show."""
        lit = lit_vehicles(self.actors.values())
        key = (self.episode, self.weather, lit)
        if self._drawn is None or self._drawn[0] != key:
            scene = (
                street_scene(self.map.road_map, self.catalogue)
                if self.staged is None
                else self.staged.scene
            )
            self._drawn = (key, pictured_scene(scene, self._shown_weather(), lit))
        return self._drawn[1]

    def spawn(self, description: Description, place: Transform, parent: int) -> ServerActor:
        """Add an actor; what is attached to another collides with nothing.

        Raises:
            CallError: If the blueprint, the parent or the room is missing.
        """
        if description.type_id not in self.library:
            name = description.type_id[:80]
            raise CallError(f"blueprint {name!r} is not supported by this server")
        if parent and parent not in self.actors:
            raise CallError("unable to attach actor: parent actor not found")
        if len(self.actors) >= MAX_ACTORS:
            raise CallError(f"this server holds at most {MAX_ACTORS} actors")
        blueprint = self.library[description.type_id]
        if blueprint.is_solid and not parent:
            box = OrientedBox(place, blueprint.extent)
            for other in self.actors.values():
                if other.is_obstacle and not other.parent and box.overlaps(other.box):
                    raise CallError("Spawn failed because of collision at spawn position")
        return self._add(ServerActor(self._next_id, description, blueprint, place, parent))

    def _add(self, actor: ServerActor) -> ServerActor:
        self._next_id += 1
        taken = {other.name for other in self.actors.values()}
        role = actor.attributes.get("role_name", "")
        actor.name = actor.staged or name_of(role, actor.id, taken)
        actor.spawned_at = self.time
        self.actors[actor.id] = actor
        return actor

    def find(self, actor_id: int, purpose: str, *, kind: Kind = "") -> ServerActor:
        """Return an actor.

        Args:
            actor_id: Its id.
            purpose: The purpose of the call, for the message.
            kind: Beginning of its blueprint's id; any by default.

        Raises:
            CallError: If there is none, or it is of another kind.
        """
        actor = self.actors.get(actor_id)
        if actor is None:
            raise CallError(f"unable to {purpose}: actor {actor_id} not found")
        if kind and not actor.type_id.startswith(f"{kind}."):
            raise CallError(f"unable to {purpose}: actor {actor.id} is no {kind}")
        return actor

    def destroy(self, actor_id: int) -> list[ServerActor]:
        """Remove an actor and everything that is attached to it, and return all of them.

        Raises:
            CallError: If it is the spectator.
        """
        if actor_id == SPECTATOR_ID:
            raise CallError("the spectator cannot be destroyed")
        removed, waiting = [], [actor_id]
        while waiting:
            actor = self.actors.pop(waiting.pop(), None)
            if actor is not None:
                removed.append(actor)
                waiting += [child.id for child in self.actors.values() if child.parent == actor.id]
        return removed

    def set_target_velocity(self, actor: ServerActor, velocity: Vector) -> None:
        """Give an actor a velocity, m/s; the ego of a staged scene takes the part along its heading."""
        ahead = rotated(velocity, -actor.place.rotation[1])[0]
        if actor.staged:
            assert self.staged is not None
            self.staged.set_speed(ahead)
        else:
            actor.set_velocity(velocity, ahead, self.step)

    def place_of(self, actor: ServerActor) -> Transform:
        """Return an actor's place in the world."""
        *attached, carrier = self._chain(actor)
        return reduce(mounted, (one.place for one in reversed(attached)), carrier.place)

    def carrier_of(self, actor: ServerActor) -> ServerActor:
        """Return the actor that an attached one moves with; itself if it is attached to none."""
        return self._chain(actor)[-1]

    def _chain(self, actor: ServerActor) -> list[ServerActor]:
        """Return an actor, what it is attached to, what that is attached to, and so on."""
        chain = [actor]
        while chain[-1].parent in self.actors:
            chain.append(self.actors[chain[-1].parent])
        return chain

    def bodies(self) -> list[PicturedBody]:
        """Return everything that pictures show, in right-handed axes; a staged scene's ego first."""
        motions = self._staged_motions()
        return [
            staged_body(actor, motions[actor.staged])
            if actor.staged
            else client_body(actor, self.place_of(actor))
            for actor in self.actors.values()
            if actor.blueprint.asset is not None
        ]

    def _staged_motions(self) -> dict[str, Motion]:
        """Return the exact motion of every body of the staged scene."""
        if self.staged is None:
            return {}
        world = self.staged.world
        poses = map(tuple, world.poses().tolist())
        rows = zip(poses, world.speeds().tolist(), world.accelerations().tolist(), strict=True)
        return {name: Motion(*row) for name, row in zip(world.ids, rows, strict=True)}

    @property
    def is_synchronous(self) -> bool:
        """True if only clients advance the world."""
        return self.settings.is_synchronous

    @property
    def step(self) -> float:
        """Duration of a tick, s."""
        return self.settings.fixed_step_s or STEP_S

    def picture_time(self, host: ServerActor | None) -> float:
        """Return the time since the scene began, or since the camera's vehicle was spawned, s.

        This clock drives rain and flashing lamps. For a vehicle that a client moves by hand, only the ticks
        in which it was placed count.
        """
        if self.staged is not None:
            return self.staged.world.time
        if host is not None and not host.has_physics and host.placings:
            return round((host.placings - 1) * self.step, 6)
        return round(self.time - host.spawned_at, 6) if host else 0.0

    def advance(self) -> None:
        """Move everything by one tick, in parts in which no vehicle passes through another."""
        self.frame += 1
        self.time += self.step
        for actor in self.actors.values():
            if actor.is_placed:
                actor.placings += 1
                actor.is_placed = False
        self.collisions = {}
        parts = max(1, math.ceil(self.step / STEP_S - ROUNDING_S))
        for _ in range(parts):
            # Only the first impulse counts: the next parts find what was hit standing.
            self.collisions = self._move(self.step / parts) | self.collisions

    def _move(self, dt: float) -> dict[Pair, Vector]:
        """Move everything for a time; return the contacts and their impulses."""
        before = {}
        boxes = [
            FrictionBox.of(actor, self.place_of(actor))
            for actor in self.actors.values()
            if actor.type_id == FRICTION_TRIGGER
        ]
        surface = Surface(self.map, self.friction, boxes)
        for actor in self.actors.values():
            if not actor.staged and actor.blueprint.is_solid:
                before[actor.id] = actor.place
                move(actor, surface, dt)
        if self.staged is not None:
            hero = next((actor for actor in self.actors.values() if actor.staged == "ego"), None)
            control = hero.control if hero else None
            # A scene waits for its script: nothing happens until it ticks or drives.
            if self.is_synchronous or control is not None:
                self.staged.advance(dt, control)
                self._sync_staged_actors()
        touched = set(self.staged.world.state().contacts if self.staged else ())
        return collide(self.actors.values(), before, touched)

    def _sync_staged_actors(self) -> None:
        motions = self._staged_motions()
        for actor in self.actors.values():
            if not actor.staged:
                continue
            motion = motions[actor.staged]
            actor.speed, actor.acceleration_along = motion.speed, motion.acceleration
            x, y, z, yaw = carla_place(motion.pose)
            actor.place = Transform((x, y, z), (0.0, yaw, 0.0))
            actor.velocity = rotated((actor.speed, 0.0, 0.0), yaw)
            actor.acceleration = rotated((actor.acceleration_along, 0.0, 0.0), yaw)


def _map_names(catalogue: Catalogue) -> list[str]:
    return [road.id for road in catalogue.maps if road.file]


def _check_names(scenes: Sequence[str], catalogue: Catalogue) -> None:
    taken = {RECEIVED, *_map_names(catalogue)}
    for name in scenes:
        if name in taken:
            raise UsageError(f"two maps are called {name!r}")
        taken.add(name)


def _spectator() -> ServerActor:
    blueprint = Blueprint(SPECTATOR, ())
    return ServerActor(
        SPECTATOR_ID, Description(0, SPECTATOR, ()), blueprint, Transform(ZERO, ZERO)
    )
