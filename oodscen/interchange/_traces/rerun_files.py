"""Runs as Rerun recordings: camera, depth, boxes, plan view, and every action along the time line."""

import math
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from oodscen._io.files import replace
from oodscen._members import of_the_caller, working
from oodscen._numbers import seed_number
from oodscen.data._episode import ACTIONS
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.data._scene import Scene
from oodscen.driving._base_simulator import render_checked
from oodscen.driving._exclusive import exclusive
from oodscen.driving._motion.actions import is_available
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import MissingExtra
from oodscen.interchange._moving import moving
from oodscen.interchange._recording import RecordedRun, action_states, replayed
from oodscen.interchange._writing.entities import Entity, entities
from oodscen.numerics._exact import Floats
from oodscen.protocols import Camera, Frame, Simulator, State, camera_for
from oodscen.stages._simulate import approach

PICTURE_S = 0.5
"""Time between two pictures of the camera, s."""
_TIME = "time"
_FARTHEST_M = 600.0
"""Greater depths are written as 0 (unknown), m."""
_DEPTH_UNITS_PER_M = 100.0
"""Units of written depths in a metre."""
_LINE_M = 2.0
"""Distance between two points of a lane's edge, m."""
Colour = tuple[int, int, int]

_EGO, _HAZARD, _OTHER = (40, 120, 240), (230, 60, 40), (150, 150, 150)
"""Colours of bodies."""
_LANE = (90, 90, 90)
"""Colour of the edges of lanes."""


def write_rerun(
    scene: Scene,
    simulator: Simulator,
    path: str | Path,
    *,
    action: str = "keep_speed",
    seed: int = 0,
    every_s: float = PICTURE_S,
    reaction_s: float = NOMINAL_REACTION_S,
) -> None:
    """Write a scene's run as a Rerun recording (`.rrd`).

    `world` has the lanes and the boxes of all bodies, and the ego's camera with picture and depth; `plan` has the same
    from above, with the ego's path by every available action; `actions` has the ego's speed, acceleration and distance
    to the nearest body, from centre to centre, by each of them. Time is simulation time.

    Args:
        scene: The scene or ordinary drive.
        simulator: The simulator that draws the pictures.
        path: The file to write.
        action: The ego's action after the decision, in the world and in the pictures.
        seed: Seed of the scene's random streams.
        every_s: Time between two pictures, s.
        reaction_s: Time from the decision until the ego acts, s.

    Raises:
        MissingExtra: If Rerun is not installed.
        SceneError: If the catalogue or the road refuses the scene.
        UnknownComponent: If there is no such action.
        UsageError: If the ego lacks the lane that the action needs, or another thread uses the simulator.
        SimulatorError: If the simulator fails, whatever it raises.
    """
    rerun = rerun_library()
    catalogue = simulator.catalogue()
    corridor = load_corridor(scene.map, catalogue)
    seed_number(seed)
    with moving(simulator, catalogue) as world:
        approach(scene, world, seed)
        available = [name for name in ACTIONS if is_available(name, world.observe())]
        names = dict.fromkeys((action, *available))
        runs = {name: replayed(scene, world, name, seed, reaction_s) for name in names}
    bodies = entities(scene, catalogue)
    with TemporaryDirectory() as folder:
        part = Path(folder) / "run.rrd"
        with rerun.RecordingStream("oodscen", recording_id=scene.id) as stream:
            stream.save(part, default_blueprint=_views(rerun))
            log = _Log(rerun, stream)
            log.lanes(corridor)
            log.bodies(scene, bodies, runs[action])
            for name, run in runs.items():
                log.action(name, run)
            _film(log, simulator, every_s, _states(scene, simulator, action, seed, reaction_s))
            stream.flush()
        stream.disconnect()
        replace(Path(path), part.read_bytes())


def _film(log: "_Log", simulator: Simulator, every_s: float, states: Iterator[State]) -> None:
    """Write what the ego's camera sees at regular times."""
    camera = camera_for(simulator.catalogue())
    log.camera(camera)
    steps = max(1, round(every_s / simulator.dt))
    with exclusive(simulator), working("simulator", simulator.name):
        for number, state in enumerate(states):
            if number % steps == 0:
                frame = render_checked(simulator, camera, len(state.ids))
                with of_the_caller():
                    log.picture(state.time, frame)


def _states(
    scene: Scene, simulator: Simulator, action: str, seed: int, reaction_s: float
) -> Iterator[State]:
    """Yield the states of the approach and one action; the simulator is in the yielded state."""
    _, controls, _ = approach(scene, simulator, seed)
    state = simulator.reset(scene, seed)
    yield state
    for control in controls:
        state = simulator.step(control)
        yield state
    yield from action_states(scene, simulator, state, action, reaction_s)


def rerun_library() -> Any:
    """Return the package that writes recordings for the Rerun viewer.

    Raises:
        MissingExtra: If it is not installed.
    """
    try:
        import rerun
    except ImportError:
        raise MissingExtra("the recording", "rerun", "rerun-sdk") from None
    return rerun


def _views(rerun: Any) -> Any:
    """Return the layout in which the viewer opens the recording."""
    views = rerun.blueprint
    return views.Blueprint(
        views.Horizontal(
            views.Vertical(
                views.Spatial2DView(origin="/world/ego/camera", name="camera"),
                views.Spatial2DView(origin="/plan", name="plan"),
            ),
            views.Vertical(
                views.Spatial3DView(origin="/world", name="world"),
                *(
                    views.TimeSeriesView(origin="/actions", contents=f"$origin/*/{name}", name=name)
                    for name in ("speed", "acceleration", "distance")
                ),
            ),
        )
    )


class _Log:
    """Writes the parts of one run to a stream."""

    def __init__(self, rerun: Any, stream: Any) -> None:
        self.rerun = rerun
        self.stream = stream
        stream.log("world", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)

    def lanes(self, corridor: Corridor) -> None:
        """Write the edges of all lanes, in the world and in the plan."""
        lines = []
        thin = slice(None, None, max(1, round(_LINE_M / corridor.step)))
        for road in (corridor, *(other.corridor for other in corridor.others)):
            for strip in road.strips:
                for edge in (strip.left, strip.right):
                    points = (road.x - road.sin * edge, road.y + road.cos * edge, road.z)
                    lines.append(np.stack(points, axis=1)[thin])
        self.stream.log("world/lanes", self.rerun.LineStrips3D(lines, colors=_LANE), static=True)
        plans = [_plan(line) for line in lines]
        self.stream.log("plan/lanes", self.rerun.LineStrips2D(plans, colors=_LANE), static=True)

    def bodies(self, scene: Scene, bodies: list[Entity], run: RecordedRun) -> None:
        """Write the boxes of all bodies and their courses, in the world and in the plan."""
        colours = [_colour(body, scene) for body in bodies]
        for body, colour, poses in zip(bodies, colours, run.poses.swapaxes(0, 1), strict=True):
            self._body(body, colour, poses, self._times(run))
        outlines = np.stack(
            [_outlines(run.poses[:, row], body) for row, body in enumerate(bodies)], 1
        )
        names = [body.name for body in bodies]
        for time, shapes in zip(run.time.tolist(), outlines, strict=True):
            self.stream.set_time(_TIME, duration=time)
            strips = self.rerun.LineStrips2D(list(shapes), colors=colours, labels=names)
            self.stream.log("plan/bodies", strips)

    def _body(self, body: Entity, colour: Colour, poses: Floats, times: Any) -> None:
        """Write the box of one body and its course, [n, 4], in the world."""
        rerun, size, path = self.rerun, body.asset, f"world/{body.name}"
        half = 0.5 * np.array([size.length, size.width, size.height])
        box = rerun.Boxes3D(
            half_sizes=[half], centers=[[0, 0, half[2]]], labels=body.name, colors=[colour]
        )
        self.stream.log(f"{path}/box", box, static=True)
        quaternions = np.zeros((len(poses), 4))
        quaternions[:, 2], quaternions[:, 3] = np.sin(0.5 * poses[:, 3]), np.cos(0.5 * poses[:, 3])
        course = rerun.Transform3D.columns(translation=poses[:, :3], quaternion=quaternions)
        self.stream.send_columns(path, [times], course)

    def action(self, name: str, run: RecordedRun) -> None:
        """Write the ego's path, speed, acceleration and distance to the nearest body, centre to centre, by one action."""
        rerun, times = self.rerun, self._times(run)
        path = rerun.LineStrips2D([_plan(run.poses[:, 0])], labels=name)
        self.stream.log(f"plan/actions/{name}", path, static=True)
        speeds = run.speeds[:, 0]
        columns = {"speed": speeds, "acceleration": run.rates(speeds)}
        offsets = run.poses[:, 1:, :2] - run.poses[:, :1, :2]
        if offsets.shape[1]:
            columns["distance"] = np.hypot(offsets[:, :, 0], offsets[:, :, 1]).min(axis=1)
        for quantity, column in columns.items():
            scalars = rerun.Scalars.columns(scalars=column)
            self.stream.send_columns(f"actions/{name}/{quantity}", [times], scalars)

    def camera(self, camera: Camera) -> None:
        """Write the camera's place on the ego and its lens."""
        rerun, name = self.rerun, "world/ego/camera"
        half_yaw = 0.5 * math.radians(camera.yaw_deg)
        half_pitch = 0.5 * math.radians(camera.pitch_deg)
        attitude = (
            -math.sin(half_yaw) * math.sin(half_pitch),
            math.cos(half_yaw) * math.sin(half_pitch),
            math.sin(half_yaw) * math.cos(half_pitch),
            math.cos(half_yaw) * math.cos(half_pitch),
        )
        mount = rerun.Transform3D(
            translation=(camera.x, camera.y, camera.z), quaternion=rerun.Quaternion(xyzw=attitude)
        )
        self.stream.log(name, mount, static=True)
        lens = rerun.Pinhole(
            focal_length=0.5 * camera.width / math.tan(math.radians(0.5 * camera.fov_deg)),
            width=camera.width,
            height=camera.height,
            camera_xyz=rerun.ViewCoordinates.FLU,
        )
        self.stream.log(name, lens, static=True)

    def picture(self, time: float, frame: Frame) -> None:
        """Write the camera's picture and depth at a time, s."""
        name = "world/ego/camera"
        self.stream.set_time(_TIME, duration=time)
        self.stream.log(f"{name}/picture", self.rerun.Image(frame.rgb).compress())
        depth_m = np.where(frame.depth < _FARTHEST_M, frame.depth, 0.0)
        depth = np.round(depth_m * _DEPTH_UNITS_PER_M).astype(np.uint16)
        self.stream.log(f"{name}/depth", self.rerun.DepthImage(depth, meter=_DEPTH_UNITS_PER_M))

    def _times(self, run: RecordedRun) -> Any:
        return self.rerun.TimeColumn(_TIME, duration=run.time)


def _colour(body: Entity, scene: Scene) -> Colour:
    if body.name == "ego":
        return _EGO
    return _HAZARD if body.name in scene.hazard.actors else _OTHER


def _plan(points: Floats) -> Floats:
    """Return points from above, with y downwards, as in images."""
    return points[:, :2] * (1.0, -1.0)


def _outlines(poses: Floats, body: Entity) -> Floats:
    """Return the closed outline of a footprint at every step: [n, 5, 2]."""
    ahead = 0.5 * body.asset.length * np.array([1, 1, -1, -1, 1])
    aside = 0.5 * body.asset.width * np.array([1, -1, -1, 1, 1])
    cos, sin = np.cos(poses[:, 3:4]), np.sin(poses[:, 3:4])
    x = poses[:, 0:1] + ahead * cos - aside * sin
    y = poses[:, 1:2] + ahead * sin + aside * cos
    return np.stack([x, -y], axis=2)
