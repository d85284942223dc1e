"""The fixture `drive`: lets a driving stack drive the scene of a test."""

import dataclasses
import hashlib
import re
import time
import unittest
from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray

from oodscen._arguments import instance_of
from oodscen._display import png
from oodscen._io.files import replace, writing
from oodscen._members import is_interruption
from oodscen._registry import driver_maker
from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import twin_id
from oodscen.data._scene import Scene
from oodscen.driving._base_simulator import render_checked
from oodscen.errors import OodscenError, UsageError
from oodscen.protocols import Camera, Driver, Simulator, State, camera_for
from oodscen.pytest_plugin._driven import Driven
from oodscen.pytest_plugin._scenes import Scenes
from oodscen.stages._drive import (
    DrivePlan,
    MakeDriver,
    brakes_hard,
    drive_result,
    drive_states,
    failed_drive,
    is_needless,
)

_SKIPS = (unittest.SkipTest, pytest.skip.Exception, pytest.xfail.Exception)
"""Exceptions that end a test as neither passed nor failed; a stack must not raise them."""

_READABLE = 120
"""Maximum length of the readable part of a picture's name."""

_Pictures = Mapping[str, NDArray[np.uint8]]
"""The frame and the plan view of one moment."""


class Drive:
    """Lets a driving stack drive the scene of a test: the value of the fixture `drive`.

    Args:
        scene: The scene of the test.
        simulator: The simulator to drive in.
        scenes: The session's scenes.
        test: The id of the test, which tells its pictures from those of other tests.

    Raises:
        UsageError: If a `scene` of the test's own is no scene.
    """

    def __init__(self, scene: Scene, simulator: Simulator, scenes: Scenes, test: str) -> None:
        instance_of("scene", scene, Scene)
        self._simulator, self._scenes, self._test = simulator, scenes, test
        self.scene = scene
        """The scene of the test."""
        self.results: list[DriveResult] = []
        """Results of the drives, in order, failed ones included."""
        self.began: list[float] = []
        """Times at which the drives of `results` began, s since the epoch."""
        self.drives: list[Driven] = []
        """The drives that came to an end, in order."""
        self._braking: dict[int, _Pictures] = {}
        """Pictures of where needless braking begins, by index in `drives`."""

    def __repr__(self) -> str:
        return "drive"

    @property
    def twin(self) -> Scene:
        """The ordinary twin of the scene."""
        return self._plan.twin

    @property
    def _plan(self) -> DrivePlan:
        return self._scenes.plan(self.scene, self._simulator)

    def __call__(
        self,
        driver: MakeDriver | str,
        scene: Scene | None = None,
        *,
        name: str = "",
        camera: Camera | None = None,
    ) -> Driven:
        """Let a stack drive a scene from the start to the horizon.

        Args:
            driver: A class or function that makes a driver, or a name that `make_driver` takes.
            scene: The scene to drive, by default the test's; `twin` drives its ordinary twin.
            name: The stack's name in the report; by default the name of the class or function.
            camera: Camera for drivers that want frames; by default the ego's dash camera, or the view from above.

        Raises:
            UsageError: If the driver is an object that already exists, returns no control, or skips.
            Exception: Anything else that the driver raises.
        """
        make, own_name = _maker(driver)
        label = name or own_name
        driven_scene = self.scene if scene is None else scene
        instance_of("scene", driven_scene, Scene)
        is_its_twin = driven_scene.id == twin_id(self.scene.id)
        plan = self._plan if is_its_twin else self._scenes.plan(driven_scene, self._simulator)
        is_clear = is_its_twin and plan.is_clear  # Before the drive, whose moments are pictured.
        facts: dict[str, object] = {"made_from": plan.scene.digest()}
        catalogue = self._simulator.catalogue()
        camera = camera_for(catalogue, camera)
        began = time.time()
        try:
            states, braking = self._run(make, driven_scene, plan.steps, camera, is_clear=is_clear)
        except BaseException as error:
            is_skip = isinstance(error, _SKIPS)
            if is_skip or not is_interruption(error):
                failed = failed_drive(driven_scene.id, label, error)
                self._add(failed.model_copy(update=facts), began)
            if is_skip:
                raise UsageError(
                    f"{label} skips the scene: {error}; skip in the test, before drive()"
                ) from error
            raise
        result = drive_result(
            driven_scene, states, catalogue, label, plan.steps, self._simulator.dt
        )
        if is_its_twin:
            facts["brakes_needlessly"] = is_needless(result, is_clear)
        result = result.model_copy(update=facts)
        self._add(result, began)
        if braking is not None and result.passed:
            self._braking[len(self.drives)] = braking
        self.drives.append(
            Driven(
                result=result,
                scene=driven_scene,
                states=tuple(states),
                text=self._scenes.text(driven_scene),
                path=self._scenes.path(driven_scene),
            )
        )
        return self.drives[-1] if result.passed else self.pictured(camera)

    def _add(self, result: DriveResult, began: float) -> None:
        self.results.append(result)
        self.began.append(began)

    def _run(
        self, make: MakeDriver, scene: Scene, steps: int, camera: Camera, *, is_clear: bool
    ) -> tuple[list[State], _Pictures | None]:
        """Return the states of a drive, and pictures of where the ego begins to brake hard on a clear road."""
        simulator, seed = self._simulator, self._scenes.seed
        states: list[State] = []
        braking: _Pictures | None = None
        for state in drive_states(scene, make(), simulator, seed, steps, camera):
            if is_clear and braking is None and states and brakes_hard(states[-1], state):
                braking = self._pictures(state, scene, camera)
            states.append(state)
        return states, braking

    def pictured(self, camera: Camera | None = None) -> Driven:
        """Save the frame and the plan view of the last drive's shown moment, and return it with them.

        Args:
            camera: Camera of the frame; by default the ego's dash camera, or the view from above.
        """
        for index, pictures in self._braking.items():
            self._save(index, pictures)
        last = self.drives[-1]
        end = last.states[-1]
        if last.shown is end and self._simulator.observe().time == end.time:
            self._save(len(self.drives) - 1, self._pictures(end, last.scene, camera))
        return self.drives[-1]

    def _pictures(self, state: State, scene: Scene, camera: Camera | None) -> _Pictures:
        """Return the pictures of the simulator's present state; none if they are not wanted or cannot be made."""
        if self._scenes.pictures is None:
            return {}
        from oodscen.stages._pictures.birds_eye import birds_eye

        try:
            plan_view = birds_eye(state, scene, self._simulator.catalogue())
            frame_camera = camera_for(self._simulator.catalogue(), camera)
            frame = render_checked(self._simulator, frame_camera, len(state.ids))
        except OodscenError:
            return {}
        return {"frame": frame.rgb, "plan": plan_view}

    def _save(self, index: int, pictures: _Pictures) -> None:
        """Save the pictures of a drive that has none yet; what cannot be saved changes no outcome."""
        driven, folder = self.drives[index], self._scenes.pictures
        if folder is None or driven.pictures:
            return
        stem = picture_stem(driven.scene.id, self._test, driven.result.driver, index)
        saved, fault = [], ""
        try:
            with writing(folder):
                folder.mkdir(parents=True, exist_ok=True)
                for kind, pixels in pictures.items():
                    if (data := png(pixels)) is not None:
                        path = folder / f"{stem}.{kind}.png"
                        replace(path, data)
                        saved.append(path)
        except OodscenError as error:
            fault = str(error)
        self.drives[index] = dataclasses.replace(driven, pictures=tuple(saved), picture_fault=fault)


def picture_stem(scene: str, test: str, driver: str, index: int) -> str:
    """Return the file name of a drive's pictures, without its ending: no two drives of a session share one.

    Names have letters of ASCII and are short, as all file systems take them, and do not rely on upper and lower case.

    Args:
        scene: The id of the scene or twin.
        test: The id of the test.
        driver: The name of the stack.
        index: The index of the drive among those of its test.
    """
    function = test.partition("[")[0].rpartition("::")[2]
    words = re.sub(r"[^A-Za-z0-9_~]+", "-", f"{scene}-{function}-{driver}")[:_READABLE].strip("-")
    digest = hashlib.sha256(f"{test}\n{index}".encode(errors="surrogatepass")).hexdigest()
    return f"{words}-{digest[:10]}"


def _maker(driver: MakeDriver | str) -> tuple[MakeDriver, str]:
    """Return the factory of a driver, and its name.

    Raises:
        UsageError: If it is not a factory.
    """
    if isinstance(driver, str):
        return driver_maker(driver), driver
    if isinstance(driver, Driver) and not isinstance(driver, type):
        raise UsageError(
            "drive() takes what makes a driver, since every drive needs a fresh one: give the class, or a function"
        )
    if not callable(driver):
        raise UsageError(
            f"drive() takes a class or function that makes a driver, not {driver!r:.200}"
        )
    return driver, getattr(driver, "__name__", type(driver).__name__)
