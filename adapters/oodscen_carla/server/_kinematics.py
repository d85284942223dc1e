"""The motion of a client's actors in one tick: driven vehicles, walkers, and bodies with a velocity."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from oodscen_carla.server._actors import ServerActor
from oodscen_carla.server._geometry import rotated
from oodscen_carla.server._roads import ServedMap
from oodscen_carla.server._values import FARTHEST, Transform
from oodscen_carla.server._vehicles import drive

_HIGHEST_FRICTION = 2.0
_LEVEL_DEG = 1e-4
"""Pitch up to which a body stands level, degrees."""
_TURNING_MPS = 1e-6
"""Speed across the ground up to which a walker does not turn, m/s."""


class Surface(NamedTuple):
    """The ground that actors move on."""

    map: ServedMap
    friction: float
    """The road's friction."""
    triggers: Sequence[ServerActor]
    """The boxes with a friction of their own."""

    def friction_below(self, actor: ServerActor) -> float:
        """Return the friction below a vehicle: a trigger's, or the road's."""
        for trigger in self.triggers:
            extent_m = [trigger.number(f"extent_{axis}", 1.0) / 100.0 for axis in "xyz"]
            pairs = zip(actor.place.location, trigger.place.location, strict=True)
            distances_m = [abs(a - b) for a, b in pairs]
            if all(a <= b for a, b in zip(distances_m, extent_m, strict=True)):
                return max(0.0, min(_HIGHEST_FRICTION, trigger.number("friction", 1.0)))
        return self.friction


def move(actor: ServerActor, surface: Surface, dt: float) -> None:
    """Move an actor by one tick of `dt`, s; what is attached to another moves with that."""
    if actor.parent:
        return
    if actor.constant_velocity is not None:
        actor.velocity = rotated(actor.constant_velocity, actor.place.rotation[1])
        _shift(actor, dt)
    elif actor.control is not None and actor.has_physics and actor.is_vehicle:
        drive(actor, actor.control, surface.friction_below(actor), dt)
        _stand(actor, surface.map)
    elif actor.walk is not None:
        _walk(actor, dt)
        _stand(actor, surface.map)
    elif actor.has_physics and any(actor.velocity):
        _shift(actor, dt)


def _walk(actor: ServerActor, dt: float) -> None:
    """Move a walker, and turn it to where it goes."""
    assert actor.walk is not None
    speed = actor.walk.speed
    x, y, z = (speed * part for part in actor.walk.direction)
    actor.velocity, actor.speed = (x, y, z), speed
    _shift(actor, dt)
    if speed > 0.0 and math.hypot(x, y) > _TURNING_MPS:
        pitch, _, roll = actor.place.rotation
        rotation = (pitch, math.degrees(math.atan2(y, x)), roll)
        actor.place = Transform(actor.place.location, rotation)


def _shift(actor: ServerActor, dt: float) -> None:
    """Move an actor by its velocity, within the world's limits."""
    x, y, z = (a + b * dt for a, b in zip(actor.place.location, actor.velocity, strict=True))
    x, y, z = (max(-FARTHEST, min(FARTHEST, value)) for value in (x, y, z))
    actor.place = Transform((x, y, z), actor.place.rotation)


def _stand(actor: ServerActor, road: ServedMap) -> None:
    """Put an actor on the road, with the road's slope."""
    x, y, _ = actor.place.location
    ground = road.ground(x, -y)
    if ground is None:
        return
    yaw = actor.place.rotation[1]
    slope = ground.slope * math.cos(math.radians(-yaw) - ground.heading)
    pitch = math.degrees(math.atan(slope)) if actor.is_vehicle else 0.0
    if abs(pitch) <= _LEVEL_DEG:
        pitch = 0.0
    actor.place = Transform((x, y, ground.z), (pitch, yaw, 0.0))
