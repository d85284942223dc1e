"""The remote procedures of CARLA 0.9.16 that this server answers; all others are refused by name."""

import inspect
from collections.abc import Callable
from typing import Any, NamedTuple

from oodscen.errors import OodscenError
from oodscen_carla.server import _values as read
from oodscen_carla.server._actor_calls import ActorCalls
from oodscen_carla.server._commands import run_batch
from oodscen_carla.server._episode_calls import EpisodeCalls
from oodscen_carla.server._motion_calls import MotionCalls
from oodscen_carla.server._streams import Streams
from oodscen_carla.server._traffic_manager_calls import TrafficManagerCalls
from oodscen_carla.server._values import CallError
from oodscen_carla.server._world import World

WITHOUT_EFFECT = frozenset(
    """
    apply_physics_control draw_debug_shape reset_all_traffic_lights set_actor_autopilot
    set_actor_collisions set_actor_enable_gravity set_pedestrians_cross_factor set_pedestrians_seed
    set_wheel_steer_direction update_day_night_cycle update_lights_state
    """.split()
)
"""Calls that are accepted and change nothing, since scripts make them as they begin."""
EMPTY = frozenset({"get_required_files", "query_lights_state"})
"""Calls of the client as it connects, whose answer is an empty list: the served world has none of these things."""
_PREFIX = "rpc_"
"""Beginning of the names of methods that clients call."""


class _Procedure(NamedTuple):
    """A method that clients call."""

    function: Callable[..., Any]
    signature: inspect.Signature

    @classmethod
    def of(cls, function: Callable[..., Any]) -> "_Procedure":
        return cls(function, inspect.signature(function))


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
        self.world, self.actors = world, ActorCalls(world, streams, log)
        self._tick, self._log = tick, log
        groups = (
            EpisodeCalls(world, streams, tick),
            self.actors,
            MotionCalls(world),
            TrafficManagerCalls(),
            self,
        )
        self._procedures = {
            name.removeprefix(_PREFIX): _Procedure.of(getattr(group, name))
            for group in groups
            for name in dir(group)
            if name.startswith(_PREFIX)
        }

    def answer(self, method: str, arguments: list[Any]) -> Any:
        """Return the response to a call, in the form that the client reads.

        Args:
            method: Name of the procedure.
            arguments: Its arguments; the first is the client's metadata.
        """
        try:
            if method in self._procedures:
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
        """Return the result of a procedure.

        Raises:
            CallError: If the arguments do not fit.
        """
        procedure = self._procedures[method]
        try:
            procedure.signature.bind(*arguments)
        except TypeError as error:
            raise CallError(f"{method}: {error}") from None
        return procedure.function(*arguments)

    def rpc_apply_batch(self, commands: Any, ticks: Any) -> list[Any]:
        is_ticking = read.flag(ticks)
        answers = run_batch(self, commands)
        if is_ticking:
            self._tick()
        return answers


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
