"""The remote procedures of CARLA 0.9.16 that this server answers; all others are refused by name."""

import inspect
from collections.abc import Callable
from typing import Any, Literal

from oodscen.errors import OodscenError
from oodscen_carla._weather import WeatherParameters
from oodscen_carla.server import _values as read
from oodscen_carla.server._actors import ZERO, ServerActor, VehicleControl, WalkerControl
from oodscen_carla.server._blueprints import CAMERAS
from oodscen_carla.server._commands import run_batch
from oodscen_carla.server._sensors import camera_of
from oodscen_carla.server._streams import WORLD_STREAM, Streams
from oodscen_carla.server._values import CallError, Transform
from oodscen_carla.server._vehicles import physics
from oodscen_carla.server._world import SPECTATOR_ID, World

VERSION = "0.9.16"
"""The version of CARLA whose protocol the server speaks."""

WITHOUT_EFFECT = frozenset(
    """
    apply_physics_control disable_sensor_for_ros draw_debug_shape enable_environment_objects
    enable_sensor_for_ros freeze_all_traffic_lights reset_all_traffic_lights set_actor_autopilot
    set_actor_collisions set_actor_dead set_actor_enable_gravity
    set_annotations_traverse_translucency set_pedestrians_cross_factor set_pedestrians_seed
    set_replayer_time_factor set_wheel_steer_direction show_vehicle_debug_telemetry
    update_day_night_cycle update_lights_state
    """.split()
)
"""Calls that are accepted and change nothing."""
EMPTY = frozenset(
    """
    cast_ray get_all_level_BBs get_environment_objects get_group_traffic_lights get_light_boxes
    get_names_of_all_objects get_required_files query_lights_state
    """.split()
)
"""Calls whose answer is an empty list: the served world has none of these things, or does not compute them."""
_ROAD_TAG = 1
"""CARLA's semantic tag of roads."""

Kind = Literal["", "vehicle", "walker"]
"""Beginning of the ids of an actor's blueprint; empty for any."""


class Calls:
    """Answers calls; see `answer`."""

    def __init__(
        self,
        world: World,
        streams: Streams,
        tick: Callable[[], int],
        log: Callable[[str], None],
    ) -> None:
        """Answer for a world.

        Args:
            world: The served world.
            streams: The streams of sensors.
            tick: Advances the world and returns the frame's number.
            log: Called with a line for every refusal.
        """
        self._world, self._streams, self._tick, self._log = world, streams, tick, log

    def answer(self, method: str, arguments: list[Any]) -> Any:
        """Return the response to a call, in the form that the client reads.

        Args:
            method: Name of the procedure.
            arguments: Its arguments; the first is the client's metadata.
        """
        try:
            if hasattr(self, f"rpc_{method}"):
                value = self.call(method, arguments[1:])
            elif method in WITHOUT_EFFECT:
                value = None
            elif method in EMPTY:
                value = []
            else:
                raise CallError(f"{method[:80]!r} is not supported by this server (oodscen)")
        except (CallError, OodscenError) as error:
            self._log(f"refused {method}: {error}")
            return refused(method, arguments, str(error))
        if method == "apply_batch":
            return value
        return [[False]] if value is None else [[1, value]]

    def call(self, method: str, arguments: list[Any]) -> Any:
        """Return the result of a procedure of this class.

        Raises:
            CallError: If the arguments do not fit.
        """
        function = getattr(self, f"rpc_{method}")
        try:
            inspect.signature(function).bind(*arguments)
        except TypeError as error:
            raise CallError(f"{method}: {error}") from None
        return function(*arguments)

    # ------------------------------------------------------------------ server and episode

    def rpc_version(self) -> str:
        return VERSION

    def rpc_get_available_maps(self) -> list[str]:
        return [f"/Game/Carla/Maps/{name}" for name in self._world.map_names]

    def rpc_get_episode_info(self) -> list[Any]:
        return [self._world.episode, [self._streams.token(WORLD_STREAM)]]

    def rpc_get_map_info(self) -> list[Any]:
        served = self._world.map
        points = [
            [list(spawn_point.location), list(spawn_point.rotation)]
            for spawn_point in served.spawn_points
        ]
        return [f"Carla/Maps/{served.name}", points]

    def rpc_get_map_data(self) -> str:
        return self._world.map.text

    def rpc_get_navigation_mesh(self) -> bytes:
        return b""

    def rpc_copy_opendrive_to_file(self, document: Any, parameters: Any) -> None:
        self._world.receive(read.text(document, "an OpenDRIVE document", 32 << 20))

    def rpc_load_new_episode(self, name: Any = "", resets: Any = True, layers: Any = 0) -> None:
        before = list(self._world.actors)
        self._world.load(read.text(name, "a map"), resets=read.flag(resets))
        for number in before:
            self._streams.drop(number)

    def rpc_get_episode_settings(self) -> list[Any]:
        return self._world.settings.wire()

    def rpc_set_episode_settings(self, settings: Any) -> int:
        self._world.settings = read.world_settings(settings)
        return self._world.frame

    def rpc_tick_cue(self) -> int:
        return self._tick()

    def rpc_get_weather_parameters(self) -> list[float]:
        return list(self._world.weather)

    def rpc_set_weather_parameters(self, weather: Any) -> None:
        values = read.items(weather, "the weather", len(WeatherParameters._fields))
        self._world.set_weather(WeatherParameters(*map(read.number, values)))

    # ------------------------------------------------------------------ actors

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

    def find(self, number: Any, doing: str, *, kind: Kind = "") -> ServerActor:
        """Return an actor.

        Args:
            number: Its id.
            doing: The purpose, for the message.
            kind: Beginning of its blueprint's id; any by default.

        Raises:
            CallError: If there is none, or it is of another kind.
        """
        actor = self._world.actors.get(read.whole(number))
        if actor is None:
            raise CallError(f"unable to {doing}: actor {number} not found")
        if kind and not actor.type_id.startswith(f"{kind}."):
            raise CallError(f"unable to {doing}: actor {actor.id} is no {kind}")
        return actor

    def _own(
        self, number: Any, doing: str, *, kind: Kind = "", or_ego: bool = False
    ) -> ServerActor:
        """Return an actor that the staged scene does not move.

        Args:
            number: Its id.
            doing: The purpose, for the message.
            kind: Beginning of its blueprint's id; any by default.
            or_ego: True if the scene's ego will do, too.

        Raises:
            CallError: If there is none, it is of another kind, or the scene moves it.
        """
        actor = self.find(number, doing, kind=kind)
        if actor.staged and not (or_ego and actor.staged == "ego"):
            raise CallError(f"unable to {doing}: actor {actor.id} is moved by the staged scene")
        return actor

    # ------------------------------------------------------------------ motion

    def rpc_set_actor_transform(self, number: Any, place: Any) -> None:
        actor = self._own(number, "set transform")
        actor.place, actor.is_placed = read.transform(place), True

    def rpc_set_actor_location(self, number: Any, location: Any) -> None:
        actor = self._own(number, "set location")
        actor.place = Transform(read.vector(location), actor.place.rotation)
        actor.is_placed = True

    def rpc_set_actor_simulate_physics(self, number: Any, enabled: Any) -> None:
        actor = self.find(number, "set simulate physics")
        actor.has_physics = read.flag(enabled)
        if not actor.has_physics and not actor.staged:
            actor.stop()

    def rpc_set_actor_target_velocity(self, number: Any, velocity: Any) -> None:
        given = read.vector(velocity)
        actor = self._own(number, "set target velocity", or_ego=True)
        self._world.set_target_velocity(actor, given)

    def rpc_set_actor_target_angular_velocity(self, number: Any, velocity: Any) -> None:
        self._own(number, "set target angular velocity").angular = read.vector(velocity)

    def rpc_enable_actor_constant_velocity(self, number: Any, velocity: Any) -> None:
        self._own(number, "enable constant velocity").constant_velocity = read.vector(velocity)

    def rpc_disable_actor_constant_velocity(self, number: Any) -> None:
        self._own(number, "disable constant velocity").constant_velocity = None

    def rpc_apply_control_to_vehicle(self, number: Any, control: Any) -> None:
        values = read.items(control, "a vehicle's control", 7)
        throttle, steer, brake, hand, reverse, manual, gear = values
        actor = self._own(number, "apply control", kind="vehicle", or_ego=True)
        actor.control = VehicleControl(
            _share(throttle, 0.0),
            _share(steer, -1.0),
            _share(brake, 0.0),
            read.flag(hand),
            read.flag(reverse),
            read.flag(manual),
            max(-100, min(100, int(read.number(gear)))),
        )

    def rpc_apply_control_to_walker(self, number: Any, control: Any) -> None:
        direction, speed, jump = read.items(control, "a walker's control", 3)
        walk = WalkerControl(read.vector(direction), read.number(speed), read.flag(jump))
        self._own(number, "apply control", kind="walker").walk = walk

    def rpc_set_vehicle_light_state(self, number: Any, state: Any) -> None:
        # A call sends a list of one number, and a command of a batch the number itself.
        (value,) = read.items(state, "a light state", 1) if isinstance(state, list) else (state,)
        actor = self._own(number, "set light state", kind="vehicle")
        actor.lights = read.whole(value, "a light state")

    def rpc_get_vehicle_light_state(self, number: Any) -> list[int]:
        return [self.find(number, "get light state", kind="vehicle").lights]

    def rpc_get_vehicle_light_states(self) -> list[list[int]]:
        every = self._world.actors.values()
        return [[actor.id, actor.lights] for actor in every if actor.is_vehicle]

    def rpc_get_physics_control(self, number: Any) -> list[Any]:
        return physics(self.find(number, "get physics control"))

    def rpc_project_point(self, start: Any, direction: Any, distance: Any) -> list[Any]:
        """Return the road below a point; only rays downwards find something."""
        x, y, z = read.vector(start)
        reach = read.number(distance)
        found = self._world.map.ground(x, -y)
        if read.vector(direction)[2] < -0.9 and found is not None and 0.0 <= z - found[0] <= reach:
            return [True, [[x, y, found[0]], _ROAD_TAG]]
        return [False, [list(ZERO), 0]]

    def rpc_apply_batch(self, commands: Any, ticks: Any) -> list[Any]:
        is_ticking = read.flag(ticks)
        answers = run_batch(self, commands)
        if is_ticking:
            self._tick()
        return answers

    # ------------------------------------------------------------------ traffic manager

    def rpc_is_traffic_manager_running(self, port: Any) -> bool:
        return False

    def rpc_get_traffic_manager_running(self, port: Any) -> list[Any]:
        return ["127.0.0.1", read.whole(port)]

    def rpc_add_traffic_manager_running(self, address: Any) -> bool:
        return True

    def rpc_destroy_traffic_manager(self, port: Any) -> bool:
        return True


def refused(method: str, arguments: list[Any], message: str) -> list[Any]:
    """Return the response to a call that failed; that to a batch has one for each command.

    Args:
        method: Name of the procedure.
        arguments: Its arguments; the first is the client's metadata.
        message: The reason.
    """
    response = [[0, [message]]]
    if method != "apply_batch":
        return response
    commands = arguments[1] if len(arguments) > 1 else None
    return [response] * (len(commands) if isinstance(commands, list) and commands else 1)


def _share(value: Any, least: float) -> float:
    return max(least, min(1.0, read.number(value)))
