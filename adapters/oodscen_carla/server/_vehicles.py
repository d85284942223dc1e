"""The motion of a driven vehicle: a kinematic bicycle within the road's friction."""

import math

from oodscen_carla.server._actors import Actor, VehicleControl
from oodscen_carla.server._values import Transform, Vector

GRAVITY = 9.81
MAX_DRIVE = 4.0
"""Maximum acceleration of the motor, m/s^2."""
TOP_SPEED = 55.0
"""Speed at which the motor only makes up for drag, m/s."""
MAX_STEERING = 0.6
"""Angle of the front wheels at full lock, rad."""
BRAKING = 8.0
"""Deceleration of a full brake on dry asphalt, m/s^2."""
WHEELBASE = 0.6
"""Wheelbase as a share of a vehicle's length."""


def demanded(control: VehicleControl, speed: float) -> float:
    """Return the acceleration along the heading that the pedals demand, m/s^2."""
    drive = (
        MAX_DRIVE * min(1.0, max(0.0, control.throttle)) * max(0.0, 1.0 - abs(speed) / TOP_SPEED)
    )
    brake = BRAKING * min(1.0, max(0.0, control.brake) + float(control.hand_brake))
    drag = 0.1 + 0.0006 * speed * speed
    ahead = -drive if control.reverse else drive
    if abs(speed) < 1e-6:
        return math.copysign(max(0.0, drive - drag - brake), ahead)
    return ahead - math.copysign(drag + brake, speed)


def wheels(control: VehicleControl) -> float:
    """Return the angle of the front wheels, rad, to the right positive."""
    return min(1.0, max(-1.0, control.steer)) * MAX_STEERING


def drive(actor: Actor, control: VehicleControl, friction: float, dt: float) -> None:
    """Move a vehicle by one step.

    Longitudinal and lateral acceleration together stay within friction times gravity (Rajamani
    2012, chapters 2 and 13); what the steering demands beyond that is a wider bend.
    """
    grip, before = friction * GRAVITY, actor.speed
    acceleration = max(-grip, min(grip, demanded(control, before)))
    after = before + acceleration * dt
    if before * after < 0.0:
        after = 0.0
    left = math.sqrt(max(0.0, grip * grip - acceleration * acceleration))
    base = WHEELBASE * 2.0 * actor.blueprint.extent[0]
    slip = math.atan(0.5 * math.tan(wheels(control)))
    curvature = math.sin(slip) / (0.5 * base) if base > 0.1 else 0.0
    fastest = max(before * before, after * after)
    if fastest * abs(curvature) > left:
        curvature = math.copysign(left / fastest, curvature)
        slip = math.asin(max(-1.0, min(1.0, 0.5 * base * curvature)))
    mean = 0.5 * (before + after)
    turn = mean * curvature * dt
    pitch, yaw, roll = actor.place.rotation
    course = math.radians(yaw) + 0.5 * turn + slip
    x, y, z = actor.place.location
    step = mean * dt
    place = (x + step * math.cos(course), y + step * math.sin(course), z)
    yaw = (yaw + math.degrees(turn) + 180.0) % 360.0 - 180.0
    actor.place = Transform(place, (pitch, yaw, roll))
    course = math.radians(yaw) + slip
    velocity: Vector = (after * math.cos(course), after * math.sin(course), 0.0)
    old = actor.velocity
    if dt > 0.0:
        actor.acceleration = (
            (velocity[0] - old[0]) / dt,
            (velocity[1] - old[1]) / dt,
            0.0,
        )
        actor.acceleration_along = (after - before) / dt
    actor.velocity, actor.speed = velocity, after
    actor.angular = (0.0, 0.0, math.degrees(turn / dt) if dt > 0.0 else 0.0)
