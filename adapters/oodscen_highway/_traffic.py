"""The scene in highway-env's terms: lanes along the corridor, the ego, drivers, walkers and obstacles.

This is the one module that imports highway-env.
"""

import math
import os
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen.driving import Corridor, StagedScene
from oodscen.driving._motion.behaviours.table import having
from oodscen.driving._motion.lane_keeping import PEAK

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # Its greeting goes to standard output.

from highway_env.road.lane import AbstractLane
from highway_env.road.road import Road, RoadNetwork
from highway_env.vehicle.behavior import IDMVehicle
from highway_env.vehicle.kinematics import Vehicle
from highway_env.vehicle.objects import Landmark, Obstacle

_Locate = Callable[[float, float], tuple[float, float]]

_GRIP_MPS2 = 9.0
"""Maximum braking on a dry road, m/s^2."""
_BESIDE_M = 0.3
"""Distance from the lane up to which drivers mind a body's middle, m."""
_EDGES = {1: ("start", "end"), -1: ("far", "near")}
"""Nodes of highway-env's network between which the lanes of each direction of travel lie."""
_STOPPING_MPS2 = 2.5
"""Braking in stop-and-go traffic, m/s^2."""
_HEADWAY_S = 1.2
"""Headway of drivers whose behaviour gives none, s."""
_STANDING_MPS = 0.01
"""Speed up to which a driver that halts stands, m/s."""
_MOVING_MPS = 0.5
"""Least speed of the traffic that a driver minds who cuts out, m/s."""
_CHANGE_GAIN = 4.5
"""Gain with which a lane change takes its duration from 5 to 95 % of the way, times that duration."""
_STRAIGHT_ON = having(lambda row: row.keeps_heading)
"""Behaviours that keep their heading."""
_CHANGES_LANE = having(lambda row: row.plain_action == "lane_change")
"""Behaviours that change lanes at their trigger."""


class CorridorLane(AbstractLane):  # type: ignore[misc]  # highway-env has no types.
    """One driving lane of a corridor, in one direction of travel."""

    line_types = (0, 0)

    def __init__(self, road: Corridor, locate: _Locate, strip: int, direction: int) -> None:
        self.road, self.locate, self.strip, self.direction = road, locate, strip, direction
        self.length = road.length
        self.forbidden = road.strips[strip].direction != direction
        self.speed_limit = None

    def _s(self, longitudinal: float) -> float:
        return longitudinal if self.direction > 0 else self.length - longitudinal

    def position(self, longitudinal: float, lateral: float) -> NDArray[np.float64]:
        """Return x and y of a place in the lane."""
        s = self._s(longitudinal)
        x, y, *_ = self.road.point(s, self.road.centre(self.strip, s) + self.direction * lateral)
        return np.array([x, y])

    def heading_at(self, longitudinal: float) -> float:
        """Return the direction of travel."""
        return self.road.heading(self._s(longitudinal)) + (0.0 if self.direction > 0 else math.pi)

    def width_at(self, longitudinal: float) -> float:
        """Return the width."""
        right, left = self.road.edges(self.strip, self._s(longitudinal))
        return left - right

    def local_coordinates(self, position: NDArray[np.float64]) -> tuple[float, float]:
        """Return the place in the lane of x and y."""
        s, t = self.locate(float(position[0]), float(position[1]))
        return self._s(s), self.direction * (t - self.road.centre(self.strip, s))

    def on_lane(self, position: Any, s: Any = None, t: Any = None, margin: float = 0.0) -> bool:
        """Return whether a body there is in the way; highway-env minds those a metre aside, too."""
        return bool(super().on_lane(position, s, t, min(margin, _BESIDE_M)))


class HighwayActor(IDMVehicle):  # type: ignore[misc]
    """A moving body: highway-env's driver in its lane, or its bicycle straight on."""

    speed: float
    """m/s; negative in reverse."""
    since_s: float | None = None
    """Time since the trigger, s; `None` before."""
    covered_m = 0.0
    """Distance gone so far, m."""

    def __init__(self, road: Road, body: StagedScene.Body, grip: float) -> None:
        self.behaviour, self.parameters = body.behaviour, dict(body.parameters or {})
        self.is_driving = self.behaviour not in _STRAIGHT_ON
        goal = self.parameters.get("speed", body.speed)
        super().__init__(road, body.pose[:2], body.pose[3], body.speed, enable_lane_change=False)
        self.target_speed = -goal if self.behaviour == "reverse" else goal
        edge = _EDGES[body.direction]
        strips = [lane.strip for lane in road.network.graph[edge[0]][edge[1]]]
        self.lane_index = self.target_lane_index = (*edge, strips.index(body.lane))
        self.goal_index = (*edge, strips.index(body.goal_lane))
        _, shift_m = road.network.get_lane(self.goal_index).local_coordinates(self.position)
        gripping_s = math.sqrt(PEAK * abs(shift_m) / grip)
        self.change_s = max(self.parameters.get("duration", 0.0), gripping_s)
        """Time that a lane change takes, s: the scene's, or longer if the tyres need it."""
        self.LENGTH, self.grip = body.asset.length, grip
        self.TIME_WANTED = self.parameters.get("headway", _HEADWAY_S)
        self.DISTANCE_WANTED = 2.0 + self.LENGTH
        self.ACC_MAX = grip
        gentle = self.parameters["deceleration"] if self.behaviour == "follow_lane" else grip
        self.braking = min(gentle, grip)
        """Largest deceleration, m/s^2."""
        self.pause_begins: float | None = None
        """Time at which a driver that halts begins to stand, s after its trigger; `None` before."""

    def lane_distance_to(self, other: Any, lane: Any = None) -> float:
        """Return the distance between the middles as if the other were as long as this body."""
        distance: float = super().lane_distance_to(other, lane)
        return distance - 0.5 * float(other.LENGTH - self.LENGTH)

    def act(self, action: Any = None) -> None:
        """Choose steering and acceleration."""
        if self.since_s is not None and self.behaviour in _CHANGES_LANE:
            self.target_lane_index = self.goal_index
            # highway-env's gain would jump aside at once; growing, it takes the change's time.
            most = _CHANGE_GAIN / self.change_s
            gain = most * self.since_s / self.change_s
            self.KP_LATERAL = min(gain, max(most, IDMVehicle.KP_LATERAL))
        super().act()
        if not self.is_driving:
            self.action["steering"] = 0.0
        chosen = self._acceleration(self.action["acceleration"])
        chosen = min(max(chosen, -self.braking), self.grip)
        if self.target_speed >= 0.0:
            chosen = max(chosen, -self.speed / self.dt)
        self.action["acceleration"] = chosen

    def acceleration(
        self, ego_vehicle: Vehicle, front_vehicle: Any = None, rear_vehicle: Any = None
    ) -> float:
        """Return the driver model's acceleration; a driver who cuts out means to pass what stands."""
        if front_vehicle is not None and self.behaviour == "cut_out":
            away = float(front_vehicle.velocity @ self.direction)
            front_vehicle = front_vehicle if away >= _MOVING_MPS else None
        return float(super().acceleration(ego_vehicle, front_vehicle, rear_vehicle))

    def _acceleration(self, following: float) -> float:
        parameters, since_s = self.parameters, self.since_s
        match self.behaviour:
            case "hard_brake" | "stall" if since_s is not None:
                return -parameters["deceleration"]
            case "halt" if since_s is not None:
                has_paused = self._has_paused(since_s)
                return following if has_paused else min(-parameters["deceleration"], following)
            case "stop_and_go" if (
                since_s is not None and since_s / parameters["period"] % 1.0 < 0.5
            ):
                return min(-_STOPPING_MPS2, following)
            case "wrong_way":
                return float(self.speed_control(self.target_speed))
        if self.is_driving:
            return following
        if since_s is None and self.behaviour != "run_red":
            return 0.0
        limit: float = parameters.get("acceleration", float(self.COMFORT_ACC_MAX))
        return float(np.clip(self.speed_control(self.target_speed), -limit, limit))

    def _has_paused(self, since_s: float) -> bool:
        """Return whether a driver that halts has stood for its pause, which begins no earlier than by its own braking."""
        if self.pause_begins is None and self.speed <= _STANDING_MPS:
            self.pause_begins = max(
                since_s, self.parameters["speed"] / self.parameters["deceleration"]
            )
        return (
            self.pause_begins is not None
            and since_s >= self.pause_begins + self.parameters["pause"]
        )

    def step(self, dt: float) -> None:
        """Move by one step; a body that goes a distance stops at its end at once."""
        left = self.parameters.get("distance", math.inf) - self.covered_m
        arrives = self.speed * dt >= left
        if arrives:
            self.speed = left / dt
        before = self.position.copy()
        super().step(dt)
        self.covered_m += float(np.hypot(*(self.position - before)))
        if arrives:
            self.speed = self.target_speed = 0.0
        if self.since_s is not None:
            self.since_s += dt


def road_of(staged: StagedScene, seed: int) -> Road:
    """Return highway-env's road: every driving lane in both directions of travel."""
    road = staged.corridor
    locate = lru_cache(maxsize=64)(road.locate)
    network = RoadNetwork()
    for direction, edge in _EDGES.items():
        for strip in road.driving:
            network.add_lane(*edge, CorridorLane(road, locate, strip, direction))
    return Road(network, np_random=np.random.RandomState(seed))


def add_body(road: Road, staged: StagedScene, body: StagedScene.Body, dt: float) -> Any:
    """Put a body of the scene on the road, and return it in highway-env's terms."""
    position, heading = body.pose[:2], body.pose[3]
    placed: Any
    if body.behaviour == "stand":
        kind = Landmark if body.asset.is_passable(body.state) else Obstacle
        placed = kind(road, position, heading)
        road.objects.append(placed)
    else:
        if body.behaviour:
            placed = HighwayActor(road, body, _GRIP_MPS2 * staged.scene.weather.friction)
        else:
            placed = Vehicle(road, position, heading, body.speed)
        road.vehicles.append(placed)
    placed.LENGTH, placed.WIDTH, placed.dt = body.asset.length, body.asset.width, dt
    placed.MAX_SPEED = math.inf
    placed.collidable = False  # highway-env stops bodies that touch; here they move on.
    return placed
