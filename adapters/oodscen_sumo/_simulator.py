"""The simulator: SUMO drives the traffic; the library guides the ego and bodies without drivers."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from oodscen.data import Catalogue, Scene
from oodscen.driving import DynamicSimulator, KinematicWorld, StagedScene
from oodscen.driving._motion.behaviours.table import having
from oodscen.driving._motion.lane_keeping import PEAK
from oodscen.errors import Issue, SimulatorError, SpawnError
from oodscen.protocols import Camera, Control, Frame
from oodscen_sumo._catalogue import DRIVEN, load_catalogue
from oodscen_sumo._network import Networks, load_sumo
from oodscen_sumo._places import FrontBumper, LanePlace

_CHANGES_LANE = having(lambda row: row.plain_action == "lane_change")
_GRIP_MPS2 = 9.0
"""Maximum braking on a dry road, m/s^2."""
_BRAKING_MPS2, _STOPPING_MPS2 = 4.5, 2.5
"""Braking of drivers without urgency, and in stop-and-go traffic, m/s^2."""
_HEADWAY_S = 1.2
"""Headway of drivers whose behaviour gives none, s."""
_LEAST_SPEED_MPS = 0.1
"""Least maximum speed of a driver, m/s: SUMO takes none of 0."""
_SIMULATION_OPTIONS = (
    "--no-step-log",
    "--no-warnings",
    "--step-method.ballistic",
    "--time-to-teleport=-1",  # Nobody vanishes from a jam.
    "--lateral-resolution=0.4",  # Sublanes let drivers pass what leaves them room, m.
    "--collision.action=none",  # Bodies that touch move on.
    "--default.speeddev=0",
)
_MOVING_MPS = 0.5
"""Least speed of the traffic that a driver minds who cuts out, m/s."""
_AHEAD_M = 200.0
"""Distance within which the body ahead of such a driver is looked for, m."""
_ALL_CHECKS, _NO_CHECKS = 31, 0
"""SUMO's speed modes: drivers mind everything, and guided bodies nothing."""
_SPEED_FACTOR = 100.0
"""Factor of speed limits, which are never reached: the scene's speeds count, not the signs'."""
_LATERAL_ACCELERATION = "10"
"""Maximum sideways acceleration, m/s^2, which leaves the limit to the lateral speed."""
_LATERAL_PEAK = 1.3
"""Greatest lateral speed of a lane change relative to its mean."""
_STANDING_MPS = 0.1
"""Speed up to which SUMO counts a vehicle as halting, m/s."""
_INTERNAL = ":"
"""First letter of the ids of edges between others."""
_END_M = 1.0
"""Distance from the end of the ego's road at which the edge is looked up that drivers make for, m."""


class SumoSimulator(DynamicSimulator):
    """Runs scenes in SUMO's traffic; its drivers mind all bodies, the ego included.

    Pictures are the flat rasteriser's. SUMO allows one simulation per process: a simulator that resets takes
    it from another one, which must reset before it goes on.
    """

    name = "sumo"
    packages = ("libsumo", "eclipse-sumo")
    _owner: ClassVar["SumoSimulator | None"] = None

    def __init__(self) -> None:
        super().__init__()
        self._networks: Networks | None = None
        self._sumo: Any = None
        self._guided: KinematicWorld | None = None
        """Moves the ego and the bodies without drivers; `None` before the first scene."""
        self._rows: dict[str, int] = {}
        self._poses = np.zeros((0, 3))
        self._speeds = np.zeros(0)
        self._grip = _GRIP_MPS2
        """Maximum braking on the road of the scene, m/s^2."""
        self._present: set[str] = set()
        """Ids of the bodies on SUMO's network."""
        self._edges: dict[str, str] = {}
        """Edges on which the drivers were in the step before."""
        self._pause_begins: dict[str, float] = {}
        """Times at which drivers that halt begin to stand, s after their triggers."""

    def catalogue(self) -> Catalogue:
        """Return the available assets, behaviours, maps and weather."""
        return load_catalogue()

    def check(self, scene: Scene) -> Sequence[Issue]:
        """Return an issue for left-hand traffic, or for every driver on the wrong side of the road or who would change to it."""
        staged = StagedScene(scene, self.catalogue())
        if staged.corridor.keeps_left:
            return [
                Issue("map", 'SUMO\'s networks have right-hand traffic, and its road rule="LHT"')
            ]
        sides = [strip.direction for strip in staged.corridor.strips]
        return [
            Issue(
                f"actors[{index}].{_field_of_side(body)}",
                "SUMO's drivers keep to their side of the road",
            )
            for index, body in enumerate(staged.bodies[1:])
            if body.behaviour in DRIVEN and sides[body.goal_lane] != body.direction
        ]

    def begin(self, staged: StagedScene, seed: int) -> None:
        """Load the network and put all bodies on it.

        Raises:
            MissingExtra: If SUMO is not installed.
            SimulatorError: If its network cannot be made.
        """
        self._sumo, programs = load_sumo()
        self._networks = self._networks or Networks(programs)
        assert staged.corridor.road_map is not None
        network = self._networks.path(staged.corridor.road_map.file)
        options = [*_SIMULATION_OPTIONS, "-n", f"{network}", "--step-length", f"{self.dt}"]
        if self._sumo.isLoaded():
            self._sumo.load(options)
        else:
            self._sumo.start(["sumo", *options])
        SumoSimulator._owner = self
        guided = tuple(actor for actor in staged.scene.actors if actor.behaviour.name not in DRIVEN)
        scene = staged.scene.model_copy(update={"actors": guided})
        self._guided = KinematicWorld(staged.corridor, scene, staged.catalogue, seed, dt=self.dt)
        self._rows = {name: row for row, name in enumerate(staged.ids)}
        self._edges, self._pause_begins = {}, {}
        self._poses = np.array([body.pose for body in staged.bodies])[:, [0, 1, 3]]
        self._speeds = np.array([body.speed for body in staged.bodies])
        self._grip = _GRIP_MPS2 * scene.weather.friction
        solid = [body for body in staged.bodies if not body.asset.is_passable(body.state)]
        for body in solid:
            self._add(body)
        self._sumo.simulationStep()
        self._present = set(self._sumo.vehicle.getIDList())
        for body in solid:
            if body.id not in self._present:
                raise SpawnError(body.id, body.asset.id, body.pose, "SUMO found no road for it")
            if body.behaviour in DRIVEN and self._is_turned(body):
                reason = "SUMO's lane runs the other way"
                raise SpawnError(body.id, body.asset.id, body.pose, reason)
            self._sumo.vehicle.setPreviousSpeed(body.id, max(0.0, body.speed))

    def triggered(self, body: StagedScene.Body) -> None:
        """Let a driver change lanes."""
        if body.behaviour in _CHANGES_LANE and body.id in self._present:
            road, parameters = self.staged.corridor, body.parameters or {}
            s, t = road.locate(*self._poses[self._rows[body.id], :2])
            offset_m = road.centre(body.goal_lane, s) - t
            gripping_s = math.sqrt(PEAK * abs(offset_m) / self._grip)
            lateral_speed = _LATERAL_PEAK * abs(offset_m) / max(parameters["duration"], gripping_s)
            self._sumo.vehicle.setMaxSpeedLat(body.id, lateral_speed)
            self._sumo.vehicle.changeSublane(body.id, offset_m * body.direction)

    def move(self, control: Control) -> None:
        """Advance the guided bodies, then SUMO's drivers, who see where the others are."""
        if SumoSimulator._owner is not self:
            raise SimulatorError(
                "sumo: another SumoSimulator has taken SUMO, which runs one scene per process; call reset to take "
                "it back, or give each scene a process of its own"
            )
        for body in self.staged.bodies[1:]:
            since_s = self.since(body.id)
            if body.behaviour == "cut_out" and body.id in self._present:
                self._heed(body)
            if body.id in self._present and body.behaviour in DRIVEN and since_s is not None:
                self._drive(body, since_s)
        assert self._guided is not None
        self._guided.step(control)
        self._guide(self._guided)
        self._sumo.simulationStep()
        vehicles = self._sumo.vehicle
        self._present = set(vehicles.getIDList())
        for row, body in enumerate(self.staged.bodies):
            if body.behaviour in DRIVEN:
                before = self._poses[row].copy()
                if body.id in self._present:
                    self._poses[row] = self._pose(body)
                self._speeds[row] = self._speed(body, self._poses[row] - before)

    def _heed(self, body: StagedScene.Body) -> None:
        """Let a driver who cuts out mind moving traffic only: it means to pass what stands."""
        vehicles = self._sumo.vehicle
        leader, _ = vehicles.getLeader(body.id, _AHEAD_M) or ("", 0.0)
        stands = bool(leader) and vehicles.getSpeed(leader) < _MOVING_MPS
        vehicles.setSpeedMode(body.id, _NO_CHECKS if stands else _ALL_CHECKS)

    def bodies(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return x, y and yaw of all bodies, and their speeds."""
        return self._poses.copy(), self._speeds.copy()

    def draw(self, camera: Camera) -> Frame:
        """Draw boxes on a plane."""
        return self.staged.draw(camera, self.state().poses)

    def release(self) -> None:
        """End SUMO and delete the networks."""
        if SumoSimulator._owner is self:
            self._sumo.close()
            SumoSimulator._owner = None
        if self._networks is not None:
            self._networks.close()
            self._networks = None

    def _add(self, body: StagedScene.Body) -> None:
        """Put one body on the network, with a type of its own."""
        types, vehicles, name = self._sumo.vehicletype, self._sumo.vehicle, body.id
        parameters, (x, y, _, yaw) = body.parameters or {}, body.pose
        types.copy("DEFAULT_VEHTYPE", name)
        types.setLength(name, body.asset.length)
        types.setWidth(name, body.asset.width)
        types.setTau(name, parameters.get("headway", _HEADWAY_S))
        types.setMaxSpeed(name, max(parameters.get("speed", 0.0), _LEAST_SPEED_MPS))
        types.setSpeedFactor(name, _SPEED_FACTOR)
        types.setImperfection(name, 0.0)
        types.setLateralAlignment(name, "arbitrary")
        deceleration = parameters["deceleration"] if body.behaviour == "follow_lane" else _GRIP_MPS2
        deceleration = min(deceleration, self._grip)
        types.setEmergencyDecel(name, deceleration)
        types.setDecel(name, min(_BRAKING_MPS2, deceleration))
        self._sumo.route.add(name, self._route(body))
        vehicles.add(name, name, name, departPos="0")
        vehicles.setLaneChangeMode(name, 0)
        vehicles.setSpeedMode(name, _ALL_CHECKS if body.behaviour in DRIVEN else _NO_CHECKS)
        vehicles.setParameter(name, "laneChangeModel.lcAccelLat", _LATERAL_ACCELERATION)
        if body.behaviour in DRIVEN:
            front = FrontBumper.of(x, y, yaw, length=body.asset.length)
            place = LanePlace.at(self._sumo, front.x, front.y)
            # SUMO itself would fault, and end the process.
            if abs(place.left_m) >= 0.5 * (place.width(self._sumo) + body.asset.width):
                raise SpawnError(name, body.asset.id, body.pose, "SUMO has no lane there")
            x, y, yaw = np.subtract((x, y, yaw), place.shift(self._sumo)).tolist()
        self._put(body, (x, y, yaw))

    def _route(self, body: StagedScene.Body) -> list[str]:
        """Return the edges from a body's start to the end of the ego's road in its direction of travel."""
        road, simulation = self.staged.corridor, self._sumo.simulation
        start = simulation.convertRoad(*body.pose[:2])[0]
        if body.behaviour not in DRIVEN:
            return [start]
        end_s = road.length - _END_M if body.direction > 0 else _END_M
        x, y, *_ = road.point(end_s, road.centre(body.lane, end_s))
        edges = simulation.findRoute(start, simulation.convertRoad(x, y)[0]).edges
        return list(edges) or [start]

    def _is_turned(self, body: StagedScene.Body) -> bool:
        """Return whether a driver's lane in SUMO runs against the driver, whom SUMO would turn round."""
        heading = LanePlace.of(self._sumo, body.id).heading(self._sumo)
        return math.cos(heading - body.pose[3]) < 0.0

    def _pose(self, body: StagedScene.Body) -> tuple[float, float, float]:
        """Return where SUMO has moved a driver: x and y of its centre, m, and its yaw, rad."""
        x, y = self._sumo.vehicle.getPosition(body.id)
        dx, dy, turn = LanePlace.of(self._sumo, body.id).shift(self._sumo)
        angle_deg = self._sumo.vehicle.getAngle(body.id) - math.degrees(turn)
        return FrontBumper(x + dx, y + dy, angle_deg).pose(body.asset.length)

    def _speed(self, body: StagedScene.Body, moved: NDArray[np.float64]) -> float:
        """Return a driver's speed from its motion in the step: x and y, m.

        SUMO's own speed is that along the lane's middle, on which a lane's length is not quite that of its road. It
        counts at the joint of two edges, where SUMO's way is 0.1 m longer than the road.
        """
        vehicles, (_, _, yaw) = self._sumo.vehicle, self._poses[self._rows[body.id]]
        if body.id not in self._present:
            return 0.0
        edge, speed = vehicles.getRoadID(body.id), float(vehicles.getSpeed(body.id))
        before = self._edges.get(body.id, edge)
        self._edges[body.id] = edge
        if speed == 0.0 or edge != before or edge.startswith(_INTERNAL):
            return speed
        mean = (moved[0] * math.cos(yaw) + moved[1] * math.sin(yaw)) / self.dt
        return float(mean) + 0.5 * self.dt * float(vehicles.getAcceleration(body.id))

    def _put(self, body: StagedScene.Body, pose: Sequence[float]) -> None:
        """Move a body to a pose: x and y of its centre, m, and its yaw, rad."""
        x, y, angle = FrontBumper.of(*pose, length=body.asset.length)
        self._sumo.vehicle.moveToXY(body.id, "", -1, x, y, angle, keepRoute=2)

    def _guide(self, guided: KinematicWorld) -> None:
        """Put the ego and all bodies that are not drivers where the library has moved them."""
        poses, speeds = guided.poses()[:, [0, 1, 3]], guided.speeds()
        for name, pose, speed in zip(guided.ids, poses, speeds, strict=True):
            row = self._rows[name]
            self._poses[row], self._speeds[row] = pose, speed
            if name in self._present:
                self._put(self.staged.bodies[row], pose.tolist())
                # Drivers take other guided bodies as standing: no speed along a lane says where they go.
                self._sumo.vehicle.setSpeed(name, float(speed) if name == "ego" else 0.0)

    def _drive(self, body: StagedScene.Body, since_s: float) -> None:
        """Brake or release a driver some time after its trigger, s."""
        parameters = body.parameters or {}
        match body.behaviour:
            case "halt" if self._has_paused(body, since_s):
                braking = 0.0
            case "hard_brake" | "stall" | "halt":
                braking = parameters["deceleration"]
            case "stop_and_go":
                braking = _STOPPING_MPS2 if since_s / parameters["period"] % 1.0 < 0.5 else 0.0
            case _:
                return
        self._sumo.vehicle.setDecel(body.id, min(braking or _BRAKING_MPS2, self._grip))
        self._sumo.vehicle.setSpeed(body.id, 0.0 if braking else -1.0)

    def _has_paused(self, body: StagedScene.Body, since_s: float) -> bool:
        """Return whether a driver that halts has stood for its pause, which begins no earlier than by its own braking."""
        parameters = body.parameters or {}
        if body.id not in self._pause_begins and self._speeds[self._rows[body.id]] <= _STANDING_MPS:
            self._pause_begins[body.id] = max(
                since_s, parameters["speed"] / parameters["deceleration"]
            )
        return since_s >= self._pause_begins.get(body.id, math.inf) + parameters["pause"]


def _field_of_side(body: StagedScene.Body) -> str:
    """Return the field of an actor that puts it on the wrong side of the road."""
    changes_lane = body.goal_lane != body.lane
    return "behaviour.parameters.lanes" if changes_lane else "placement.heading_deg"
