"""Videos of scenes."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal, Self

import numpy as np

from oodscen._arguments import checked
from oodscen._io.files import read_bytes, temporary_folder, write_named, writing
from oodscen._members import as_catalogue, conforming, working
from oodscen._numbers import finite_number, seed_number
from oodscen._progress import Progress, reporting
from oodscen._registry import make_driver
from oodscen.data._catalogue import Catalogue
from oodscen.data._episode import ACTIONS
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.data._scene import Scene
from oodscen.driving._base_simulator import render_checked
from oodscen.driving._checked_simulator import checked_simulator, scene_copy
from oodscen.driving._exclusive import exclusive
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.triggers import MAX_APPROACH_S, ROUNDING_S, is_due
from oodscen.driving._roads.building import load_corridor
from oodscen.errors import OodscenError, UnknownComponent, UsageError
from oodscen.protocols import Camera, Driver, Simulator, State, camera_for
from oodscen.stages._pictures.birds_eye import Pixels, birds_eye, opencv
from oodscen.stages._steering import Steering, own_camera

View = Literal["ego", "bird", "both"]
VIEWS: tuple[View, ...] = ("ego", "bird", "both")

FRAMES_PER_SECOND = 10
AFTERMATH_S = 1.0
"""Duration of a video after a collision or leaving the road, in seconds."""
_ROUNDING = 1e-9
"""Excess of a rate over that of the steps that is rounding, frames per second."""


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
        self._cv2 = opencv()
        self._writer: Any = None
        self._folder: TemporaryDirectory[str] | None = None

    def add(self, picture: Pixels) -> None:
        """Append one frame; all must have the size of the first.

        Raises:
            OodscenError: When the file cannot be written.
        """
        height, width = picture.shape[:2]
        if self._writer is None:
            self._folder = temporary_folder()
            code = self._cv2.VideoWriter_fourcc(*"mp4v")
            unfinished = str(self._unfinished(self._folder))
            self._writer = self._cv2.VideoWriter(unfinished, code, self.fps, (width, height))
            if not self._writer.isOpened():
                raise OodscenError(f"{self.path}: OpenCV cannot write this video")
        self._writer.write(np.ascontiguousarray(picture[..., ::-1]))
        self.count += 1

    def close(self) -> None:
        """Finish the file, which takes the place of an earlier one; may be called twice.

        Raises:
            OodscenError: When the file cannot be written.
        """
        folder = self._release()
        if folder is None:
            return
        with folder:
            if self.count:
                with writing(self.path):
                    write_named(self.path, read_bytes(self._unfinished(folder)))

    def _unfinished(self, folder: TemporaryDirectory[str]) -> Path:
        return Path(folder.name, f"video{self.path.suffix}")

    def _release(self) -> TemporaryDirectory[str] | None:
        """Return the folder of the unfinished file, which OpenCV then no longer writes."""
        if self._writer is not None:
            self._writer.release()
        folder, self._writer, self._folder = self._folder, None, None
        return folder

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if error[0] is None:
            self.close()
        elif (folder := self._release()) is not None:
            folder.cleanup()


@checked
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
    """Run a scene and write a video of it; `Scene.record` tells arguments and errors."""
    if view not in VIEWS:
        raise UnknownComponent("view", view, VIEWS)
    first: Driver = Cruise()
    after_decision: Driver | None = None
    if isinstance(driver, str) and driver in ACTIONS:
        after_decision = make_driver(driver, reaction_s=NOMINAL_REACTION_S)
    elif driver is not None:
        first = make_driver(driver)
    used_alone = exclusive(conforming("simulator", simulator))
    simulator = checked_simulator(simulator)
    catalogue = as_catalogue(simulator.catalogue(), simulator.name)
    corridor = load_corridor(scene.map, catalogue)
    camera = camera_for(catalogue, camera)
    steering = Steering(first, simulator, camera_for(catalogue, own_camera(first)))
    seed_number(seed)
    finite_number("fps", fps, 0.1, 1.0 / simulator.dt + _ROUNDING)
    if Path(path).suffix.lower() != ".mp4":
        raise UsageError(f"a video's name must end in .mp4, not {Path(path).name!r}")
    stride = max(1, round(1.0 / (simulator.dt * fps)))
    end, is_decided = MAX_APPROACH_S + scene.horizon_s, False
    with (
        used_alone,
        reporting(progress) as report_progress,
        Video(path, fps=1.0 / (stride * simulator.dt)) as video,
        scene_copy(scene, simulator.name) as copy,
    ):
        with working("simulator", simulator.name):
            state = simulator.reset(copy, seed)
        while True:
            if not is_decided and (
                state.time >= MAX_APPROACH_S or is_due(scene.decision, None, state, corridor)
            ):
                is_decided, end = True, min(end, state.time + scene.horizon_s)
                if after_decision is not None:
                    steering = Steering(after_decision, simulator, camera)
            if state.contacts or state.off_road:
                end = min(end, state.time + AFTERMATH_S)
            if state.step % stride == 0:
                video.add(_picture(simulator, state, scene, catalogue, camera, view))
            if state.time >= end - ROUNDING_S:
                report_progress("record", state.step, state.step)
                break
            report_progress("record", state.step, max(state.step + 1, round(end / simulator.dt)))
            control = steering.control(state)
            with working("simulator", simulator.name):
                state = simulator.step(control)
        return video.path


def _picture(
    simulator: Simulator,
    state: State,
    scene: Scene,
    catalogue: Catalogue,
    camera: Camera,
    view: View,
) -> Pixels:
    """Return one frame of a video: the ego's view, the view from above, or both side by side."""
    if view == "bird":
        return birds_eye(state, scene, catalogue)
    with working("simulator", simulator.name):
        frame = render_checked(simulator, camera, len(state.ids))
    if view == "ego":
        return frame.rgb
    above = birds_eye(state, scene, catalogue, size=camera.height)
    return np.concatenate((frame.rgb, above), axis=1)
