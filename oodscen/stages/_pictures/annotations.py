"""Annotations of a frame: boxes, visibility and classes of everything in the scene."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked, state_of
from oodscen._display import png
from oodscen._io.files import writing
from oodscen._io.study_files import refuse_own
from oodscen._numbers import said
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._frames import own_frame
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import DRIVABLE, Corridor
from oodscen.driving._roads.projection import places
from oodscen.driving._sight.outlines import area, clipped
from oodscen.driving._sight.scene_checks import PlacedBody, bodies
from oodscen.driving._sight.visibility import Eye, UprightBox
from oodscen.errors import MissingExtra, SimulatorError, UsageError
from oodscen.numerics._exact import wrapped
from oodscen.protocols import Camera, Frame, State, camera_for

CLASSES: dict[str, int] = {
    "sky": 0,
    "scenery": 1,
    "road": 2,
    "pavement": 3,
    "ego": 4,
    "vehicle": 5,
    "cyclist": 6,
    "pedestrian": 7,
    "animal": 8,
    "object": 9,
    "work_zone": 10,
    "vegetation": 11,
    "signal": 12,
}
"""Semantic ids by name; from 5 on the names are the catalogue's categories."""

DEPTH_STEP_M = 0.01
"""Metres per grey level of a depth image; 0 is the sky, 65535 is 655.35 m or more."""

_ON_ROAD_M = 0.3
"""Maximum distance, in metres, of a point of the road surface from the modelled surface."""
_SLACK_M = 1.0
"""Length by which twice a body's box is enlarged on each axis, where a frame may show the body, m."""
_CHUNK = 20_000
"""Number of points that are located on the road at once."""

Box = tuple[float, float, float, float]
"""Left, top, right, bottom in pixels; the image's top left corner is (0, 0)."""


class ActorAnnotation(Data):
    """One actor in one frame."""

    noun: ClassVar[str] = "annotation"

    id: str
    instance: int
    """The actor's value in `Frame.ids`."""
    asset: str
    category: str
    is_hazard: bool
    """True if the actor is part of the hazard."""
    box: Box | None
    """Box around the visible pixels; `None` if there are none."""
    box_projected: Box | None
    """Box around the projection of the 3-D box, clipped to the image; `None` if it lies outside."""
    centre_world: tuple[float, float, float]
    """Centre of the 3-D box in world coordinates, in metres."""
    yaw: float
    """Yaw in world coordinates, in radians."""
    size: tuple[float, float, float]
    """Length, width and height of the 3-D box, m."""
    centre_camera: tuple[float, float, float]
    """Centre of the 3-D box, in metres to the right, downwards and along the optical axis."""
    visible_px: int
    unhidden_px: int | None
    """Pixels that the actor would fill without occlusion; `None` if the simulator cannot tell."""
    visible_share: float | None
    """Visible pixels per unoccluded one, 0 to 1; `None` if it has none in the image, or the simulator cannot tell."""
    occlusion: float | None
    """1 - `visible_share`."""
    truncation: float
    """Share of the projection that lies outside the image, 0 to 1."""


class FrameAnnotations(Data):
    """All annotations of one frame."""

    schema_version: Literal[1] = 1
    scene_id: str
    time: float
    width: int
    height: int
    focal_px: float
    """Focal length on both axes, in pixels; the principal point is the image centre."""
    camera_position: tuple[float, float, float]
    """Camera position in world coordinates, in metres."""
    camera_yaw: float
    """Camera yaw in world coordinates, in radians."""
    camera_pitch_deg: float
    """Camera pitch in degrees, positive downwards."""
    classes: dict[str, int] = CLASSES
    """Semantic ids by name."""
    actors: tuple[ActorAnnotation, ...]
    """Annotations of the actors, in the scene's order."""

    @staticmethod
    @checked
    def semantic_map(
        frame: Frame, state: State, scene: Scene, catalogue: Catalogue, camera: Camera | None = None
    ) -> NDArray[np.uint8]:
        """Return the class of every pixel of a frame, by `classes`: [height, width] uint8.

        Road and pavement are found by position: pixels on the surface of a strip of the road.

        Args:
            frame: The rendered frame.
            state: State of the world at that moment.
            scene: The scene they belong to.
            catalogue: The simulator's catalogue.
            camera: The camera that rendered the frame; by default the ego's dash camera.

        Raises:
            UsageError: If the state is one of another scene, or the frame cannot be one of the camera and the state.
        """
        frame, camera, eye, cast, _ = _seen(frame, state, scene, catalogue, camera)
        assets = {asset.id: asset for asset in catalogue.for_scene(scene).assets}
        # By the value in `Frame.ids`: 0 is no body, 1 the ego, then the actors in order.
        by_id = [CLASSES["scenery"], CLASSES["ego"]]
        by_id += [CLASSES[assets[body.asset].category] for body in cast[1:]]
        classes: NDArray[np.uint8] = np.array(by_id, np.uint8)[frame.ids]
        classes[(frame.ids == 0) & ~np.isfinite(frame.depth)] = CLASSES["sky"]
        rows, columns = np.nonzero((frame.ids == 0) & np.isfinite(frame.depth))
        x, y, z = _points(eye, camera, frame.depth, rows, columns)
        corridor = load_corridor(scene.map, catalogue)
        kinds = _ground(corridor, x, y, z)
        for other in corridor.others:
            beside = kinds == 0
            kinds[beside] = _ground(other.corridor, x[beside], y[beside], z[beside])
        is_ground = kinds > 0
        classes[rows[is_ground], columns[is_ground]] = kinds[is_ground]
        return classes

    @checked
    def save(
        self, folder: str | Path, name: str, frame: Frame, classes: NDArray[np.uint8]
    ) -> list[Path]:
        """Write `NAME.json`, `NAME.ids.png`, `NAME.classes.png` and `NAME.depth.png`.

        Args:
            folder: The folder; created if it does not exist.
            name: Name of the frame, e.g. `last`.
            frame: Provides ids and depth.
            classes: The frame's semantic map.

        Raises:
            MissingExtra: When OpenCV is not installed.
            UsageError: When the name is not one of a file, or the frame or the map is of another picture.
            FolderTaken: When the folder belongs to a study, such as its `frames`.
            OodscenError: When a file cannot be written.
        """
        if name in ("", ".", "..") or Path(name).name != name:
            raise UsageError(f"name must be one of a file, not {said(name, 80)}")
        size = (self.height, self.width)
        for argument, image in (("frame", frame.ids), ("classes", classes)):
            if image.shape != size:
                raise UsageError(
                    f"{argument} must have the shape of the annotated frame, {size}, not {image.shape}"
                )
        if classes.dtype != np.uint8:
            raise UsageError(f"classes must be uint8, not {classes.dtype}")
        target = Path(folder)
        files = self.encoded(name, frame, classes)
        with writing(target):
            for file in files:
                refuse_own(target / file)
            target.mkdir(parents=True, exist_ok=True)
            for file, data in files.items():
                (target / file).write_bytes(data)
        return [target / file for file in files]

    def encoded(self, name: str, frame: Frame, classes: NDArray[np.uint8]) -> dict[str, bytes]:
        """Return the files of `save` as data by name."""
        levels = np.where(np.isfinite(frame.depth), np.rint(frame.depth / DEPTH_STEP_M), 0.0)
        depth = np.clip(levels, 0.0, 65535.0).astype(np.uint16)
        return {
            f"{name}.json": (self.to_json() + "\n").encode(),
            f"{name}.ids.png": _png(frame.ids.astype(np.uint16)),
            f"{name}.classes.png": _png(classes),
            f"{name}.depth.png": _png(depth),
        }


class _Pixels(NamedTuple):
    """The visible pixels of a body."""

    number: int
    box: Box
    nearest_m: float
    """Least depth."""
    farthest_m: float

    @classmethod
    def of(cls, frame: Frame, instance: int) -> Self | None:
        """Return the pixels with an id; `None` if there are none."""
        mask = frame.ids == instance
        if not mask.any():
            return None
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        box = (float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))
        depth_m = frame.depth[mask]
        return cls(int(mask.sum()), box, float(depth_m.min()), float(depth_m.max()))

    def may_show(self, body: UprightBox, eye: Eye) -> bool:
        """Return whether the pixels meet a box in the picture and in depth."""
        outline = eye.silhouette(body)
        if not outline:
            return False
        left, top, right, bottom = _around(outline)
        ahead_m = [eye.to_camera(corner)[2] for corner in body.corners()]
        return bool(
            self.box[0] <= right
            and left <= self.box[2]
            and self.box[1] <= bottom
            and top <= self.box[3]
            and self.nearest_m <= max(ahead_m)
            and min(ahead_m) <= self.farthest_m
        )


class _Seen(NamedTuple):
    """A frame with what it may show."""

    frame: Frame
    camera: Camera
    eye: Eye
    cast: Sequence[PlacedBody]
    """All bodies, the ego first."""
    pixels: Sequence[_Pixels | None]
    """The pixels of the bodies other than the ego."""


def _seen(
    frame: Frame, state: State, scene: Scene, catalogue: Catalogue, camera: Camera | None
) -> _Seen:
    """Return a frame with its camera and the bodies that it may show.

    Raises:
        UsageError: If the state is one of another scene, the frame has another size or other bodies, or a body is seen
            where it cannot be.
    """
    state_of(scene, state)
    camera = camera_for(catalogue, camera)
    try:
        frame = own_frame(frame, camera, len(state.ids), "frame: the simulator")
    except SimulatorError as error:
        raise UsageError(f"{error}; name the camera that rendered it, and its scene") from None
    cast = bodies(scene, catalogue, state.poses)
    eye = Eye(camera, cast[0].solid)
    pixels = [_Pixels.of(frame, row + 1) for row in range(1, len(cast))]
    for body, visible in zip(cast[1:], pixels, strict=True):
        if visible is not None and not visible.may_show(_enlarged(body.solid), eye):
            raise UsageError(
                f"frame shows {body.id!r} where the state does not have it; name the camera that rendered it, its "
                "scene and its state"
            )
    return _Seen(frame, camera, eye, cast, pixels)


def _enlarged(body: UprightBox) -> UprightBox:
    """Return a box that holds a body with whatever sticks out of its own."""
    return replace(
        body,
        z=body.z - 0.5 * (body.height + _SLACK_M),
        length=2.0 * body.length + _SLACK_M,
        width=2.0 * body.width + _SLACK_M,
        height=2.0 * body.height + _SLACK_M,
    )


@checked
def annotate(
    frame: Frame, state: State, scene: Scene, catalogue: Catalogue, camera: Camera | None = None
) -> FrameAnnotations:
    """Annotate a frame; `Scene.annotate` tells arguments and errors."""
    seen = _seen(frame, state, scene, catalogue, camera)
    camera, eye = seen.camera, seen.eye
    categories = {asset.id: asset.category for asset in catalogue.for_scene(scene).assets}
    actors = [
        _actor_annotation(
            seen,
            row,
            category=categories[body.asset],
            is_hazard=body.id in scene.hazard.actors,
        )
        for row, body in enumerate(seen.cast[1:], start=1)
    ]
    return FrameAnnotations(
        scene_id=scene.id,
        time=state.time,
        width=camera.width,
        height=camera.height,
        focal_px=round(eye.focal, 6),
        camera_position=_rounded(eye.place),
        camera_yaw=wrapped(seen.cast[0].solid.yaw + math.radians(camera.yaw_deg)),
        camera_pitch_deg=camera.pitch_deg,
        actors=tuple(actors),
    )


def _actor_annotation(seen: _Seen, row: int, *, category: str, is_hazard: bool) -> ActorAnnotation:
    """Annotate one body, given by its row in the state."""
    body, visible, eye = seen.cast[row], seen.pixels[row - 1], seen.eye
    solid = body.solid
    outline = eye.silhouette(solid)
    in_image = clipped(outline, seen.camera.width, seen.camera.height)
    outline_px, in_image_px = area(outline), area(in_image)
    visible_px = visible.number if visible else 0
    centre = (solid.x, solid.y, solid.z + 0.5 * solid.height)
    unhidden_px = None if seen.frame.unhidden is None else int(seen.frame.unhidden[row])
    visible_share = round(min(1.0, visible_px / unhidden_px), 4) if unhidden_px else None
    return ActorAnnotation(
        id=body.id,
        instance=row + 1,
        asset=body.asset,
        category=category,
        is_hazard=is_hazard,
        box=visible.box if visible else None,
        box_projected=_around(in_image) if in_image_px > 0.0 else None,
        centre_world=_rounded(centre),
        yaw=solid.yaw,
        size=(solid.length, solid.width, solid.height),
        centre_camera=_rounded(eye.to_camera(centre)),
        visible_px=visible_px,
        unhidden_px=unhidden_px,
        visible_share=visible_share,
        occlusion=None if visible_share is None else round(1.0 - visible_share, 4),
        truncation=round(1.0 - in_image_px / outline_px, 4) if outline_px > 0.0 else 1.0,
    )


def _points(
    eye: Eye,
    camera: Camera,
    depth: NDArray[np.float32],
    rows: NDArray[np.intp],
    columns: NDArray[np.intp],
) -> list[NDArray[np.float64]]:
    """Return the world coordinates x, y, z of the points that pixels show."""
    u = (columns + 0.5 - 0.5 * camera.width) / eye.focal
    v = (rows + 0.5 - 0.5 * camera.height) / eye.focal
    depth_m = depth[rows, columns].astype(np.float64)
    return [
        eye.place[axis] + depth_m * (eye.forward[axis] + u * eye.right[axis] + v * eye.down[axis])
        for axis in range(3)
    ]


def _ground(
    corridor: Corridor, x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64]
) -> NDArray[np.uint8]:
    """Return the class of points on a road's surface, and 0 for all others."""
    kinds = np.zeros(len(x), np.uint8)
    for start in range(0, len(x), _CHUNK):
        part = slice(start, start + _CHUNK)
        s, t, _, _ = places(corridor, x[part], y[part])
        index = np.clip(np.rint(s / corridor.step), 0, len(corridor.s) - 1).astype(np.intp)
        on_surface = np.abs(z[part] - corridor.z[index]) < _ON_ROAD_M
        on_surface &= (s >= 0.0) & (s <= corridor.length)
        part_kinds = kinds[part]
        for strip in corridor.strips:
            if strip.kind in DRIVABLE:
                kind = CLASSES["road"]
            elif strip.kind == "sidewalk":
                kind = CLASSES["pavement"]
            else:
                continue
            part_kinds[on_surface & (strip.right[index] <= t) & (t < strip.left[index])] = kind
    return kinds


def _around(outline: Sequence[tuple[float, float]]) -> Box:
    columns, rows = ([round(value, 2) for value in values] for values in zip(*outline, strict=True))
    return min(columns), min(rows), max(columns), max(rows)


def _rounded(point: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (round(value, 4) + 0.0 for value in point)  # Adding 0.0 turns -0.0 into 0.0.
    return x, y, z


def _png(image: NDArray[Any]) -> bytes:
    data = png(image)
    if data is None:
        raise MissingExtra("writing pictures", "pybullet", "opencv-python-headless")
    return data
