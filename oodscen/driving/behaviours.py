"""What actors do: one small function per behaviour, and the vocabulary that catalogues list.

A function moves its actor by one step in road coordinates. It sees the others where they were at
the beginning of the step, so the order of actors never matters.
"""

import math
from collections.abc import Callable
from typing import Protocol

from oodscen.catalogue import BehaviourKind, BehaviourParameter, Category
from oodscen.driving.bodies import ActorBody, quantised, wrapped
from oodscen.driving.corridor import Corridor

_ACCELERATION = {"pedestrian": 2.5, "animal": 6.0, "cyclist": 1.5, "object": 4.0}
"""How quickly a category reaches its speed, m/s^2; 2.5 for the others."""
_MAX_SLOPE = 0.5
"""Metres that a vehicle may move sideways per metre travelled."""
_MAX_TURN = 1.2
"""rad/s by which a lane follower's heading settles."""


class Surroundings(Protocol):
    """What a behaviour may know of the world."""

    corridor: Corridor
    dt: float
    friction: float

    @property
    def time(self) -> float:
        """Seconds since the start."""
        ...

    def free_road(self, body: ActorBody) -> tuple[float, float]:
        """Return the gap to what is ahead in the body's path, m, and its speed away from it."""
        ...


# ------------------------------------------------------------------ motion


def _move(body: ActorBody, world: Surroundings, distance: float) -> None:
    """Move along the actor's own heading."""
    stretch = max(0.2, 1.0 - world.corridor.bend(body.s) * body.t)
    body.s = quantised(body.s + distance * math.cos(body.heading) / stretch)
    body.t = quantised(body.t + distance * math.sin(body.heading))


def _speed_up(body: ActorBody, acceleration: float, target: float, dt: float) -> float:
    """Approach a speed, and return the distance covered meanwhile."""
    before = body.speed
    step = acceleration * dt
    after = min(target, before + step) if target > before else max(target, before - step)
    body.speed = quantised(after)
    return 0.5 * (before + after) * dt


def _accelerate(body: ActorBody, acceleration: float, dt: float) -> float:
    """Change the speed without ever reversing, and return the distance covered meanwhile."""
    before = body.speed
    after = max(0.0, before + acceleration * dt)
    body.speed = quantised(after)
    return 0.5 * (before + after) * dt


def _keep_lane(
    body: ActorBody, world: Surroundings, distance: float, blend: float = 0.0, shift: float = 0.0
) -> None:
    """Move along the lane.

    Args:
        body: The actor.
        world: Around it.
        distance: Covered in this step, m.
        blend: 0 in its own lane, 1 in its target lane.
        shift: Further to the left, m.
    """
    road = world.corridor
    stretch = max(0.2, 1.0 - road.bend(body.s) * body.t)
    before = body.t
    along = distance * math.cos(math.remainder(body.heading, math.pi))
    body.s = quantised(body.s + body.direction * along / stretch)
    wanted = road.centre(body.lane, body.s) * (1.0 - blend) + body.offset * (1.0 - blend) + shift
    if blend > 0.0:
        wanted += road.centre(body.target_lane, body.s) * blend
    limit = _MAX_SLOPE * distance
    aside = min(max(wanted - before, -limit), limit)
    body.t = quantised(before + aside)
    if distance > 1e-3:
        aim = math.atan2(aside, body.direction * along)
        most = _MAX_TURN * world.dt
        error = wrapped(aim - body.heading)
        body.heading = quantised(wrapped(body.heading + min(max(error, -most), most)))


def _attentive(body: ActorBody, world: Surroundings, desired: float) -> float:
    """Return the acceleration of the intelligent-driver model (Treiber et al. 2000)."""
    speed = body.speed
    gap, leader = world.free_road(body)
    most, comfortable, headway, standstill = 1.8, 2.5, 1.2, 2.0
    if desired <= 0.0:
        return -comfortable
    ratio = speed / desired
    acceleration = most * (1.0 - ratio * ratio * ratio * ratio)
    if speed > desired:
        acceleration = max(acceleration, -comfortable)
    if gap < math.inf:
        closing = speed - leader
        wanted = standstill + max(
            0.0, speed * headway + speed * closing / (2.0 * math.sqrt(most * comfortable))
        )
        ratio = wanted / max(gap, 0.1)
        acceleration -= most * ratio * ratio
    return max(acceleration, -8.0 * min(1.0, world.friction))


def _cruise(body: ActorBody, world: Surroundings, blend: float = 0.0, shift: float = 0.0) -> None:
    """Drive in the lane at the behaviour's speed, attentive to what is ahead."""
    acceleration = _attentive(body, world, body.parameters["speed"])
    _keep_lane(body, world, _accelerate(body, acceleration, world.dt), blend, shift)


def _brake(body: ActorBody, world: Surroundings, deceleration: float) -> None:
    """Slow down in the lane until it stands."""
    deceleration = min(deceleration, 9.0 * world.friction)
    _keep_lane(body, world, _accelerate(body, -deceleration, world.dt))


def _since(body: ActorBody, world: Surroundings) -> float:
    """Return the time since the trigger, s; negative before."""
    return world.time - body.triggered if body.triggered >= 0.0 else -1.0


def _smooth(progress: float) -> float:
    """Return a course from 0 to 1 that starts and ends without a jerk."""
    p = min(max(progress, 0.0), 1.0)
    return p * p * p * (10.0 + p * (6.0 * p - 15.0))


def _weave(body: ActorBody, world: Surroundings) -> float:
    """Return how far to the left a weaving actor is; the amplitude grows over one period."""
    since, period = _since(body, world), body.parameters["period"]
    if since < 0.0:
        return 0.0
    growth = min(1.0, since / period)
    swing = math.sin(math.tau * since / period + body.phase)
    return body.parameters["amplitude"] * growth * swing


# ------------------------------------------------------------------ behaviours


def _stand(body: ActorBody, world: Surroundings) -> None:
    del body, world


def _follow_lane(body: ActorBody, world: Surroundings) -> None:
    _cruise(body, world)


def _wrong_way(body: ActorBody, world: Surroundings) -> None:
    distance = _speed_up(body, 2.0, body.parameters["speed"], world.dt)
    _keep_lane(body, world, distance)


def _cut_in(body: ActorBody, world: Surroundings) -> None:
    _cruise(body, world, _smooth(_since(body, world) / body.parameters["duration"]))


def _hard_brake(body: ActorBody, world: Surroundings) -> None:
    if body.triggered < 0.0:
        _cruise(body, world)
    else:
        _brake(body, world, body.parameters["deceleration"])


def _stop_and_go(body: ActorBody, world: Surroundings) -> None:
    since, period = _since(body, world), body.parameters["period"]
    goes = since < 0.0 or (since / period) % 1.0 >= 0.5
    if goes:
        _cruise(body, world)
    else:
        acceleration = min(-2.5, _attentive(body, world, body.parameters["speed"]))
        _keep_lane(body, world, _accelerate(body, acceleration, world.dt))


def _reverse(body: ActorBody, world: Surroundings) -> None:
    if body.triggered >= 0.0:
        _move(body, world, _speed_up(body, 1.5, -body.parameters["speed"], world.dt))


def _swerve(body: ActorBody, world: Surroundings) -> None:
    _cruise(body, world, shift=_weave(body, world))


def _pull_out(body: ActorBody, world: Surroundings) -> None:
    if body.triggered < 0.0:
        return
    acceleration = min(2.0, _attentive(body, world, body.parameters["speed"]))
    blend = _smooth(_since(body, world) / body.parameters["duration"])
    _keep_lane(body, world, _accelerate(body, acceleration, world.dt), blend)


def _u_turn(body: ActorBody, world: Surroundings) -> None:
    if body.triggered < 0.0:
        _cruise(body, world)
        return
    turned, rate = body.memory[0], math.pi / body.parameters["duration"]
    turn = min(rate * world.dt, math.pi - turned)
    body.memory[0] = quantised(turned + turn)
    body.heading = quantised(wrapped(body.heading + turn))
    _move(body, world, _speed_up(body, 2.0, body.parameters["speed"], world.dt))


def _walk(body: ActorBody, world: Surroundings, distance: float) -> None:
    """Go straight on for a distance and stop there."""
    covered = _speed_up(
        body, _ACCELERATION.get(body.asset.category, 2.5), body.parameters["speed"], world.dt
    )
    left = distance - body.memory[0]
    if covered >= left:
        covered = max(left, 0.0)
        body.speed = 0.0
    body.memory[0] = quantised(body.memory[0] + covered)
    _move(body, world, covered)


def _cross_road(body: ActorBody, world: Surroundings) -> None:
    if body.triggered >= 0.0:
        _walk(body, world, body.parameters["distance"])


def _hesitate(body: ActorBody, world: Surroundings) -> None:
    if body.triggered < 0.0:
        return
    distance = body.parameters["distance"]
    if body.memory[0] < distance - 1e-9:
        _walk(body, world, distance)
    elif body.memory[1] < body.parameters["pause"] - 1e-9:
        body.memory[1] = quantised(body.memory[1] + world.dt)
    else:
        if body.memory[2] == 0.0:
            body.memory[2] = 1.0
            body.heading = quantised(wrapped(body.heading + math.pi))
        _walk(body, world, 2.0 * distance)


def _walk_along(body: ActorBody, world: Surroundings) -> None:
    if body.triggered >= 0.0:
        _walk(body, world, math.inf)


def _drift(body: ActorBody, world: Surroundings) -> None:
    since = _since(body, world)
    if since <= 0.0:
        _cruise(body, world)
        return
    shift = body.parameters["lateral"] * since
    road = world.corridor
    centre = road.centre(body.lane, body.s) + body.offset
    limits = road.drivable_range(body.s, centre)
    if limits is not None:
        half = 0.5 * body.asset.width
        shift = min(max(shift, limits[0] + half - centre), limits[1] - half - centre)
    _cruise(body, world, shift=shift)


BEHAVE: dict[str, Callable[[ActorBody, Surroundings], None]] = {
    "stand": _stand,
    "follow_lane": _follow_lane,
    "wrong_way": _wrong_way,
    "cut_in": _cut_in,
    "hard_brake": _hard_brake,
    "stall": _hard_brake,
    "stop_and_go": _stop_and_go,
    "reverse": _reverse,
    "swerve": _swerve,
    "pull_out": _pull_out,
    "u_turn": _u_turn,
    "cross_road": _cross_road,
    "hesitate": _hesitate,
    "walk_along": _walk_along,
    "bolt": _cross_road,
    "wobble": _swerve,
    "drift": _drift,
}
"""By behaviour id: moves the actor by one step."""

MOVES_BEFORE_TRIGGER = frozenset(
    {
        "follow_lane",
        "wrong_way",
        "cut_in",
        "hard_brake",
        "stall",
        "stop_and_go",
        "swerve",
        "u_turn",
        "wobble",
        "drift",
    }
)
"""Behaviours that drive in a lane from the start, at their `speed`."""

# ------------------------------------------------------------------ vocabulary

_ANYBODY: tuple[Category, ...] = (
    "vehicle",
    "cyclist",
    "pedestrian",
    "animal",
    "object",
    "work_zone",
    "vegetation",
    "signal",
)
_DRIVERS: tuple[Category, ...] = ("vehicle", "cyclist")
_WALKERS: tuple[Category, ...] = ("pedestrian", "animal", "cyclist", "object", "vegetation")


def _number(low: float, high: float, default: float, text: str) -> BehaviourParameter:
    return BehaviourParameter(minimum=low, maximum=high, default=default, description=text)


def _speed(high: float, default: float, low: float = 0.0) -> dict[str, BehaviourParameter]:
    return {"speed": _number(low, high, default, "m/s")}


_LANES = _number(-3, 3, 1, "lanes to the left as the ego sees it; negative is to the right")
_DURATION = "s that the move to the side takes"

BEHAVIOURS: tuple[BehaviourKind, ...] = (
    BehaviourKind(id="stand", description="stays where it is", categories=_ANYBODY),
    BehaviourKind(
        id="follow_lane",
        description="drives in its lane and keeps a safe distance to whatever is ahead of it",
        categories=_DRIVERS,
        parameters=_speed(45, 10),
    ),
    BehaviourKind(
        id="wrong_way",
        description="drives against its lane's direction and yields to nobody",
        categories=_DRIVERS,
        parameters=_speed(45, 10),
    ),
    BehaviourKind(
        id="cut_in",
        description="drives in its lane; at the trigger moves over by some lanes",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "lanes": _LANES,
            "duration": _number(0.5, 8, 1.5, _DURATION),
        },
    ),
    BehaviourKind(
        id="hard_brake",
        description="drives in its lane; at the trigger brakes hard until it stands",
        categories=_DRIVERS,
        parameters={**_speed(45, 10), "deceleration": _number(1, 9, 7, "m/s^2")},
    ),
    BehaviourKind(
        id="stall",
        description="drives in its lane; at the trigger loses its drive and rolls to a stop",
        categories=_DRIVERS,
        parameters={**_speed(45, 10), "deceleration": _number(0.3, 4, 1.5, "m/s^2")},
    ),
    BehaviourKind(
        id="stop_and_go",
        description="drives in its lane; from the trigger on stops and starts again and again",
        categories=_DRIVERS,
        parameters={**_speed(20, 6), "period": _number(2, 20, 6, "s from stop to stop")},
    ),
    BehaviourKind(
        id="reverse",
        description="stands; at the trigger drives backwards",
        categories=("vehicle",),
        parameters=_speed(10, 3),
    ),
    BehaviourKind(
        id="swerve",
        description="drives in its lane; from the trigger on weaves from side to side",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "amplitude": _number(0.1, 4, 0.8, "m to either side"),
            "period": _number(1, 10, 3, "s"),
        },
    ),
    BehaviourKind(
        id="pull_out",
        description="stands at the roadside; at the trigger accelerates and moves into the lane",
        categories=_DRIVERS,
        parameters={
            **_speed(30, 8),
            "lanes": _number(-3, 3, 0, "lanes to the left of the one it is placed against"),
            "duration": _number(1, 10, 2.5, _DURATION),
        },
    ),
    BehaviourKind(
        id="u_turn",
        description="drives in its lane; at the trigger turns left across the road and drives back",
        categories=_DRIVERS,
        parameters={**_speed(10, 5), "duration": _number(2, 12, 4, "s that the turn takes")},
    ),
    BehaviourKind(
        id="cross_road",
        description="stands; at the trigger moves along its own heading for a distance",
        categories=_WALKERS,
        parameters={**_speed(10, 1.4), "distance": _number(0.5, 60, 12, "m")},
    ),
    BehaviourKind(
        id="hesitate",
        description="stands; at the trigger moves along its heading, pauses and goes back",
        categories=_WALKERS,
        parameters={
            **_speed(10, 1.4),
            "distance": _number(0.5, 30, 4, "m"),
            "pause": _number(0, 20, 2, "s"),
        },
    ),
    BehaviourKind(
        id="walk_along",
        description="moves along its own heading from the trigger on",
        categories=_WALKERS,
        parameters=_speed(10, 1.4),
    ),
    BehaviourKind(
        id="bolt",
        description="stands; at the trigger runs along its own heading",
        categories=("animal", "pedestrian"),
        parameters={**_speed(18, 8), "distance": _number(0.5, 80, 20, "m")},
    ),
    BehaviourKind(
        id="wobble",
        description="rides in its lane; from the trigger on sways from side to side",
        categories=_DRIVERS,
        parameters={
            **_speed(15, 4.5),
            "amplitude": _number(0.1, 2, 0.5, "m to either side"),
            "period": _number(1, 10, 2.5, "s"),
        },
    ),
    BehaviourKind(
        id="drift",
        description="drives in its lane; from the trigger on slowly leaves it",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "lateral": _number(-2, 2, 0.5, "m/s to the left as the ego sees it"),
        },
    ),
)
"""Every behaviour of the kinematic world, for the catalogues of mirror simulators."""
