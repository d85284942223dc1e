"""Bird's-eye views of states, and videos of scenes."""

import math
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from oodscen._display import png
from oodscen._files import read_bytes, temporary_folder, write_named
from oodscen._members import conforming
from oodscen._numbers import finite_number, seed_number, whole_number
from oodscen._progress import Progress, reporting
from oodscen.data._catalogue import Catalogue
from oodscen.data._episode import NOMINAL_REACTION_S
from oodscen.data._scene import Scene
from oodscen.driving import action_driver, load_corridor
from oodscen.driving._base_simulator import render_checked
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.triggers import MAX_APPROACH_S, is_due
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.scene_checks import PlacedBody, bodies
from oodscen.errors import MissingExtra, OodscenError, UnknownComponent, UsageError
from oodscen.protocols import (
    MAX_SIZE,
    Camera,
    Driver,
    MountsCamera,
    Simulator,
    State,
    camera_for,
)
from oodscen.stages._steering import Steering

View = Literal["ego", "bird", "both"]
VIEWS: tuple[View, ...] = ("ego", "bird", "both")

Image = NDArray[np.uint8]
Colour = tuple[int, int, int]

FRAMES_PER_SECOND = 10
AFTERMATH_S = 1.0
"""Duration of a video after a collision or leaving the road, in seconds."""

_SIZE = 480
_SPAN_M = 72.0
_AHEAD = 0.72
"""Share of a bird's-eye view that lies ahead of the ego."""
_GRASS: Colour = (108, 132, 92)
_GROUND: dict[str, Colour] = {
    "driving": (84, 86, 90),
    "shoulder": (100, 100, 100),
    "parking": (94, 92, 96),
    "sidewalk": (166, 163, 156),
    "median": (122, 124, 112),
}
_MARK: Colour = (236, 236, 230)
_OUTLINE: Colour = (24, 24, 26)
_EGO: Colour = (214, 52, 44)
_HAZARD: Colour = (255, 176, 0)
_BODIES: dict[str, Colour] = {
    "vehicle": (86, 150, 226),
    "cyclist": (60, 196, 196),
    "pedestrian": (240, 128, 176),
    "animal": (178, 128, 72),
    "object": (206, 186, 146),
    "work_zone": (240, 132, 40),
    "vegetation": (52, 112, 52),
    "signal": (200, 200, 204),
}


class _Map:
    """A map section in image coordinates, with the ego heading upwards."""

    def __init__(self, ego: PlacedBody, size: int, span: float) -> None:
        self.size, self.scale = size, size / span
        self.x, self.y = ego.solid.x, ego.solid.y
        self.cos, self.sin = math.cos(ego.solid.yaw), math.sin(ego.solid.yaw)

    def pixels(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.int32]:
        """Return points in OpenCV's fixed-point format: [n, 2], 1/16 pixels."""
        dx, dy = x - self.x, y - self.y
        along, aside = dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin
        columns = 0.5 * self.size - aside * self.scale
        rows = _AHEAD * self.size - along * self.scale
        points = np.stack([columns, rows], axis=1)
        return np.rint(np.clip(points, -9e3, 9e3) * 16.0).astype(np.int32)


def birds_eye(
    state: State,
    scene: Scene,
    catalogue: Catalogue,
    *,
    size: int = _SIZE,
    span_m: float = _SPAN_M,
) -> "Picture":
    """Draw the road and all actors from above, with the ego heading upwards.

    The ego is red; the actors that make the scene OOD have an amber outline.

    Args:
        state: State of the world.
        scene: The scene it belongs to.
        catalogue: The simulator's catalogue.
        size: Side of the square image, in pixels.
        span_m: Side of the shown area, in metres.

    Returns:
        uint8 [size, size, 3], red first; a notebook shows it as a picture.

    Raises:
        MissingExtra: When OpenCV is not installed.
    """
    whole_number("size", size, 1, MAX_SIZE)
    finite_number("span_m", span_m, 1.0, 10_000.0)
    cv2 = _opencv()
    cast = bodies(scene, catalogue, state.poses)
    corridor = load_corridor(scene.map, catalogue)
    picture = np.empty((size, size, 3), np.uint8)
    picture[:] = _GRASS
    ground = _Map(cast[0], size, span_m)
    for other in corridor.others:
        _road(cv2, picture, ground, other.corridor, span_m, has_marks=not other.is_connecting)
    _road(cv2, picture, ground, corridor, span_m)
    for outline in corridor.crosswalks:
        points = ground.pixels(outline.points[:, 0], outline.points[:, 1])
        cv2.fillPoly(picture, [points], _MARK, cv2.LINE_AA, 4)
    categories = {asset.id: asset.category for asset in catalogue.for_scene(scene).assets}
    rows = sorted(range(1, len(cast)), key=lambda row: -cast[row].solid.length)
    for row in [*rows, 0]:
        body = cast[row]
        colour = _EGO if row == 0 else _BODIES[categories[body.asset]]
        edge = _HAZARD if body.id in scene.hazard.actors else _OUTLINE
        _body(cv2, picture, ground, body, colour, edge)
    where = f"{state.time:5.2f} s   {3.6 * float(state.speeds[0]):3.0f} km/h"
    if state.contacts:
        where += f"   touches {', '.join(state.contacts)}"
    elif state.off_road:
        where += "   off the road"
    for colour, thickness in ((_OUTLINE, 3), ((255, 255, 255), 1)):
        cv2.putText(
            picture, where, (10, size - 12), cv2.FONT_HERSHEY_SIMPLEX, 0.5, colour, thickness,
            cv2.LINE_AA,
        )  # fmt: skip
    return picture.view(Picture)


class Picture(np.ndarray[Any, np.dtype[np.uint8]]):
    """An RGB picture that a notebook shows; otherwise a plain array."""

    def __repr__(self) -> str:
        return f"<picture: {self.dtype}{list(self.shape)}>"

    def _repr_png_(self) -> bytes | None:
        return png(self)


class Video:
    """An MP4 file that grows frame by frame; a context manager, which leaves an earlier file if it fails.

    Args:
        path: The file; its folder is created. A link is followed, and a device or a pipe is written through.
        fps: Frames per second.

    Raises:
        MissingExtra: When OpenCV is not installed.
    """

    def __init__(self, path: str | Path, *, fps: float = FRAMES_PER_SECOND) -> None:
        self.path = Path(path)
        self.fps = fps
        self.count = 0
        self._cv2 = _opencv()
        self._writer: Any = None
        self._place: TemporaryDirectory[str] | None = None

    def add(self, picture: Image) -> None:
        """Append one frame; all must have the size of the first.

        Raises:
            OodscenError: When the file cannot be written.
        """
        height, width = picture.shape[:2]
        if self._writer is None:
            self._place = temporary_folder()
            code = self._cv2.VideoWriter_fourcc(*"mp4v")
            part = str(self._part(self._place))
            self._writer = self._cv2.VideoWriter(part, code, self.fps, (width, height))
            if not self._writer.isOpened():
                raise OodscenError(f"{self.path}: OpenCV cannot write this video")
        self._writer.write(np.ascontiguousarray(picture[..., ::-1]))
        self.count += 1

    def close(self) -> None:
        """Finish the file, which takes the place of an earlier one; may be called twice.

        Raises:
            OodscenError: When the file cannot be written.
        """
        place = self._released()
        if place is None:
            return
        with place:
            if self.count:
                try:
                    write_named(self.path, read_bytes(self._part(place)))
                except OSError as error:
                    told = error.strerror or error
                    raise OodscenError(f"cannot write {self.path}: {told}") from None

    def _part(self, place: TemporaryDirectory[str]) -> Path:
        return Path(place.name, f"video{self.path.suffix}")

    def _released(self) -> TemporaryDirectory[str] | None:
        """Return the folder of the unfinished file, which OpenCV then no longer writes."""
        if self._writer is not None:
            self._writer.release()
        place, self._writer, self._place = self._place, None, None
        return place

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            self.close()
        elif (place := self._released()) is not None:
            place.cleanup()


def record(
    scene: Scene,
    simulator: Simulator,
    path: str | Path,
    *,
    driver: Driver | str | None = None,
    view: View = "both",
    seed: int = 0,
    camera: Camera | None = None,
    fps: float = FRAMES_PER_SECOND,
    progress: Progress | bool | None = None,
) -> Path:
    """Run a scene and write a video of it.

    The video continues to the scene's horizon after the decision, or until shortly after a collision or
    leaving the road.

    Args:
        scene: The scene to run.
        simulator: The simulator to run it in.
        path: Path of the MP4 file.
        driver: Drives from the start, and is shown what it asks for, as in `drive`; or the id of an action,
            executed from the decision on after a driver that is blind to the hazard, which also drives if this
            is left out.
        view: The ego's camera, a bird's-eye view, or both side by side.
        seed: Seed of the simulator's random streams.
        camera: By default the ego's dash camera.
        fps: Frames per second of the scene's time.
        progress: True for a progress bar, or a callable; it counts the steps of the simulator.

    Raises:
        UnknownComponent: When the view or the action is unknown.
        MissingExtra: When OpenCV is not installed.
        SceneError: When the simulator refuses the scene.
        UsageError: When the driver is none, or returns no control; the frame rate or the file's name is none.
        OodscenError: When the file cannot be written. An earlier file of that name stays then.
    """
    if view not in VIEWS:
        raise UnknownComponent("view", view, VIEWS)
    later = action_driver(driver, NOMINAL_REACTION_S) if isinstance(driver, str) else None
    own = None if isinstance(driver, str) else driver
    now: Driver = Cruise() if own is None else conforming("driver", own)
    mounted = now.camera if isinstance(now, MountsCamera) else None
    catalogue = simulator.catalogue()
    corridor = load_corridor(scene.map, catalogue)
    camera = camera_for(catalogue, camera)
    steering = Steering(now, simulator, camera_for(catalogue, mounted))
    state = simulator.reset(scene, seed_number(seed))
    finite_number("fps", fps, 0.1, 1.0 / simulator.dt + 1e-9)
    if Path(path).suffix.lower() != ".mp4":
        raise UsageError(f"a video's name must end in .mp4, not {Path(path).name!r}")
    stride = max(1, round(1.0 / (simulator.dt * fps)))
    end, is_decided = MAX_APPROACH_S + scene.horizon_s, False
    with (
        reporting(progress) as report_progress,
        Video(path, fps=1.0 / (stride * simulator.dt)) as video,
    ):
        while True:
            if not is_decided and (
                state.time >= MAX_APPROACH_S or is_due(scene.decision, None, state, corridor)
            ):
                is_decided, end = True, min(end, state.time + scene.horizon_s)
                if later is not None:
                    steering = Steering(later, simulator, camera)
            if state.contacts or state.off_road:
                end = min(end, state.time + AFTERMATH_S)
            if state.step % stride == 0:
                video.add(_picture(simulator, state, scene, catalogue, camera, view))
            if state.time >= end - 1e-9:
                report_progress("record", state.step, state.step)
                break
            report_progress("record", state.step, max(state.step + 1, round(end / simulator.dt)))
            state = simulator.step(steering.control(state))
        return video.path


def _picture(
    simulator: Simulator,
    state: State,
    scene: Scene,
    catalogue: Catalogue,
    camera: Camera,
    view: View,
) -> Image:
    parts = []
    if view != "bird":
        parts.append(render_checked(simulator, camera, len(state.ids)).rgb)
    if view != "ego":
        size = _SIZE if view == "bird" else camera.height
        parts.append(birds_eye(state, scene, catalogue, size=size))
    return np.concatenate(parts, axis=1) if len(parts) > 1 else parts[0]


def _road(
    cv2: Any, picture: Image, ground: _Map, road: Corridor, span: float, *, has_marks: bool = True
) -> None:
    """Draw a road's strips and, if `has_marks`, its lane marks outside junctions."""
    near = (road.x - ground.x) ** 2 + (road.y - ground.y) ** 2 < (1.5 * span) ** 2
    if not near.any():
        return
    for part in _runs(near):
        lines = []
        for strip in road.strips:
            edges = [
                ground.pixels(
                    road.x[part] - side[part] * road.sin[part],
                    road.y[part] + side[part] * road.cos[part],
                )
                for side in (strip.right, strip.left)
            ]
            if strip.kind in _GROUND:
                outline = np.concatenate([edges[0], edges[1][::-1]])
                cv2.fillPoly(picture, [outline], _GROUND[strip.kind], cv2.LINE_AA, 4)
            if strip.mark in ("solid", "broken") and has_marks:
                exists = strip.left[part] - strip.right[part] > 0.5
                if len(road.in_junction) == len(road.s):
                    exists &= ~road.in_junction[part]
                if strip.mark == "broken":
                    along = road.s[part]
                    exists &= along - 9.0 * np.floor(along / 9.0) < 3.0
                lines += [edges[1][run] for run in _runs(exists)]
        cv2.polylines(picture, [line for line in lines if len(line) > 1], False, _MARK, 1, 16, 4)


def _runs(holds: NDArray[np.bool_]) -> Sequence[slice]:
    """Return the runs of true values as slices."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(np.int8)))
    return [slice(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _body(
    cv2: Any, picture: Image, ground: _Map, body: PlacedBody, colour: Colour, outline: Colour
) -> None:
    """Draw a footprint with an arrow-head at its front; small bodies are enlarged."""
    one = body.solid
    least = 1.2
    half_length, half_width = 0.5 * max(one.length, least), 0.5 * max(one.width, least)
    cos, sin = math.cos(one.yaw), math.sin(one.yaw)

    def points(places: Sequence[tuple[float, float]]) -> NDArray[np.int32]:
        x = np.array([one.x + a * cos - b * sin for a, b in places])
        y = np.array([one.y + a * sin + b * cos for a, b in places])
        return ground.pixels(x, y)

    corners = [(1, 1), (1, -1), (-1, -1), (-1, 1)]
    box = points([(a * half_length, b * half_width) for a, b in corners])
    cv2.fillPoly(picture, [box], colour, cv2.LINE_AA, 4)
    cv2.polylines(picture, [box], True, outline, 2 if outline == _HAZARD else 1, cv2.LINE_AA, 4)
    if one.length >= least:
        tip = [
            (half_length, 0.0),
            (0.4 * half_length, half_width),
            (0.4 * half_length, -half_width),
        ]
        cv2.fillPoly(picture, [points(tip)], outline, cv2.LINE_AA, 4)


def _opencv() -> Any:
    try:
        import cv2
    except ImportError:
        raise MissingExtra("drawing and videos", "pybullet", "opencv-python-headless") from None
    return cv2
