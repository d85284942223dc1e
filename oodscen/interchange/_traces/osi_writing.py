"""Runs as traces of OSI ground truth: protocol buffers in `.osi` files or in MCAP."""

import math
import struct
from collections.abc import Iterator, Sequence
from typing import Literal

from oodscen._arguments import checked
from oodscen._numbers import seed_number
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.data._scene import Scene
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import UnknownComponent
from oodscen.interchange._moving import moving
from oodscen.interchange._recording import RecordedRun, replayed
from oodscen.interchange._traces.mcap_files import mcap_trace
from oodscen.interchange._traces.wire import (
    message_field,
    number_field,
    text_field,
    vector_field,
)
from oodscen.interchange._writing.entities import Entity, entities
from oodscen.interchange._writing.roads import road_file
from oodscen.interchange._writing.trajectories import reference_poses
from oodscen.numerics._exact import Floats
from oodscen.protocols import Simulator

Container = Literal["osi", "mcap"]
CONTAINERS: tuple[Container, ...] = ("osi", "mcap")

_VERSION = (3, 7, 0)
"""Version of OSI: major, minor, patch."""
_TYPES = {"MiscObject": 1, "Vehicle": 2, "Pedestrian": 3}
"""`MovingObject.Type` by kind."""
_ANIMAL = 4
_VEHICLE_TYPES = {
    "car": 4,
    "van": 6,
    "truck": 7,
    "trailer": 9,
    "motorbike": 10,
    "bicycle": 11,
    "bus": 12,
}
"""`VehicleClassification.Type` by category."""
_OTHER_VEHICLE = 1
_NS_PER_S = 1_000_000_000


@checked
def osi_trace(
    scene: Scene,
    catalogue: Catalogue,
    *,
    action: str = "keep_speed",
    seed: int = 0,
    container: Container = "osi",
    simulator: Simulator | None = None,
    reaction_s: float = NOMINAL_REACTION_S,
) -> bytes:
    """Return a scene's run as a trace of OSI ground truth; `Scene.to_osi` tells arguments and errors."""
    if container not in CONTAINERS:
        raise UnknownComponent("container", container, CONTAINERS)
    seed_number(seed)
    with moving(simulator, catalogue) as world:
        run = replayed(scene, world, action, seed, reaction_s)
    corridor = load_corridor(scene.map, catalogue)
    messages = _messages(run, entities(scene, catalogue), corridor)
    if container == "mcap":
        return mcap_trace(messages, road_file(scene, catalogue))
    return b"".join(struct.pack("<I", len(truth)) + truth for _, truth in messages)


def _messages(
    run: RecordedRun, bodies: Sequence[Entity], corridor: Corridor
) -> Iterator[tuple[int, bytes]]:
    """Yield time in ns and ground truth of every step."""
    constant = [_constant_fields(row, body) for row, body in enumerate(bodies)]
    velocities = run.velocities
    accelerations = run.rates(velocities)
    pitches = [reference_poses(run, row, body, corridor)[:, 4] for row, body in enumerate(bodies)]
    parts = enumerate(_VERSION, start=1)
    version = message_field(1, b"".join(number_field(number, part) for number, part in parts))
    host = message_field(3, number_field(1, 0))
    for step, time in enumerate(run.time.tolist()):
        time_ns = round(time * _NS_PER_S)
        stamp = number_field(1, time_ns // _NS_PER_S) + number_field(2, time_ns % _NS_PER_S)
        truth = version + message_field(2, stamp) + host
        for row, body in enumerate(bodies):
            pose, velocity = run.poses[step, row], velocities[step, row]
            pitch = float(pitches[row][step])
            base = _base(body.asset, pose, pitch, velocity, accelerations[step, row])
            truth += message_field(5, constant[row] + message_field(2, base))
        yield time_ns, truth


def _constant_fields(row: int, body: Entity) -> bytes:
    """Return the fields of a moving object that do not change: id, kind and entity."""
    kind = _ANIMAL if body.category == "animal" else _TYPES[body.kind]
    fields = message_field(1, number_field(1, row)) + number_field(3, kind)
    if body.kind == "Vehicle":
        vehicle_type = _VEHICLE_TYPES.get(body.category, _OTHER_VEHICLE)
        fields += message_field(6, number_field(1, vehicle_type))
    reference = text_field(2, "net.asam.openscenario") + text_field(3, f"entity_name:{body.name}")
    return fields + message_field(10, reference)


def _base(
    asset: Asset, pose: Floats, pitch: float, velocity: Floats, acceleration: Floats
) -> bytes:
    """Return size, pose, velocity and acceleration; OSI's position is the centre of the box."""
    x, y, z, heading = map(float, pose)
    yaw = math.remainder(heading, math.tau)
    return (
        vector_field(1, asset.length, asset.width, asset.height)
        + vector_field(2, x, y, z + 0.5 * asset.height)
        + vector_field(3, 0.0, pitch, yaw)
        + vector_field(4, *velocity.tolist())
        + vector_field(5, *acceleration.tolist())
    )
