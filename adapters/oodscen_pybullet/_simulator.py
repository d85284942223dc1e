"""The reference simulator: PyBullet's bodies and camera, motion by the kinematic world."""

import math
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Scene
from oodscen.driving import MirrorSimulator
from oodscen.driving._roads.building import find_map
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.lamps import has_lamps_on
from oodscen.errors import SpawnError
from oodscen.numerics import _exact as exact
from oodscen.protocols import Camera, Frame
from oodscen_pybullet._catalogue import load_catalogue
from oodscen_pybullet._contacts import Bodies
from oodscen_pybullet._engine import load_pybullet
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shelter import Portal, Shelter
from oodscen_pybullet._meshes import Mesh, asset_ids, register_design
from oodscen_pybullet._meshes.atlas import Snow
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._meshes.tilting import tilt_of
from oodscen_pybullet._meshes.vehicles.ego import bonnet
from oodscen_pybullet._rendering.appearance import Look, SceneBodies, is_lit, mesh_of
from oodscen_pybullet._rendering.cameras import choose_camera
from oodscen_pybullet._rendering.particles import covered_pixels
from oodscen_pybullet._rendering.picture import develop
from oodscen_pybullet._rendering.stage import PlacedPuff, RawPicture, Shot, Stage
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._scenery.roadside import Scenery, build_scenery
from oodscen_pybullet._scenery.signals import replaced_signals
from oodscen_pybullet._types import I32, Array, Pose

REACH_M = 20.0
"""Upper limit of measured gaps, m."""
_STAGES = 16
"""Number of roads whose scenery stays loaded."""
DARK = 0.2
"""Daylight at and below which nothing casts a shadow."""
_LIT_DEG = 1.0
"""Sun elevation below which windows are lit, degrees."""
_SNOWED_ROADS_MM_H = 1.0
"""Snowfall rate below which the roads are cleared, and only the land is white, mm/h."""
_INSIDE_M = (2.4, 1.0, 1.6)
"""Distances ahead of the ego's middle, beside it and above the road within which a camera is in the ego, m."""
_ON_M = (0.5, 0.3, 1.5)
"""Distances from the ego's ends, from its sides and above its roof within which a camera is on the ego, m."""
_ASIDE = 1e-9
"""Cosine of the angle between the ego's heading and a camera up to which the camera does not look forward."""


class PyBulletSimulator(MirrorSimulator):
    """Shows scenes with PyBullet; needs no display.

    PyBullet measures the distances between the catalogue's boxes; pictures come from a software
    rasteriser, which adds light and weather from depth, or without numba from PyBullet's own camera,
    with a `RuntimeWarning`. The engine starts with the first scene; the camera's world is built for
    the first picture. The very first picture after installation takes some seconds while the
    rasteriser is compiled; numba caches the result on disk.
    """

    name = "pybullet"
    packages = ("pybullet", "numba", "opencv-python-headless")

    def __init__(self) -> None:
        """Start nothing yet."""
        super().__init__()
        self._engine: Any = None
        self._open_stage: Callable[[], Stage]
        self._bodies: Bodies | None = None
        self._stages: OrderedDict[tuple[object, ...], tuple[Stage, Scenery]] = OrderedDict()
        self._loaded: tuple[Corridor, Scene, int] | None = None
        self._made: dict[str, str] = {}
        self._cast: SceneBodies
        self._poses: list[Pose] = []
        self._speeds: list[float] = []
        self._shown: tuple[Stage, bool, list[Look]] | None = None
        """The stage whose actors are those of the last picture, and what it shows."""

    def catalogue(self) -> Catalogue:
        """Return the available assets, behaviours, maps and weather."""
        return load_catalogue()

    def load(self, corridor: Corridor, scene: Scene, seed: int) -> None:
        """Clear the world; the scenery is built for the first picture.

        Raises:
            MissingExtra: If PyBullet or OpenCV is not installed.
        """
        if self._bodies is None:
            self._engine = load_pybullet()
            self._open_stage = choose_camera(self._engine)
            self._bodies = Bodies(self._engine)
        self._bodies.clear()
        self._loaded = (corridor, scene, seed)
        self._made = {prop.id: register_design(prop) for prop in scene.made}
        self._cast = SceneBodies(scene, seed)
        self._poses, self._speeds = [], []
        self._shown = None

    def spawn(self, actor_id: str, asset: Asset, state: str, pose: Pose) -> None:
        """Add one body.

        Raises:
            SpawnError: If the asset has no mesh, the pose is not finite, or the engine refuses the body.
        """
        assert self._bodies is not None
        if not all(map(math.isfinite, pose)):
            raise SpawnError(actor_id, asset.id, pose, "the pose is not finite")
        if asset.id in self._made:
            asset = asset.model_copy(update={"id": self._made[asset.id]})
        elif asset.id not in asset_ids():
            raise SpawnError(actor_id, asset.id, pose, "the asset has no mesh")
        if not self._bodies.add(asset.length, asset.width, asset.height):
            raise SpawnError(actor_id, asset.id, pose, "PyBullet refused the collision shape")
        self._cast.add(actor_id, asset, state, self._made)

    def place(self, poses: Array, speeds: Array) -> None:
        """Store the poses and speeds; bodies move when a gap or a picture needs them."""
        self._poses = [(x, y, z, yaw) for x, y, z, yaw in poses.tolist()]
        self._speeds = speeds.tolist()

    def gaps(self, rows: Sequence[int]) -> list[float]:
        """Return the distances from the ego's box to others, m."""
        bodies = self._bodies
        assert bodies is not None
        bodies.move(0, self._poses[0])
        distances = []
        for row in rows:
            bodies.move(row, self._poses[row])
            distances.append(bodies.distance(0, row, REACH_M))
        return distances

    def draw(self, camera: Camera) -> Frame:
        """Return the dash camera's picture of the current state."""
        return self.draw_from(
            camera,
            self._poses[0],
            accelerations=self.world.accelerations().tolist(),
            fired=[self.world.motion(name).triggered for name in self.world.ids],
            time=self.world.time,
            tilts=self.world.tilts(),
            counts=True,
            threads=1,
        )

    def draw_from(
        self,
        camera: Camera,
        mount: Pose,
        *,
        accelerations: Sequence[float],
        fired: Sequence[float] = (),
        time: float,
        roll_deg: float = 0.0,
        tilts: Mapping[int, tuple[float, float, float]] = MappingProxyType({}),
        counts: bool = False,
        threads: int = 2,
    ) -> Frame:
        """Return the picture of a camera anywhere; needs `load`, `spawn` and `place`, but no world.

        Args:
            camera: The camera, relative to `mount`.
            mount: x, y, z, m, and yaw, rad, of what the camera is mounted on.
            accelerations: Accelerations of all bodies along their headings, m/s^2.
            fired: Times at which the triggers fired, s, negative before; by default none has.
            time: Time since the start, s.
            roll_deg: Roll of the camera, degrees, clockwise; the sky stays level.
            tilts: Pitch and roll, rad, and the height about which it turns, m, of every tilted body by row.
            counts: Whether to count the pixels of `Frame.unhidden`.
            threads: Number of threads that work at the picture, which is the same with any.
        """
        assert self._loaded is not None
        _, scene, seed = self._loaded
        stage, scenery = self._stage_at(time)
        fired = fired or [-1.0] * len(self._poses)
        looks = self._cast.looks(self._poses, self._speeds, accelerations, fired, time)
        view = CameraView.of(camera, mount, roll_deg)
        # As the sun sinks beams are faintly seen; once vehicles have lamps on, only the beams of those that do.
        has_beams = looks[0].running or not has_lamps_on(scene, "ego")
        if not (has_beams and _sees_by_beams(view, self._poses[0], self._cast.assets[0])):
            view = replace(view, is_lit=False)
        for row, tilt in tilts.items():
            looks[row] = looks[row]._replace(tilt=tilt_of(*tilt))
        is_inside = _is_inside(view, self._poses[0])
        self._show_actors(stage, looks, is_inside=is_inside)
        poses = self._poses_on(scenery)
        stage.pose_actors(poses)
        shot, light, portal = self._take(stage, view, poses[0][2])
        lamps, balls = _lamps_and_smoke(looks, poses, has_ego_lamps=not (is_inside or view.is_lit))
        picture = RawPicture(
            shot=shot,
            view=view,
            weather=scene.weather,
            light=light,
            lamps=[*lamps, *scenery.lamps],
            time=time,
            seed=seed,
            road_height=poses[0][2],
            portal=portal,
            balls=balls,
            threads=threads,
        )
        rgb = develop(picture)
        if shot.tags is not None and balls:
            shot.tags[shot.rows >= 0] = 0
        return Frame(
            rgb=rgb,
            depth=shot.depth,
            ids=shot.rows + np.int32(1),
            unhidden=_unhidden(stage, view, balls) if counts else None,
            tags=shot.tags,
        )

    def release(self) -> None:
        """Disconnect from PyBullet."""
        if self._bodies is not None:
            self._bodies.close()
            self._bodies = None
        for stage, _ in self._stages.values():
            stage.close()
        self._stages.clear()
        self._shown = None

    def _stage_at(self, time: float) -> tuple[Stage, Scenery]:
        """Return the stage with the road's scenery at a time, building it if necessary."""
        assert self._loaded is not None
        corridor, scene, seed = self._loaded
        road = find_map(scene.map, self.catalogue())
        is_night = scene.weather.sun_elevation_deg < _LIT_DEG
        omitted, state = replaced_signals(corridor, self._signal_positions()), scene.map_state
        is_dark_phase = state is not None and state.signals == "flashing" and not is_lit(time)
        key = (road.id, corridor, seed, _snow(scene), is_night, omitted, state, is_dark_phase)
        if key in self._stages:
            self._stages.move_to_end(key)
            return self._stages[key]
        if len(self._stages) >= _STAGES:
            _, (oldest, _) = self._stages.popitem(last=False)
            oldest.close()
        scenery = build_scenery(
            corridor,
            road,
            seed,
            is_night=is_night,
            omitted=omitted,
            state=state,
            is_dark_phase=is_dark_phase,
        )
        stage = self._open_stage()
        stage.show_scenery(scenery.meshes, snow=_snow(scene), shelter=Shelter(corridor))
        self._stages[key] = (stage, replace(scenery, meshes=()))
        return self._stages[key]

    def _signal_positions(self) -> list[tuple[float, float]]:
        """Return x and y of the scene's own signals, m."""
        bodies = zip(self._cast.assets, self._poses, strict=True)
        return [(x, y) for asset, (x, y, _, _) in bodies if asset.category == "signal"]

    def _show_actors(self, stage: Stage, looks: list[Look], *, is_inside: bool) -> None:
        """Show the actors, unless the stage does; from inside, only the bonnet of the ego is seen."""
        shown = (stage, is_inside, looks)
        if self._shown != shown:
            ego: Look | Mesh = bonnet().build() if is_inside else looks[0]
            stage.show_actors([ego, *looks[1:]])
            self._shown = shown

    def _take(
        self, stage: Stage, view: CameraView, road_height: float
    ) -> tuple[Shot, Light, Portal | None]:
        """Return the raw picture, the light, and the end of a tunnel that the camera looks at."""
        assert self._loaded is not None
        corridor, scene, _ = self._loaded
        heading = corridor.heading(corridor.start)
        light = Light.of(scene.weather, heading, reflects_snow=_snow(scene) > Snow.NONE)
        portal = Shelter(corridor).portal(view)
        shot = stage.render(
            view,
            light,
            ground=road_height if light.daylight > DARK else None,
            is_inside=portal is not None and portal.is_inside,
        )
        return shot, light, portal

    def _poses_on(self, scenery: Scenery) -> list[Pose]:
        """Return the poses, with everything beside the asphalt lifted onto the ground."""
        ego, *others = self._poses
        x, y, _, _ = np.array(others, np.float64).reshape(-1, 4).T
        lifts = scenery.terrain.lifts(x, y).tolist()
        lifted = [
            (*pose[:2], pose[2] + lift, pose[3]) for pose, lift in zip(others, lifts, strict=True)
        ]
        return [ego, *lifted]


def _lamps_and_smoke(
    looks: Sequence[Look], poses: Sequence[Pose], *, has_ego_lamps: bool
) -> tuple[list[Lamp], list[PlacedPuff]]:
    """Return the lit lamps, with the ego's or without, and the smoke, in world coordinates."""
    lamps, balls = [], []
    for row, (look, (x, y, z, yaw)) in enumerate(zip(looks, poses, strict=True)):
        mesh, position = mesh_of(look), (x, y, z)
        sin, cos = exact.sincos(yaw)
        if row > 0 or has_ego_lamps:
            lamps += [lamp.placed(position, (cos, sin)) for lamp in mesh.lamps]
        balls += [PlacedPuff(puff.placed(position, (cos, sin)), row) for puff in mesh.puffs]
    return lamps, balls


def _unhidden(stage: Stage, view: CameraView, balls: Sequence[PlacedPuff]) -> I32 | None:
    """Return the number of pixels that each body would fill without occlusion."""
    pixels = stage.unhidden(view)
    if pixels is not None:
        for row in {ball.row for ball in balls}:
            smoke = [ball for ball in balls if ball.row == row]
            pixels[row] = max(pixels[row], np.count_nonzero(covered_pixels(view, smoke)))
    return pixels


def _is_inside(view: CameraView, ego: Pose) -> bool:
    """Return whether a camera is in the ego."""
    ahead, left, up = _place_on(view, ego)
    length, width, height = _INSIDE_M
    return abs(ahead) < length and abs(left) < width and up < height


def _sees_by_beams(view: CameraView, ego: Pose, asset: Asset) -> bool:
    """Return whether a camera is on the ego and looks forward, so that it sees by the ego's low beams."""
    ahead, left, up = _place_on(view, ego)
    sin, cos = exact.sincos(ego[3])
    beyond, beside, above = _ON_M
    is_on = abs(ahead) < 0.5 * asset.length + beyond and abs(left) < 0.5 * asset.width + beside
    is_forward = view.forward[0] * cos + view.forward[1] * sin > _ASIDE
    return is_on and up < asset.height + above and is_forward


def _place_on(view: CameraView, ego: Pose) -> tuple[float, ...]:
    """Return a camera's distances ahead of the ego's middle, to its left and above the road, m."""
    x, y, z, yaw = ego
    sin, cos = exact.sincos(yaw)
    dx, dy, dz = view.eye[0] - x, view.eye[1] - y, view.eye[2] - z
    return tuple(round(value, 6) for value in (dx * cos + dy * sin, dy * cos - dx * sin, dz))


def _snow(scene: Scene) -> Snow:
    """Return the extent of lying snow: it belongs to winter weather, in which snow falls."""
    weather = scene.weather
    if weather.precipitation != "snow":
        return Snow.NONE
    return Snow.ROADS if weather.precipitation_mm_h >= _SNOWED_ROADS_MM_H else Snow.LAND
