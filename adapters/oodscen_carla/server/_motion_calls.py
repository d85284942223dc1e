"""Calls that move actors, control them, and switch their lights."""

from typing import Any

from oodscen_carla.server import _values as read
from oodscen_carla.server._actors import ServerActor, VehicleControl, WalkerControl
from oodscen_carla.server._values import CallError, Transform
from oodscen_carla.server._vehicles import physics
from oodscen_carla.server._world import Kind, World

_HIGHEST_GEAR = 100


class MotionCalls:
    """Procedures about what actors do."""

    def __init__(self, world: World) -> None:
        self._world = world

    def _client_actor(
        self, number: Any, purpose: str, *, kind: Kind = "", or_ego: bool = False
    ) -> ServerActor:
        """Return an actor that the staged scene does not move.

        Args:
            number: Its id.
            purpose: The purpose of the call, for the message.
            kind: Beginning of its blueprint's id; any by default.
            or_ego: True if the scene's ego will do, too.

        Raises:
            CallError: If there is none, it is of another kind, or the scene moves it.
        """
        actor = self._world.find(read.whole(number), purpose, kind=kind)
        if actor.staged and not (or_ego and actor.staged == "ego"):
            raise CallError(f"unable to {purpose}: actor {actor.id} is moved by the staged scene")
        return actor

    def rpc_set_actor_transform(self, number: Any, place: Any) -> None:
        actor = self._client_actor(number, "set transform")
        actor.place, actor.is_placed = read.transform(place), True

    def rpc_set_actor_location(self, number: Any, location: Any) -> None:
        actor = self._client_actor(number, "set location")
        actor.place = Transform(read.vector(location), actor.place.rotation)
        actor.is_placed = True

    def rpc_set_actor_simulate_physics(self, number: Any, enabled: Any) -> None:
        actor = self._world.find(read.whole(number), "set simulate physics")
        actor.has_physics = read.flag(enabled)
        if not actor.has_physics and not actor.staged:
            actor.stop()

    def rpc_set_actor_target_velocity(self, number: Any, velocity: Any) -> None:
        vector = read.vector(velocity)
        actor = self._client_actor(number, "set target velocity", or_ego=True)
        self._world.set_target_velocity(actor, vector)

    def rpc_set_actor_target_angular_velocity(self, number: Any, velocity: Any) -> None:
        self._client_actor(number, "set target angular velocity").angular = read.vector(velocity)

    def rpc_enable_actor_constant_velocity(self, number: Any, velocity: Any) -> None:
        self._client_actor(number, "enable constant velocity").constant_velocity = read.vector(
            velocity
        )

    def rpc_disable_actor_constant_velocity(self, number: Any) -> None:
        self._client_actor(number, "disable constant velocity").constant_velocity = None

    def rpc_apply_control_to_vehicle(self, number: Any, control: Any) -> None:
        values = read.items(control, "a vehicle's control", 7)
        throttle, steer, brake, hand_brake, reverse, manual, gear = values
        actor = self._client_actor(number, "apply control", kind="vehicle", or_ego=True)
        actor.control = VehicleControl(
            _share(throttle, 0.0),
            _share(steer, -1.0),
            _share(brake, 0.0),
            read.flag(hand_brake),
            read.flag(reverse),
            read.flag(manual),
            max(-_HIGHEST_GEAR, min(_HIGHEST_GEAR, int(read.number(gear)))),
        )

    def rpc_apply_control_to_walker(self, number: Any, control: Any) -> None:
        direction, speed, jump = read.items(control, "a walker's control", 3)
        walk = WalkerControl(read.vector(direction), read.number(speed), read.flag(jump))
        self._client_actor(number, "apply control", kind="walker").walk = walk

    def rpc_set_vehicle_light_state(self, number: Any, state: Any) -> None:
        # A call sends a list of one number, and a command of a batch the number itself.
        (value,) = read.items(state, "a light state", 1) if isinstance(state, list) else (state,)
        actor = self._client_actor(number, "set light state", kind="vehicle")
        actor.lights = read.whole(value, "a light state")

    def rpc_get_vehicle_light_state(self, number: Any) -> list[int]:
        return [self._world.find(read.whole(number), "get light state", kind="vehicle").lights]

    def rpc_get_vehicle_light_states(self) -> list[list[int]]:
        actors = self._world.actors.values()
        return [[actor.id, actor.lights] for actor in actors if actor.is_vehicle]

    def rpc_get_physics_control(self, number: Any) -> list[Any]:
        return physics(self._world.find(read.whole(number), "get physics control"))


def _share(value: Any, least: float) -> float:
    return max(least, min(1.0, read.number(value)))
