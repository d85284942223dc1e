"""Calls that spawn, list and destroy actors."""

from collections.abc import Callable
from typing import Any

from oodscen_carla.server import _values as read
from oodscen_carla.server._actors import ZERO, ServerActor
from oodscen_carla.server._blueprints import CAMERAS
from oodscen_carla.server._sensors import camera_of
from oodscen_carla.server._streams import Streams
from oodscen_carla.server._world import SPECTATOR_ID, World


class ActorCalls:
    """Procedures about which actors there are."""

    def __init__(self, world: World, streams: Streams, log: Callable[[str], None]) -> None:
        self._world, self._streams, self._log = world, streams, log

    def rpc_get_actor_definitions(self) -> list[Any]:
        return self._world.library.definitions

    def rpc_get_spectator(self) -> list[Any]:
        return self._row(self._world.actors[SPECTATOR_ID])

    def rpc_get_actors_by_id(self, numbers: Any) -> list[Any]:
        actors = self._world.actors
        wanted = [read.whole(item) for item in read.items(numbers, "the ids", longest=10_000)]
        return [self._row(actors[number]) for number in wanted if number in actors]

    def rpc_get_actor_bounding_box(self, number: Any) -> list[Any]:
        # An error here would end the process of a client whose traffic manager asks.
        actor = self._world.actors.get(read.whole(number))
        return [list(ZERO)] * 3 + [0] if actor is None else actor.row(b"")[3]

    def rpc_spawn_actor(self, what: Any, place: Any) -> list[Any]:
        return self._row(self.spawn(what, place, 0))

    def rpc_spawn_actor_with_parent(
        self, what: Any, place: Any, parent: Any, attachment: Any = 0, socket: Any = ""
    ) -> list[Any]:
        return self._row(self.spawn(what, place, parent))

    def spawn(self, what: Any, place: Any, parent: Any) -> ServerActor:
        """Add an actor from the values of a call.

        Raises:
            CallError: If they are none, or there is no room for it.
        """
        described = read.description(what)
        if described.type_id in CAMERAS:
            camera_of({name: value for name, _, value in described.attributes})
        return self._world.spawn(described, read.transform(place), read.whole(parent))

    def rpc_destroy_actor(self, number: Any) -> bool:
        actor = self._world.actors.get(read.whole(number))
        if actor is not None and actor.staged:
            # An error would end scripts that clean up by destroying all vehicles.
            self._log(f"refused destroy_actor: actor {actor.id} belongs to the staged scene")
            return False
        gone = self._world.destroy(read.whole(number))
        for actor in gone:
            self._streams.drop(actor.id)
        return bool(gone)

    def rpc_get_sensor_token(self, stream: Any) -> list[bytes]:
        number = read.whole(stream)
        actor = self._world.actors.get(number)
        if actor is not None and actor.is_sensor:
            self._streams.expect(number)
        return [self._streams.token(number)]

    def _row(self, actor: ServerActor) -> list[Any]:
        return actor.row(self._streams.token(actor.id) if actor.is_sensor else b"")
