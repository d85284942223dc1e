"""Batches of commands; each has its own answer, and a failed one does not stop the others."""

from typing import TYPE_CHECKING, Any

from oodscen.errors import OodscenError
from oodscen_carla.server import _values as read
from oodscen_carla.server._values import CallError

if TYPE_CHECKING:
    from oodscen_carla.server._calls import Calls

SPAWN = 0
COMMANDS = {
    1: ("destroy_actor", "DestroyActor"),
    2: ("apply_control_to_vehicle", "ApplyVehicleControl"),
    4: ("apply_control_to_walker", "ApplyWalkerControl"),
    6: ("set_actor_transform", "ApplyTransform"),
    8: ("set_actor_target_velocity", "ApplyTargetVelocity"),
    9: ("set_actor_target_angular_velocity", "ApplyTargetAngularVelocity"),
    14: ("set_actor_simulate_physics", "SetSimulatePhysics"),
    18: ("set_vehicle_light_state", "SetVehicleLightState"),
    19: ("set_actor_location", "ApplyLocation"),
}
"""Procedure and name by place in libcarla 0.9.16's variant of commands."""
WITHOUT_EFFECT = {5: "ApplyVehiclePhysicsControl", 15: "SetEnableGravity", 16: "SetAutopilot"}
REFUSED = {
    3: "ApplyVehicleAckermannControl",
    7: "ApplyWalkerState",
    10: "ApplyImpulse",
    11: "ApplyForce",
    12: "ApplyAngularImpulse",
    13: "ApplyTorque",
    17: "ShowDebugTelemetry",
    20: "ConsoleCommand",
    21: "SetTrafficLightState",
}
_MAX_COMMANDS = 10_000
_MAX_AFTER = 32
"""Maximum number of commands that follow a spawn."""


def run_batch(calls: "Calls", commands: Any) -> list[Any]:
    """Run commands in order and return the response of each: the actor's id, or an error."""
    checked = read.items(commands, "a batch", longest=_MAX_COMMANDS)
    return [_answer(calls, command) for command in checked]


def _answer(calls: "Calls", command: Any) -> list[Any]:
    try:
        return [[1, _run(calls, command, 0)]]
    except (CallError, OodscenError) as error:
        return [[0, [str(error)]]]


def _run(calls: "Calls", command: Any, spawned: int) -> int:
    """Run one command and return the id of its actor.

    Args:
        calls: The procedures.
        command: The place in the variant, and the values.
        spawned: Id of the actor that was just spawned, for which id 0 stands.
    """
    (variant,) = read.items(command, "a command", 1)
    kind, values = read.items(variant, "a command", 2)
    number = read.whole(kind, "a command's kind")
    if number == SPAWN:
        return _spawn(calls, read.items(values, "SpawnActor", longest=8))
    first, *others = read.items(values, "a command", longest=32) or [None]
    if number in REFUSED or not (number in COMMANDS or number in WITHOUT_EFFECT):
        name = REFUSED.get(number, f"command {number}")
        raise CallError(f"{name} is not supported by this server (oodscen)")
    actor = read.whole(first) or spawned
    procedure, name = COMMANDS.get(number, ("", WITHOUT_EFFECT.get(number, "")))
    calls.world.find(actor, f"run {name}")
    if procedure and calls.call(procedure, [actor, *others]) is False:
        raise CallError(f"unable to run {name}: actor {actor} belongs to the staged scene")
    return actor


def _spawn(calls: "Calls", values: list[Any]) -> int:
    if len(values) < 3:
        raise CallError("SpawnActor needs a description, a transform and a parent")
    parent = read.optional(values[2], "a parent")
    # The attachment between parent and follow-ups is uninitialised memory of the client.
    actor = calls.actors.spawn(values[0], values[1], parent or 0)
    for command in read.items(values[-1], "the commands after a spawn", longest=_MAX_AFTER):
        _run(calls, command, actor.id)
    return actor.id
