"""Calls that spawn, list and destroy actors."""

from collections.abc import Callable
from typing import Any

from oodscen_carla.server import _values as read
from oodscen_carla.server._actors import ZERO, ServerActor
from oodscen_carla.server._blueprints import CAMERAS
from oodscen_carla.server._sensors import camera_of
from oodscen_carla.server._streams import Streams
from oodscen_carla.server._values import CallError
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
        ids = [read.whole(number) for number in read.items(numbers, "the ids", longest=10_000)]
        return [self._row(actors[actor_id]) for actor_id in ids if actor_id in actors]

    def rpc_get_actor_bounding_box(self, number: Any) -> list[Any]:
        # An error here would end the process of a client whose traffic manager asks.
        actor = self._world.actors.get(read.whole(number))
        return [list(ZERO)] * 3 + [0] if actor is None else actor.row(b"")[3]

    def rpc_spawn_actor(self, description: Any, place: Any) -> list[Any]:
        return self._row(self.spawn(description, place, 0))

    def rpc_spawn_actor_with_parent(
        self, description: Any, place: Any, parent: Any, attachment: Any = 0, socket: Any = ""
    ) -> list[Any]:
        if parent == 0:
            raise CallError("unable to attach actor: parent actor not found")
        return self._row(self.spawn(description, place, parent))

    def spawn(self, description: Any, place: Any, parent: Any) -> ServerActor:
        """Add an actor from the values of a call.

        Raises:
            CallError: If the values do not describe one, or there is no room for it.
        """
        checked = read.description(description)
        if checked.type_id in CAMERAS:
            camera_of({name: value for name, _, value in checked.attributes})
        return self._world.spawn(checked, read.transform(place), read.whole(parent))

    def rpc_destroy_actor(self, number: Any) -> bool:
        actor_id = read.whole(number)
        actor = self._world.actors.get(actor_id)
        if actor is not None and actor.staged:
            # An error would end scripts that clean up by destroying all vehicles.
            self._log(f"refused destroy_actor: actor {actor_id} belongs to the staged scene")
            return False
        removed = self._world.destroy(actor_id)
        for one in removed:
            self._streams.drop(one.id)
        return bool(removed)

    def rpc_get_sensor_token(self, stream: Any) -> list[bytes]:
        actor_id = read.whole(stream)
        actor = self._world.actors.get(actor_id)
        if actor is not None and actor.is_sensor:
            self._streams.expect(actor_id)
        return [self._streams.token(actor_id)]

    def _row(self, actor: ServerActor) -> list[Any]:
        return actor.row(self._streams.token(actor.id) if actor.is_sensor else b"")
