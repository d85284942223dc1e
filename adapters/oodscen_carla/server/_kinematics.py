"""The motion of a client's actors in one tick: driven vehicles, walkers, and bodies with a velocity."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from oodscen_carla.server._actors import ZERO, ServerActor, WalkerControl
from oodscen_carla.server._geometry import matrix, rotated
from oodscen_carla.server._roads import ServedMap
from oodscen_carla.server._values import FARTHEST, Transform, Vector
from oodscen_carla.server._vehicles import drive

_HIGHEST_FRICTION = 2.0
_LEVEL_DEG = 1e-4
"""Pitch up to which a body stands level, degrees."""
_TURNING_MPS = 1e-6
"""Speed across the ground up to which a walker does not turn, m/s."""


class FrictionBox(NamedTuple):
    """A box with a friction of its own."""

    place: Transform
    """In the world; its middle."""
    extent: Vector
    """Half of its length, width and height, m."""
    friction: float

    @classmethod
    def of(cls, trigger: ServerActor, place: Transform) -> "FrictionBox":
        """Return the box of a trigger that stands at a place in the world."""
        length, width, height = (trigger.number(f"extent_{axis}", 1.0) / 100.0 for axis in "xyz")
        friction = max(0.0, min(_HIGHEST_FRICTION, trigger.number("friction", 1.0)))
        return cls(place, (length, width, height), friction)

    def holds(self, location: Vector) -> bool:
        """Return whether a point lies in the box."""
        apart = np.subtract(location, self.place.location)
        along = matrix(self.place)[:3, :3].T @ apart
        return bool((np.abs(along) <= self.extent).all())


class Surface(NamedTuple):
    """The ground that actors move on."""

    map: ServedMap
    friction: float
    """The road's friction."""
    boxes: Sequence[FrictionBox]

    def friction_below(self, actor: ServerActor) -> float:
        """Return the friction below a vehicle: that of the first box that holds it, or the road's."""
        location = actor.place.location
        return next((box.friction for box in self.boxes if box.holds(location)), self.friction)


def move(actor: ServerActor, surface: Surface, dt: float) -> None:
    """Move an actor by one tick of `dt`, s, within the world's limits; what is attached to another moves with that."""
    if actor.parent:
        return
    if actor.constant_velocity is not None:
        velocity = rotated(actor.constant_velocity, actor.place.rotation[1])
        actor.set_velocity(velocity, actor.constant_velocity[0], dt)
        actor.acceleration = actor.angular = ZERO
        _shift(actor, dt)
    elif actor.control is not None and actor.has_physics and actor.is_vehicle:
        drive(actor, actor.control, surface.friction_below(actor), dt)
    elif actor.walk is not None:
        _walk(actor, actor.walk, dt)
    elif actor.has_physics and (any(actor.velocity) or actor.angular[2]):
        _shift(actor, dt)
        _turn(actor, dt)
    else:
        return
    x, y, z = (max(-FARTHEST, min(FARTHEST, value)) for value in actor.place.location)
    actor.place = Transform((x, y, z), actor.place.rotation)
    if actor.is_vehicle or actor.is_walker:
        _stand(actor, surface.map)


def _walk(actor: ServerActor, walk: WalkerControl, dt: float) -> None:
    """Move a walker across the ground, and turn it to where it goes."""
    x, y, _ = (walk.speed * part for part in walk.direction)
    actor.velocity, actor.angular = (x, y, 0.0), ZERO
    _shift(actor, dt)
    if walk.speed > 0.0 and math.hypot(x, y) > _TURNING_MPS:
        pitch, _, roll = actor.place.rotation
        turned = (pitch, math.degrees(math.atan2(y, x)), roll)
        actor.place = Transform(actor.place.location, turned)
    actor.speed = rotated(actor.velocity, -actor.place.rotation[1])[0]


def _shift(actor: ServerActor, dt: float) -> None:
    """Move an actor by its velocity."""
    x, y, z = (a + b * dt for a, b in zip(actor.place.location, actor.velocity, strict=True))
    actor.place = Transform((x, y, z), actor.place.rotation)


def _turn(actor: ServerActor, dt: float) -> None:
    """Turn an actor about the vertical by its angular velocity."""
    pitch, yaw, roll = actor.place.rotation
    turned = (pitch, math.remainder(yaw + actor.angular[2] * dt, 360.0), roll)
    actor.place = Transform(actor.place.location, turned)


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
