"""One actor of the served world: a body, a sensor, the spectator."""

import math
from dataclasses import dataclass, field
from typing import Any

from oodscen_carla.server._blueprints import Blueprint
from oodscen_carla.server._geometry import OrientedBox
from oodscen_carla.server._values import Description, Transform, Vector

ZERO: Vector = (0.0, 0.0, 0.0)
CLEARANCE_M = 0.2
"""Height below which vehicles roll over things, such as CARLA's patches of dirt, m."""


@dataclass
class VehicleControl:
    """The pedals and the wheel, as CARLA's `VehicleControl`."""

    throttle: float = 0.0
    steer: float = 0.0
    brake: float = 0.0
    hand_brake: bool = False
    reverse: bool = False
    manual_gear_shift: bool = False
    gear: int = 0


@dataclass
class WalkerControl:
    """The direction and the speed of a walker."""

    direction: Vector
    speed: float
    jump: bool


@dataclass(eq=False)
class ServerActor:
    """The changing state of one actor; places are in CARLA's axes."""

    id: int
    description: Description
    blueprint: Blueprint
    place: Transform
    """In the world; relative to the parent if there is one."""
    parent: int = 0
    """Id of the actor that it is attached to; 0 for none."""
    velocity: Vector = ZERO
    angular: Vector = ZERO
    """Angular velocity, degrees per second."""
    acceleration: Vector = ZERO
    speed: float = 0.0
    """Speed along the heading, m/s; negative in reverse."""
    acceleration_along: float = 0.0
    """Acceleration along the heading, m/s^2."""
    control: VehicleControl | None = None
    walk: WalkerControl | None = None
    constant_velocity: Vector | None = None
    """A velocity in the body's axes that a client holds, m/s."""
    has_physics: bool = True
    lights: int = 0
    touching: set[int] = field(default_factory=set)
    """Ids of the actors that it was still touching at the end of the last tick."""
    staged: str = ""
    """Id of the body of the staged scene that it is; empty for a client's own."""
    name: str = ""
    """Name in pictures, by which its paint is chosen; no other actor has it."""
    spawned_at: float = 0.0
    """Time of the simulation when it was spawned, s."""
    is_placed: bool = False
    """True if a client has put it somewhere since the last tick."""
    placings: int = 0
    """Number of ticks that began with it newly placed by a client."""
    attributes: dict[str, str] = field(init=False)
    """The values of its description's attributes by name."""

    def __post_init__(self) -> None:
        self.attributes = {name: value for name, _, value in self.description.attributes}

    @property
    def type_id(self) -> str:
        """The id of its blueprint, as CARLA's clients know it."""
        return self.blueprint.id

    @property
    def box(self) -> OrientedBox:
        """The box around its body."""
        return OrientedBox(self.place, self.blueprint.extent)

    @property
    def is_vehicle(self) -> bool:
        """Return whether its blueprint is a vehicle's."""
        return self.type_id.startswith("vehicle.")

    @property
    def moves_itself(self) -> bool:
        """Return whether it is a vehicle that a tick moves; without physics, only a constant velocity does."""
        return self.is_vehicle and (self.has_physics or self.constant_velocity is not None)

    @property
    def is_walker(self) -> bool:
        """Return whether its blueprint is a walker's."""
        return self.type_id.startswith("walker.")

    @property
    def is_sensor(self) -> bool:
        """Return whether it sends data of its own."""
        return self.type_id.startswith("sensor.")

    @property
    def is_obstacle(self) -> bool:
        """Return whether vehicles collide with it: it has a body that they cannot drive over or through."""
        asset, height = self.blueprint.asset, 2.0 * self.blueprint.extent[2]
        if asset is None or height < CLEARANCE_M:
            return False
        return not asset.is_passable(self.attributes.get("state", ""))

    def number(self, name: str, default: float) -> float:
        """Return an attribute as a finite number, or the default."""
        try:
            value = float(self.attributes.get(name, default))
        except ValueError:
            return default
        return value if math.isfinite(value) else default

    def set_velocity(self, velocity: Vector, ahead: float, dt: float) -> None:
        """Take a velocity; without physics, the change of speed in a tick is its acceleration.

        Args:
            velocity: In the world, m/s.
            ahead: Its part along the heading, m/s.
            dt: Duration of a tick, s.
        """
        self.acceleration_along = 0.0 if self.has_physics else (ahead - self.speed) / dt
        self.velocity, self.speed = velocity, ahead

    def stop(self) -> None:
        """End its motion."""
        self.velocity, self.angular, self.acceleration = ZERO, ZERO, ZERO
        self.speed = self.acceleration_along = 0.0

    def row(self, token: bytes) -> list[Any]:
        """Return the `ActorInfo` of CARLA's protocol."""
        uid, type_id, attributes = self.description
        box = [
            [0.0, 0.0, self.blueprint.extent[2]],
            list(self.blueprint.extent),
            list(ZERO),
            self.id,
        ]
        tags = bytes([self.blueprint.tag]) if self.blueprint.tag else b""
        values = [list(attribute) for attribute in attributes]
        return [self.id, self.parent, [uid, type_id, values], box, tags, token]
