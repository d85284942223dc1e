"""The fixture `drive` and the value that it returns."""

import dataclasses
import re
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import instance_of
from oodscen._display import png
from oodscen._files import replace
from oodscen._members import is_interruption
from oodscen._text import one_line, plain
from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import scene_of, twin_id
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.driving._base_simulator import render_checked
from oodscen.errors import OodscenError, UsageError
from oodscen.protocols import Camera, Driver, Simulator, State, camera_for
from oodscen.stages._drive import (
    DrivePlan,
    MakeDriver,
    RuleBasedDriver,
    brakes_hard,
    drive_result,
    drive_states,
    failed_drive,
    is_needless,
)

if TYPE_CHECKING:
    from oodscen.study._study import Study

_SHOWN_S = (3.0, 2.0, 1.5, 1.0, 0.5, 0.0)
"""Times before the shown moment of a drive that a failure lists, s."""

_Pictures = Mapping[str, NDArray[np.uint8]]
"""The frame and the plan view of one moment."""


class Scenes:
    """The scenes that a test session drives: their texts, plans of their drives, and where pictures go.

    Args:
        study: The study.
        seed: Seed of the simulator's random streams.
        pictures: Folder for pictures of failed drives; `None` for none.
    """

    def __init__(self, study: "Study", seed: int, pictures: Path | None) -> None:
        self._study = study
        self.seed = seed
        self.pictures = pictures
        self._plans: dict[tuple[str, int], DrivePlan] = {}

    @cached_property
    def texts(self) -> dict[str, Scenario]:
        """The text of every scene, by the scene's id."""
        return {one.id: one for one in self._study.scenarios}

    @cached_property
    def safe_actions(self) -> dict[str, tuple[str, ...]]:
        """The actions that the study found safe, by id of the scene or twin."""
        found = (one for one in self._study.episodes if one.status == "ok")
        return {one.scene_id: tuple(one.safe_set) for one in found}

    def plan(self, scene: Scene, simulator: Simulator) -> DrivePlan:
        """Return the plan of a scene's drives in a simulator."""
        key = (scene.digest(), id(simulator))  # The plan holds the simulator: its id stays its own.
        if key not in self._plans:
            self._plans[key] = DrivePlan(scene, simulator, self.seed)
        return self._plans[key]


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Driven:
    """One drive of a stack in a scene or twin; its representation shows what happened."""

    result: DriveResult
    """All figures of the drive."""
    scene: Scene
    """The scene or twin that was driven."""
    states: tuple[State, ...]
    """The states from the start to the end of the drive."""
    text: str
    """The text of the scene, on one line; empty if the study has none."""
    path: tuple[str, ...]
    """The path of the scenario tree that the scene realises."""
    pictures: tuple[Path, ...] = ()
    """The frame and the plan view of the shown moment, if they were saved."""

    @cached_property
    def shown(self) -> State:
        """The moment that a failure shows: where needless braking begins, else the end of the drive."""
        if not (self.is_safe and self.is_needless):
            return self.states[-1]
        hard = (after for before, after in pairwise(self.states) if brakes_hard(before, after))
        return next(hard, self.states[-1])

    @property
    def is_safe(self) -> bool:
        """True without a collision and without leaving the road."""
        return self.result.passed

    @property
    def is_needless(self) -> bool:
        """True if the stack braked hard in a twin in which keeping the speed is safe; False for a scene."""
        return bool(self.result.brakes_needlessly)

    @property
    def outcome(self) -> str:
        """The outcome of the drive in a few words."""
        one = self.result
        end = f"after {one.seconds:.2f} s at {float(self.states[-1].speeds[0]):.1f} m/s"
        if one.collisions:
            kinds = {actor.id: actor.asset for actor in self.scene.actors}
            touched = " and ".join(f"{name} ({kinds.get(name, '?')})" for name in one.collisions)
            return f"touches {touched} {end}"
        if one.off_road:
            return f"leaves the road {end}"
        ttc = "none" if one.min_ttc_s is None else f"{one.min_ttc_s:.1f} s"
        hard = ""
        if self.is_needless:
            hard = (
                f", braking hard after {self.shown.time:.2f} s although keeping the speed is safe"
            )
        return f"is safe{hard}; least time to collision {ttc}"

    def __repr__(self) -> str:
        return f"<{self.result.driver} in {self.scene.id}: {self.outcome}>"

    def report(self, safe_actions: Sequence[str] = ()) -> str:
        """Return what a reader needs in order to understand the drive, in a few lines.

        Args:
            safe_actions: The actions that were safe from the scene's decision on.
        """
        one = self.result
        gap = "none" if one.min_gap_m is None else f"{one.min_gap_m:.1f} m"
        ttc = "none" if one.min_ttc_s is None else f"{one.min_ttc_s:.2f} s"
        rows = [
            ("scene", self.scene.id),
            ("path", " > ".join(self.path)),
            ("text", self.text),
            ("outcome", self.outcome),
            (
                "figures",
                f"least gap {gap}, least time to collision {ttc}, hardest braking "
                f"{one.peak_deceleration:.1f} m/s2, {one.progress:.0%} of the way at constant speed",
            ),
            ("safe here", ", ".join(safe_actions)),
            *(("before" if not row else "", line) for row, line in enumerate(self._last())),
            *zip(("frame", "plan view"), map(str, self.pictures), strict=False),
        ]
        return "\n".join(plain(f"{name:11}{value}") for name, value in rows if value)

    def _last(self) -> list[str]:
        """Return the ego's speed and the nearest actor at a few times up to the shown moment."""
        end, lines = self.shown.time, []
        shown: set[int] = set()
        for before in _SHOWN_S:
            state = min(self.states, key=lambda one: abs(one.time - (end - before)))
            if state.step in shown:
                continue
            shown.add(state.step)
            line = f"{state.time:6.2f} s  {float(state.speeds[0]):5.1f} m/s"
            if len(state.ids) > 1:
                row = int(state.gaps[1:].argmin()) + 1
                if state.gaps[row] < float("inf"):
                    line += f"  {float(state.gaps[row]):5.1f} m from {state.ids[row]}"
            lines.append(line)
        return lines


class Drive:
    """Lets a driving stack drive the scene of a test: the value of the fixture `drive`.

    Args:
        scene: The scene of the test.
        simulator: The simulator to drive in.
        scenes: The session's scenes.
        test: The id of the test, which names the pictures.
    """

    def __init__(
        self,
        scene: Scene,
        simulator: Simulator,
        scenes: Scenes,
        test: str,
    ) -> None:
        self._scene, self._simulator, self._scenes = scene, simulator, scenes
        self._test = test
        self.results: list[DriveResult] = []
        """Results of the drives, in order, failed ones included."""
        self.drives: list[Driven] = []
        """The drives that came to an end, in order."""
        self._braking: dict[int, _Pictures] = {}
        """Pictures of where needless braking begins, by place in `drives`."""

    def __repr__(self) -> str:
        return "drive"

    @property
    def twin(self) -> Scene:
        """The ordinary twin of the scene."""
        return self._plan.twin

    @property
    def _plan(self) -> DrivePlan:
        return self._scenes.plan(self._scene, self._simulator)

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
            driver: A class or function that makes a driver, or its name: `rule-based`, `module:attr`.
            scene: The scene to drive, by default the test's; `twin` drives its ordinary twin.
            name: The stack's name in the report; by default the name of the class or function.
            camera: Camera for drivers that want frames; by default the ego's dash camera, or the view from above.

        Raises:
            UsageError: If the driver is an object that already exists, or returns no control.
            Exception: Anything that the driver raises.
        """
        make, label = _maker(driver)
        item = self._scene if scene is None else scene
        instance_of("scene", item, Scene)
        is_its_twin = item.id == twin_id(self._scene.id)
        plan = self._plan if is_its_twin else self._scenes.plan(item, self._simulator)
        is_clear = is_its_twin and plan.is_clear  # Before the drive, whose moments are pictured.
        made_from = (self._scene if is_its_twin else item).digest()
        label = name or label
        braking: _Pictures | None = None
        states: list[State] = []
        seen_by = camera_for(self._simulator.catalogue(), camera)
        try:
            for state in drive_states(
                item, make(), self._simulator, self._scenes.seed, plan.steps, seen_by
            ):
                if is_clear and braking is None and states and brakes_hard(states[-1], state):
                    braking = self._pictures(state, item, camera)
                states.append(state)
        except BaseException as error:
            if not is_interruption(error):
                failed = failed_drive(item.id, label, error)
                self.results.append(failed.model_copy(update={"made_from": made_from}))
            raise
        catalogue = self._simulator.catalogue()
        result = drive_result(item, states, catalogue, label, plan.steps, self._simulator.dt)
        if is_its_twin:
            needless = is_needless(result, is_clear)
            result = result.model_copy(update={"brakes_needlessly": needless})
        known = self._scenes.texts.get(scene_of(item.id))
        result = result.model_copy(update={"made_from": made_from})
        text = (known.ordinary if item.is_twin else known.text) if known else None
        driven = Driven(
            result=result,
            scene=item,
            states=tuple(states),
            text=one_line(text or ""),
            path=known.path if known else (),
        )
        if braking is not None and result.passed:
            self._braking[len(self.drives)] = braking
        self.results.append(result)
        self.drives.append(driven)
        return driven if result.passed else self.pictured(camera)

    def pictured(self, camera: Camera | None = None) -> Driven:
        """Save the frame and the plan view of the last drive's shown moment, and return it with them.

        Args:
            camera: Camera of the frame; by default the ego's dash camera, or the view from above.
        """
        for place, pictures in self._braking.items():
            self._save(place, pictures)
        last = self.drives[-1]
        end = last.states[-1]
        if last.shown is end and self._simulator.observe().time == end.time:
            self._save(len(self.drives) - 1, self._pictures(end, last.scene, camera))
        return self.drives[-1]

    def _pictures(self, state: State, scene: Scene, camera: Camera | None) -> _Pictures:
        """Return the pictures of the simulator's present state; none if they are not wanted or cannot be made."""
        if self._scenes.pictures is None:
            return {}
        from oodscen.stages._birds_eye import birds_eye

        try:
            above = birds_eye(state, scene, self._simulator.catalogue())
            seen_by = camera_for(self._simulator.catalogue(), camera)
            frame = render_checked(self._simulator, seen_by, len(state.ids))
        except OodscenError:
            return {}
        return {"frame": frame.rgb, "plan": above}

    def _save(self, place: int, pictures: _Pictures) -> None:
        """Save the pictures of a drive that has none yet."""
        one, folder = self.drives[place], self._scenes.pictures
        if folder is None or one.pictures:
            return
        stem = re.sub(r"[^\w.~-]+", "-", f"{one.scene.id}-{self._test}").strip("-")[:180]
        saved = []
        for kind, pixels in pictures.items():
            if (data := png(pixels)) is not None:
                folder.mkdir(parents=True, exist_ok=True)
                path = folder / f"{stem}.{kind}.png"
                replace(path, data)
                saved.append(path)
        self.drives[place] = dataclasses.replace(one, pictures=tuple(saved))


def _maker(driver: MakeDriver | str) -> tuple[MakeDriver, str]:
    """Return the factory of a driver, and its name.

    Raises:
        UsageError: If it is not a factory.
    """
    if driver == "rule-based":
        return RuleBasedDriver, "rule-based"
    if isinstance(driver, str):
        from oodscen._registry import driver_maker

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
