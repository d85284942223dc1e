"""The simulator: SUMO drives the traffic; the library guides the ego and bodies without drivers."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from oodscen.data import Catalogue, Scene
from oodscen.driving import DynamicSimulator, KinematicWorld, StagedScene
from oodscen.driving._motion.behaviours import having
from oodscen.errors import Issue, SimulatorError, SpawnError
from oodscen.protocols import Camera, Control, Frame
from oodscen_sumo._catalogue import DRIVEN, load_catalogue
from oodscen_sumo._network import Networks, load_sumo

CHANGES_LANE = having(lambda row: row.plain_action == "lane_change")
GRIP = 9.0
"""Maximum braking on a dry road, m/s^2."""
BRAKING, STOPPING = 4.5, 2.5
"""Braking of drivers without urgency, and in stop-and-go traffic, m/s^2."""
OPTIONS = (
    "--no-step-log --no-warnings --step-method.ballistic --time-to-teleport -1 "
    "--lateral-resolution 0.4 --collision.action none --default.speeddev 0"
).split()
"""Sublanes let drivers pass what leaves them room; bodies that touch move on."""


class SumoSimulator(DynamicSimulator):
    """Runs scenes in SUMO's traffic; its drivers mind all bodies, the ego included.

    Pictures are the flat rasteriser's. SUMO allows one simulation per process: a simulator that resets takes
    it from another one, which must reset before it goes on.
    """

    name = "sumo"
    _owner: ClassVar["SumoSimulator | None"] = None

    def __init__(self) -> None:
        """Start nothing yet."""
        super().__init__()
        self._networks: Networks | None = None
        self._sumo: Any = None
        self._guided: Any = None

    def catalogue(self) -> Catalogue:
        """Return the available assets, behaviours, maps and weather."""
        return load_catalogue()

    def check(self, scene: Scene) -> Sequence[Issue]:
        """Return an issue for every driver who would change into an oncoming lane."""
        staged = StagedScene(scene, self.catalogue())
        sides = [strip.direction for strip in staged.corridor.strips]
        return [
            Issue(f"actors[{index}].behaviour.parameters.lanes", "drivers keep to their side")
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
        options = [*OPTIONS, "-n", f"{network}", "--step-length", f"{self.dt}"]
        if self._sumo.isLoaded():
            self._sumo.load(options)
        else:
            self._sumo.start(["sumo", *options])
        SumoSimulator._owner = self
        guided = tuple(one for one in staged.scene.actors if one.behaviour.name not in DRIVEN)
        scene = staged.scene.model_copy(update={"actors": guided})
        self._guided = KinematicWorld(staged.corridor, scene, staged.catalogue, seed, dt=self.dt)
        self._poses = np.array([body.pose for body in staged.bodies])[:, [0, 1, 3]]
        self._speeds = np.array([body.speed for body in staged.bodies])
        self._grip = GRIP * scene.weather.friction
        solid = [body for body in staged.bodies if not body.asset.is_passable(body.state)]
        for body in solid:
            self._add(body)
        self._sumo.simulationStep()
        self._present = set(self._sumo.vehicle.getIDList())
        for body in solid:
            if body.id not in self._present:
                raise SpawnError(body.id, body.asset.id, body.pose, "SUMO found no road for it")
            self._sumo.vehicle.setPreviousSpeed(body.id, max(0.0, body.speed))

    def triggered(self, body: StagedScene.Body) -> None:
        """Let a driver change lanes."""
        if body.behaviour in CHANGES_LANE and body.id in self._present:
            road, given = self.staged.corridor, body.parameters or {}
            s, t = road.locate(*self._poses[self.staged.ids.index(body.id), :2])
            aside = road.centre(body.goal_lane, s) - t
            self._sumo.vehicle.setMaxSpeedLat(body.id, 1.3 * abs(aside) / given["duration"])
            self._sumo.vehicle.changeSublane(body.id, aside * body.direction)

    def move(self, control: Control) -> None:
        """Advance the guided bodies, then SUMO's drivers, who see where the others are."""
        if SumoSimulator._owner is not self:
            raise SimulatorError(
                "sumo: another SumoSimulator has taken SUMO, which runs one scene per process; call reset to take "
                "it back, or give each scene a process of its own"
            )
        for body in self.staged.bodies[1:]:
            waited = self.since(body.id)
            if body.id in self._present and body.behaviour in DRIVEN and waited is not None:
                self._drive(body, waited)
        self._guided.step(control)
        self._guide()
        self._sumo.simulationStep()
        vehicles = self._sumo.vehicle
        self._present = set(vehicles.getIDList())
        for row, body in enumerate(self.staged.bodies):
            if body.behaviour in DRIVEN and body.id in self._present:
                yaw = math.remainder(math.radians(90.0 - vehicles.getAngle(body.id)), math.tau)
                (x, y), half = vehicles.getPosition(body.id), 0.5 * body.asset.length
                self._poses[row] = (x - half * math.cos(yaw), y - half * math.sin(yaw), yaw)
                self._speeds[row] = vehicles.getSpeed(body.id)

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
        given, (x, y, _, yaw) = body.parameters or {}, body.pose
        types.copy("DEFAULT_VEHTYPE", name)
        types.setLength(name, body.asset.length)
        types.setWidth(name, body.asset.width)
        types.setTau(name, given.get("headway", 1.2))
        types.setMaxSpeed(name, max(given.get("speed", 0.0), 0.1))
        types.setSpeedFactor(name, 100.0)  # The scene's speeds count, not the signs'.
        types.setImperfection(name, 0.0)
        types.setLateralAlignment(name, "arbitrary")
        most = given["deceleration"] if body.behaviour == "follow_lane" else GRIP
        types.setEmergencyDecel(name, min(most, self._grip))
        types.setDecel(name, min(BRAKING, most, self._grip))
        self._sumo.route.add(name, [self._sumo.simulation.convertRoad(x, y)[0]])
        vehicles.add(name, name, name, departPos="0")
        vehicles.setLaneChangeMode(name, 0)
        vehicles.setSpeedMode(name, 31 if body.behaviour in DRIVEN else 0)
        vehicles.setParameter(name, "laneChangeModel.lcAccelLat", "10")
        self._put(body, (x, y, yaw))

    def _put(self, body: StagedScene.Body, place: Sequence[float]) -> None:
        """Move a body to a place; SUMO's places are those of front bumpers."""
        (x, y, yaw), half = place, 0.5 * body.asset.length
        x, y = x + half * math.cos(yaw), y + half * math.sin(yaw)
        self._sumo.vehicle.moveToXY(body.id, "", -1, x, y, 90.0 - math.degrees(yaw), keepRoute=2)

    def _guide(self) -> None:
        """Put the ego and all bodies that are not drivers where the library has moved them."""
        poses, speeds = self._guided.poses()[:, [0, 1, 3]], self._guided.speeds()
        for name, place, speed in zip(self._guided.ids, poses, speeds, strict=True):
            row = self.staged.ids.index(name)
            self._poses[row], self._speeds[row] = place, speed
            if name in self._present:
                self._put(self.staged.bodies[row], place.tolist())
                # Drivers take other guided bodies as standing: no speed along a lane says where they go.
                self._sumo.vehicle.setSpeed(name, float(speed) if name == "ego" else 0.0)

    def _drive(self, body: StagedScene.Body, waited: float) -> None:
        """Let a driver brake, or go on, as its behaviour says some time after its trigger."""
        given = body.parameters or {}
        match body.behaviour:
            case "halt" if waited >= given["speed"] / given["deceleration"] + given["pause"]:
                braking = 0.0
            case "hard_brake" | "stall" | "halt":
                braking = given["deceleration"]
            case "stop_and_go":
                braking = STOPPING if waited / given["period"] % 1.0 < 0.5 else 0.0
            case _:
                return
        self._sumo.vehicle.setDecel(body.id, min(braking or BRAKING, self._grip))
        self._sumo.vehicle.setSpeed(body.id, 0.0 if braking else -1.0)
