"""Closed-loop runs of driving stacks over scenes and their ordinary twins, with safety metrics."""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from oodscen._arguments import checked
from oodscen._members import conforming, is_interruption, message, reason, working
from oodscen._numbers import seed_number
from oodscen._progress import Progress, counted, reporting
from oodscen._registry import driver_maker
from oodscen._words.text import is_name, one_line, printable
from oodscen.data._catalogue import Catalogue
from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import is_twin, twin_id
from oodscen.data._scene import Scene
from oodscen.driving._checked_simulator import checked_simulator, scene_copy
from oodscen.driving._exclusive import exclusive
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.triggers import MAX_APPROACH_S, is_due
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._trace import Course, Trace
from oodscen.errors import OodscenError, SceneError, SimulatorError, UsageError
from oodscen.protocols import (
    Camera,
    Driver,
    Simulator,
    State,
    camera_for,
)
from oodscen.stages._safe_actions import peak_deceleration, peak_jerk
from oodscen.stages._steering import Steering, own_camera

MakeDriver = Callable[[], Driver]

_OWN_ERRORS = (OodscenError, BrokenProcessPool)
"""Errors whose message says enough; of others the type is told as well."""

NEEDLESS_BRAKING = 4.0
"""Deceleration beyond which braking is needless where keeping the speed is safe, m/s^2."""


@checked
def drive(
    scenes: Sequence[Scene],
    driver: MakeDriver | str,
    simulator: Simulator,
    *,
    name: str = "",
    seed: int = 0,
    twins: bool = True,
    camera: Camera | None = None,
    progress: Progress | bool | None = None,
) -> list[DriveResult]:
    """Let a driver drive every scene, and its ordinary twin, from the start to the horizon.

    The driver controls the ego all the way; the scene's decision point only determines how long the drive
    lasts. A driver with a method `look(state)` is given the state before every step; one with a true
    attribute `wants_frames` finds the camera image in its observations, taken by its `camera` if it has
    one. A scene that cannot be run, or a driver that raises, gives a failed result, and the other drives
    continue.

    Args:
        scenes: Scenes to drive; twins among them are driven as they are.
        driver: A class or function that makes a fresh driver for every drive, or a name that `make_driver` takes.
        simulator: The simulator to drive in.
        name: The driver's name in the results; by default the name that was given, or that of the class.
        seed: Seed of the simulator's random streams.
        twins: Drive the twins as well, right after their scenes.
        camera: Camera for drivers that want frames; by default the driver's own, or the ego's dash camera.
        progress: True for a progress bar, or a callable; it counts the scenes.

    Returns:
        The results in the order of the scenes, each followed by its twin's.

    Raises:
        UsageError: If there are two drives of one id, what is to be driven is not a scene, there is no such driver,
            or where it is driven is not a simulator, or another thread uses it.
    """
    conforming("simulator", simulator)
    seed_number(seed)
    own_name = (
        driver if isinstance(driver, str) else getattr(driver, "__name__", type(driver).__name__)
    )
    label = name or own_name
    if not isinstance(label, str) or not is_name(label):
        raise UsageError(f"drive() needs a name of one line for the driver, not {label!r:.80}")
    scenes = _distinct(scenes, twins)
    make = driver_maker(driver) if isinstance(driver, str) else driver
    drives = _Drives(make, simulator, label, seed, twins, camera)
    with reporting(progress) as report_progress, exclusive(simulator):
        return [
            result
            for scene in counted(scenes, "drive", len(scenes), report_progress)
            for result in drives.of(scene)
        ]


def _distinct(scenes: Sequence[Scene], twins: bool) -> list[Scene]:
    """Return scenes whose drives have ids of their own."""
    found = list(scenes)
    ids = [scene.id for scene in found]
    ids += [twin_id(scene.id) for scene in found if twins and not scene.is_twin]
    if twice := [name for name, count in Counter(ids).items() if count > 1]:
        raise UsageError(
            f"two of the drives would be of {twice[0]!r}; every scene needs an id of its own"
        )
    return found


class DrivePlan:
    """The length of the drives of one scene, and its twin: from a drive that keeps its speed.

    Args:
        scene: A scene, or a twin, which has no twin of its own.
        simulator: The simulator to drive in.
        seed: Seed of the simulator's random streams.

    Raises:
        OodscenError: If the scene cannot be run.
    """

    def __init__(self, scene: Scene, simulator: Simulator, seed: int) -> None:
        self.scene = scene
        self._simulator, self._seed = checked_simulator(simulator), seed
        with working("simulator", simulator.name):
            self.steps, self.decision_s, _ = horizon(scene, self._simulator, seed)

    @cached_property
    def twin(self) -> Scene:
        """The ordinary twin, judged at the scene's own decision time."""
        return self.scene.twin(self.decision_s)

    @cached_property
    def is_clear(self) -> bool:
        """True if keeping the speed is safe in the twin."""
        with working("simulator", self._simulator.name):
            _, _, ordinary = horizon(self.twin, self._simulator, self._seed, self.steps)
        return not (ordinary["contact"][-1, 0] or ordinary["off_road"][-1, 0])


def is_needless(twin: DriveResult, is_clear: bool) -> bool | None:
    """Return whether a drive of a twin braked hard for nothing; `None` if the drive failed."""
    if twin.status != "ok":
        return None
    return is_clear and twin.peak_deceleration > NEEDLESS_BRAKING


def brakes_hard(before: State, after: State) -> bool:
    """Return whether the ego brakes harder than `NEEDLESS_BRAKING` between two consecutive states."""
    lost = float(before.speeds[0] - after.speeds[0])
    return lost / (after.time - before.time) > NEEDLESS_BRAKING


@dataclass(frozen=True)
class _Drives:
    """Drives of one driver in one simulator."""

    make: MakeDriver
    simulator: Simulator
    name: str
    seed: int
    twins: bool
    camera: Camera | None

    def of(self, scene: Scene) -> list[DriveResult]:
        """Drive a scene and, if asked to, its twin."""
        try:
            with scene_copy(scene, self.simulator.name) as given:
                results = self._both(given)
        except SceneError as error:  # What is no scene has no digest.
            return self._failed(scene, error)
        except SimulatorError as error:
            results = self._failed(scene, error)
        digest = scene.digest()
        return [result.model_copy(update={"made_from": digest}) for result in results]

    def _failed(self, scene: Scene, error: OodscenError) -> list[DriveResult]:
        has_twin = self.twins and not scene.is_twin
        ids = [scene.id, twin_id(scene.id)] if has_twin else [scene.id]
        return [failed_drive(name, self.name, error) for name in ids]

    def _both(self, scene: Scene) -> list[DriveResult]:
        try:
            plan = DrivePlan(scene, self.simulator, self.seed)
        except OodscenError as error:
            return self._failed(scene, error)
        result = self._one(scene, plan.steps)
        if not self.twins or scene.is_twin:
            return [result]
        try:
            is_clear = plan.is_clear
            other = self._one(plan.twin, plan.steps)
        except OodscenError as error:
            return [result, failed_drive(twin_id(scene.id), self.name, error)]
        return paired(result, other, is_needless(other, is_clear))

    def _one(self, scene: Scene, steps: int) -> DriveResult:
        simulator = self.simulator
        try:
            driver = self.make()
            own = own_camera(driver)
            camera = camera_for(simulator.catalogue(), self.camera or own)
            states = list(drive_states(scene, driver, simulator, self.seed, steps, camera))
        except BaseException as error:
            if is_interruption(error):
                raise
            return failed_drive(scene.id, self.name, error)
        return drive_result(scene, states, simulator.catalogue(), self.name, steps, simulator.dt)


def horizon(
    scene: Scene, simulator: Simulator, seed: int, steps: int | None = None
) -> tuple[int, float, Trace]:
    """Return a scene's duration in steps, its decision time, and the trace of a blind drive.

    Args:
        scene: The scene or twin.
        simulator: The simulator; it is left at the end of the blind drive.
        seed: Seed of the simulator's random streams.
        steps: The duration, if it is known from the scene of a twin.
    """
    state = simulator.reset(scene, seed)
    corridor = load_corridor(scene.map, simulator.catalogue())
    driver = Cruise()
    states, decision_s = [state], None
    last = steps if steps is not None else math.inf
    while len(states) <= last:
        if decision_s is None and (
            state.time >= MAX_APPROACH_S or is_due(scene.decision, None, state, corridor)
        ):
            decision_s = state.time
            if steps is None:
                last = len(states) - 1 + round(scene.horizon_s / simulator.dt)
        if state.contacts or state.off_road:
            break
        state = simulator.step(driver.act(simulator.observe()))
        states.append(state)
    decision_s = states[-1].time if decision_s is None else decision_s
    if steps is None:
        steps = round((decision_s + scene.horizon_s) / simulator.dt)
    return steps, decision_s, Trace.of(states, scene, simulator.catalogue())


def drive_result(
    scene: Scene,
    states: Sequence[State],
    catalogue: Catalogue,
    name: str,
    steps: int,
    dt: float,
) -> DriveResult:
    """Return the result of a drive; its progress is compared with that of `steps` at the initial speed."""
    trace = Trace.from_states(states, Course.of(scene, catalogue))
    met = trace.summary().values()
    ttc = trace["ttc_s"][:, 1:].min(axis=1, initial=np.inf)
    headway = trace["time_headway_s"][:, 1:].min(axis=1, initial=np.inf)
    near = headway[np.isfinite(headway)]
    s = trace["s"][:, 0]
    ideal = float(states[0].speeds[0]) * steps * dt
    last = states[-1]
    return DriveResult(
        id=f"{scene.id}@{name}",
        scene_id=scene.id,
        driver=name,
        is_twin=scene.is_twin,
        collisions=last.contacts,
        off_road=last.off_road,
        passed=not (last.contacts or last.off_road),
        seconds=round(last.time, 6),
        min_gap_m=min(
            (encounter.min_gap_m for encounter in met if encounter.min_gap_m is not None),
            default=None,
        ),
        min_ttc_s=min(
            (encounter.min_ttc_s for encounter in met if encounter.min_ttc_s is not None),
            default=None,
        ),
        ttc_below_1_5_s=round(float((ttc < 1.5).mean()), 4),
        min_headway_s=round(float(near.min()), 3) if len(near) else None,
        median_headway_s=round(float(np.median(near)), 3) if len(near) else None,
        progress_m=round(float(s[-1] - s[0]), 3),
        progress=round(float(s[-1] - s[0]) / ideal, 4) if ideal > 0 else 0.0,
        peak_deceleration=peak_deceleration(trace),
        peak_jerk=peak_jerk(trace),
    )


def drive_states(
    scene: Scene, driver: Driver, simulator: Simulator, seed: int, steps: int, camera: Camera
) -> Iterator[State]:
    """Yield the states of one drive, up to a collision, the edge of the road, or its last step.

    Raises:
        UsageError: If the driver returns no control of finite numbers.
        SimulatorError: If the simulator fails, or returns no state or observation of finite numbers.
        Exception: Anything that the driver raises.
    """
    simulator = checked_simulator(simulator)
    steering = Steering(driver, simulator, camera)
    with working("simulator", simulator.name):
        state = simulator.reset(scene, seed)
    yield state
    for _ in range(steps):
        if state.contacts or state.off_road:
            return
        control = steering.control(state)
        with working("simulator", simulator.name):
            state = simulator.step(control)
        yield state


def paired(one: DriveResult, other: DriveResult, needless: bool | None) -> list[DriveResult]:
    """Return a scene's and its twin's results with how the same driver fared in the other."""
    braking = {"brakes_needlessly": needless}
    if other.status == "ok":
        lost = round(other.progress - one.progress, 4) if one.status == "ok" else None
        fields = {"twin_passed": other.passed, "progress_lost": lost, **braking}
        one = one.model_copy(update=fields)
    return [one, other.model_copy(update=braking)]


def failed_drive(scene_id: str, name: str, error: BaseException) -> DriveResult:
    """Return the result of a drive that did not come to its end because of an error."""
    words = one_line(printable(message(error))) if isinstance(error, _OWN_ERRORS) else ""
    return DriveResult(
        id=f"{scene_id}@{name}",
        scene_id=scene_id,
        driver=name,
        status="failed",
        error=(words or reason(error))[:2_000],
        error_type=type(error).__name__,
        is_twin=is_twin(scene_id),
    )


def inconclusive_drive(scene_id: str, name: str, why: str) -> DriveResult:
    """Return the result of a drive that was recorded but is neither passed nor failed."""
    return DriveResult(
        id=f"{scene_id}@{name}",
        scene_id=scene_id,
        driver=name,
        status="inconclusive",
        error=why,
        is_twin=is_twin(scene_id),
    )
