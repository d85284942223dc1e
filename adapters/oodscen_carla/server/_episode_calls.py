"""Calls about the server, its maps, the settings, the clock and the weather."""

from collections.abc import Callable
from typing import Any

from oodscen_carla._weather import WeatherParameters
from oodscen_carla.server import _values as read
from oodscen_carla.server._actors import ZERO
from oodscen_carla.server._streams import WORLD_STREAM, Streams
from oodscen_carla.server._world import World

VERSION = "0.9.16"
"""The version of CARLA whose protocol the server speaks."""
_ROAD_TAG = 1
"""CARLA's semantic tag of roads."""
_DOWNWARDS = -0.9
"""Vertical part of a direction, of 1, below which it points downwards."""


class EpisodeCalls:
    """Procedures that concern the whole world."""

    def __init__(self, world: World, streams: Streams, tick: Callable[[], int]) -> None:
        self._world, self._streams, self._tick = world, streams, tick

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
        earlier_ids = list(self._world.actors)
        self._world.load(read.text(name, "a map"), resets=read.flag(resets))
        for actor_id in earlier_ids:
            self._streams.drop(actor_id)

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

    def rpc_project_point(self, start: Any, direction: Any, distance: Any) -> list[Any]:
        """Return the road below a point; only rays downwards find something."""
        x, y, z = read.vector(start)
        reach = read.number(distance)
        ground = self._world.map.ground(x, -y)
        is_downwards = read.vector(direction)[2] < _DOWNWARDS
        if is_downwards and ground is not None and 0.0 <= z - ground.z <= reach:
            return [True, [[x, y, ground.z], _ROAD_TAG]]
        return [False, [list(ZERO), 0]]
