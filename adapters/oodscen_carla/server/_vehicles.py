"""The motion of a driven vehicle: a kinematic bicycle within the road's friction."""

import math
from typing import Any

from oodscen.driving._motion.bodies import GRAVITY
from oodscen_carla.server._actors import ZERO, ServerActor, VehicleControl
from oodscen_carla.server._values import Transform, Vector

MASS_KG = 1500.0
"""Mass of every vehicle."""
MAX_DRIVE_MPS2 = 4.0
"""Maximum acceleration of the motor, m/s^2."""
TOP_SPEED_MPS = 55.0
"""Speed at which the motor only makes up for drag, m/s."""
MAX_STEERING_RAD = 0.6
"""Angle of the front wheels at full lock, rad."""
BRAKING_MPS2 = 8.0
"""Deceleration of a full brake on dry asphalt, m/s^2."""
WHEELBASE_SHARE = 0.6
"""Wheelbase as a share of a vehicle's length."""
_SHORTEST_WHEELBASE_M = 0.1
"""Wheelbase up to which a vehicle does not turn, m."""
_STANDING_MPS = 1e-6
"""Speed below which a vehicle stands, m/s."""


def demanded(control: VehicleControl, speed: float) -> float:
    """Return the acceleration along the heading that the pedals demand, m/s^2."""
    drive = (
        MAX_DRIVE_MPS2
        * min(1.0, max(0.0, control.throttle))
        * max(0.0, 1.0 - abs(speed) / TOP_SPEED_MPS)
    )
    brake = BRAKING_MPS2 * min(1.0, max(0.0, control.brake) + float(control.hand_brake))
    drag = 0.1 + 0.0006 * speed * speed
    ahead = -drive if control.reverse else drive
    if abs(speed) < _STANDING_MPS:
        return math.copysign(max(0.0, drive - drag - brake), ahead)
    return ahead - math.copysign(drag + brake, speed)


def wheels(control: VehicleControl) -> float:
    """Return the angle of the front wheels, rad, to the right positive."""
    return min(1.0, max(-1.0, control.steer)) * MAX_STEERING_RAD


def drive(actor: ServerActor, control: VehicleControl, friction: float, dt: float) -> None:
    """Move a vehicle by one step.

    Longitudinal and lateral acceleration together stay within friction times gravity (Rajamani
    2012, chapters 2 and 13); what the steering demands beyond that is a wider bend.
    """
    grip, before = friction * GRAVITY, actor.speed
    acceleration = max(-grip, min(grip, demanded(control, before)))
    after = before + acceleration * dt
    if before * after < 0.0:
        after = 0.0
    lateral_grip = math.sqrt(max(0.0, grip * grip - acceleration * acceleration))
    wheelbase = WHEELBASE_SHARE * 2.0 * actor.blueprint.extent[0]
    slip = math.atan(0.5 * math.tan(wheels(control)))
    curvature = math.sin(slip) / (0.5 * wheelbase) if wheelbase > _SHORTEST_WHEELBASE_M else 0.0
    square = max(before * before, after * after)
    if square * abs(curvature) > lateral_grip:
        curvature = math.copysign(lateral_grip / square, curvature)
        slip = math.asin(max(-1.0, min(1.0, 0.5 * wheelbase * curvature)))
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


def physics(actor: ServerActor) -> list[Any]:
    """Return `carla.VehiclePhysicsControl` as clients read it: constants that agree with the bicycle model."""
    x, y, _ = actor.place.location
    length, width, _ = actor.blueprint.extent

    def wheel(ahead: float, right: float, max_steer_deg: float) -> list[Any]:
        control = {
            "tire_friction": 2.0,
            "damping_rate": 0.25,
            "max_steer_angle": max_steer_deg,
            "radius": 35.0,
            "max_brake_torque": 1500.0,
            "max_handbrake_torque": 3000.0,
            "lat_stiff_max_load": 2.0,
            "lat_stiff_value": 17.0,
            "long_stiff_value": 1000.0,
            "position": [100.0 * (x + ahead * length), 100.0 * (y + right * width), 30.0],
        }
        return list(control.values())

    control = {
        "torque_curve": [[0.0, 500.0], [5000.0, 500.0]],
        "max_rpm": 5000.0,
        "moi": 1.0,
        "damping_rate_full_throttle": 0.15,
        "damping_rate_zero_throttle_clutch_engaged": 2.0,
        "damping_rate_zero_throttle_clutch_disengaged": 0.35,
        "use_gear_autobox": True,
        "gear_switch_time": 0.5,
        "clutch_strength": 10.0,
        "final_ratio": 4.0,
        "forward_gears": [],
        "mass": MASS_KG,
        "drag_coefficient": 0.3,
        "center_of_mass": list(ZERO),
        "steering_curve": [[0.0, 1.0], [120.0, 1.0]],
        "wheels": [
            wheel(ahead, right, max_steer_deg)
            for ahead, max_steer_deg in ((0.6, 34.4), (-0.6, 0.0))
            for right in (-0.8, 0.8)
        ],
        "use_sweep_wheel_collision": False,
    }
    return list(control.values())
