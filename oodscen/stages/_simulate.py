"""Simulation of a scene: the approach up to the decision point, and every action from there."""

import hashlib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from oodscen._conformance import conforming, working
from oodscen._display import Brief, picture, png
from oodscen._numbers import seed_number
from oodscen.data._bird_sketch import sketch
from oodscen.data._catalogue import Catalogue
from oodscen.data._episode import ACTIONS, MOMENTS, ActionOutcome, Episode
from oodscen.data._scene import Scene
from oodscen.driving import action_driver, load_corridor
from oodscen.driving._motion.actions import Cruise, is_available
from oodscen.driving._motion.triggers import MAX_APPROACH_S, is_due
from oodscen.driving._sight.visibility import is_noticeable
from oodscen.driving._trace import Course, Trace, concatenated
from oodscen.errors import MissingExtra, UnknownComponent
from oodscen.protocols import Camera, Control, Driver, Frame, Observation, Simulator, State
from oodscen.stages._video import birds_eye
from oodscen.stages._visibility import sighting

if TYPE_CHECKING:
    import pyarrow as pa

FOLLOWING_S = 4.0
"""Maximum time headway of a follower behind the ego, in seconds."""
JERK_S = 0.2
"""Interval over which a change of acceleration is measured, in seconds."""
VISIBLE_PX = 40
"""Minimum pixels of a visible actor in a 640 x 480 image; scaled for other sizes."""


@dataclass(frozen=True, eq=False, repr=False)
class Simulated(Brief):
    """The result of `simulate`."""

    episode: Episode
    states: tuple[State, ...]
    """States of the approach, from the start to the decision point."""
    frames: dict[str, Frame]
    """Frames by moment: `first`, `middle`, `last`."""
    trace: Trace
    """The approach with all ground truth, as a table."""
    rollouts: Mapping[str, Trace] = field(default_factory=dict)
    """Traces by action id, if requested, from the decision point to the action's end."""
    scene: Scene | None = field(default=None, repr=False)
    """The scene that was run."""
    catalogue: Catalogue | None = field(default=None, repr=False)
    """The catalogue of the simulator that ran it."""

    def state_of(self, moment: str) -> State:
        """Return the state that a frame shows: `first`, `middle` or `last`."""
        last = len(self.states) - 1
        return self.states[{"first": 0, "middle": last // 2, "last": last}[moment]]

    def _repr_html_(self) -> str:
        """Return the last frame, the decision point from above and all actions, for notebooks."""
        pictures = ""
        if "last" in self.frames:
            pictures += picture(png(self.frames["last"].rgb), "the last frame")
        if self.scene is not None and self.catalogue is not None:
            with suppress(MissingExtra):
                above = birds_eye(self.states[-1], self.scene, self.catalogue)
                pictures += picture(png(above), "from above at the last state of the approach")
        return f"<div>{pictures}{self.episode._repr_html_()}</div>"

    def to_arrow(self) -> "pa.Table":
        """Return all traces as one table; its first column, `phase`, is `approach` or an action.

        Raises:
            MissingExtra: When pyarrow is not installed.
        """
        return concatenated({"approach": self.trace, **self.rollouts})


def simulate(
    scene: Scene,
    simulator: Simulator,
    *,
    seed: int = 0,
    camera: Camera | None = None,
    actions: Sequence[str] = ACTIONS,
    render: bool = True,
    traces: bool = False,
    protocol: Literal["ours", "paper"] = "ours",
) -> Simulated:
    """Run one scene.

    A lane-keeping driver that is blind to the hazard drives up to the decision point. The approach is run
    twice: once to find that point, once to render it; both traces must be identical. (A twin's approach is
    run once if the simulator can restore snapshots, since its scene's was checked.) Then each action is
    rolled out from the same state, unrendered, up to the scene's horizon; the outcome of an action does not
    depend on earlier rollouts.

    Args:
        scene: The scene to run.
        simulator: The simulator to run it in.
        seed: Seed of the simulator's random streams.
        camera: By default the ego's dash camera.
        actions: The actions to roll out.
        render: Render the three frames.
        traces: Keep the ground truth of every action's rollout.
        protocol: `paper` shows the first, middle and last frame of the whole trace, on which the blind driver
            continues beyond the decision point until a collision or the horizon, and counts collisions only:
            leaving the road neither is unsafe nor ends the run.

    Raises:
        SceneError: When the simulator refuses the scene.
        SimulatorError: When the simulator fails, whatever it raises.
        UsageError: When the object is not a simulator, or an action is unknown.
    """
    conforming("simulator", simulator)
    seed_number(seed)
    for action in actions:
        if action not in ACTIONS:
            raise UnknownComponent("action", str(action), ACTIONS)
    with working("simulator", simulator.name):
        return _simulated(scene, simulator, seed, camera, actions, render, traces, protocol)


def _simulated(
    scene: Scene,
    simulator: Simulator,
    seed: int,
    camera: Camera | None,
    actions: Sequence[str],
    render: bool,
    traces: bool,
    protocol: str,
) -> Simulated:
    is_paper = protocol == "paper"
    can_go_back = scene.is_twin and not is_paper and _Snapshots.can(simulator)
    going_back = _Snapshots(simulator) if can_go_back else None
    states, controls, fired = approach(scene, simulator, seed, going_back)
    fingerprint, decision_s = _fingerprint(states), round(states[-1].time, 6)
    shown = (camera or Camera()) if render else None
    if is_paper:
        whole = [*controls, *_blind(scene, simulator, states[-1])]
        frames, states = _shown_again(scene, simulator, seed, whole, shown)
        _, again = _shown_again(scene, simulator, seed, controls, None)
        is_deterministic = _fingerprint(again) == fingerprint
    elif going_back:
        frames, is_deterministic = going_back.frames(shown), True
    else:
        frames, again = _shown_again(scene, simulator, seed, controls, shown)
        is_deterministic = _fingerprint(again) == fingerprint
    course = Course.of(scene, simulator.catalogue())
    rollouts = _Rollouts(simulator, scene, seed, controls, fingerprint, course, is_paper)
    outcomes: dict[str, ActionOutcome] = {}
    kept: dict[str, Trace] = {}
    for action in actions:
        outcomes[action], rollout, same = rollouts.outcome(action)
        is_deterministic &= same
        if rollout is not None:
            kept[action] = rollout
    if not is_deterministic:
        outcomes = {
            name: outcome.model_copy(update={"safe": False}) for name, outcome in outcomes.items()
        }
    visible = {moment: visible_pixels(frame, states[0].ids) for moment, frame in frames.items()}
    trace = Trace.measured(states, course)
    episode = Episode(
        id=scene.id,
        scene_id=scene.id,
        status="ok",
        simulator=simulator.name,
        seed=seed,
        dt=simulator.dt,
        decision_s=decision_s,
        decision_fired=fired,
        frame_sha256={
            moment: hashlib.sha256(frame.rgb.tobytes()).hexdigest()
            for moment, frame in frames.items()
        },
        visible=visible,
        hazard_visible=_shows_hazard(scene, frames, visible),
        sighting=sighting(scene, states[-1], frames["last"], simulator.catalogue(), shown)
        if shown and not is_paper
        else None,
        trace_sha256=fingerprint,
        is_deterministic=is_deterministic,
        actions=outcomes,
        sketch=sketch(course, trace, kept),
        followers=followers(trace),
    )
    return Simulated(
        episode,
        tuple(states),
        frames,
        trace,
        kept if traces else {},
        scene,
        simulator.catalogue(),
    )


def followers(trace: Trace) -> tuple[str, ...]:
    """Return the actors close behind the ego in its lane at the end of a trace.

    A follower is less than `FOLLOWING_S` behind at its own speed, centre to centre.
    """
    s, lane, speed = (trace[name][-1] for name in ("s", "lane", "speed"))
    return tuple(
        name
        for row, name in enumerate(trace.ids[1:], start=1)
        if lane[row] == lane[0] and 0.0 < s[0] - s[row] <= FOLLOWING_S * speed[row]
    )


def _shown_again(
    scene: Scene,
    simulator: Simulator,
    seed: int,
    controls: Sequence[Control],
    camera: Camera | None,
) -> tuple[dict[str, Frame], list[State]]:
    """Replay controls and return the frames and the states."""
    frames: dict[str, Frame] = {}
    states: list[State] = []
    steps = _steps_shown(len(controls))
    for index, control in enumerate([None, *controls]):
        states.append(simulator.step(control) if control else simulator.reset(scene, seed))
        for moment, step in steps.items():
            if index == step and camera:
                frames[moment] = simulator.render(camera)
    return frames, states


def _blind(scene: Scene, simulator: Simulator, state: State) -> list[Control]:
    """Continue blindly until a collision or the horizon, and return the controls."""
    driver = Cruise()
    controls: list[Control] = []
    for _ in range(round(scene.horizon_s / simulator.dt)):
        if state.contacts:
            break
        controls.append(driver.act(simulator.observe()))
        state = simulator.step(controls[-1])
    return controls


def _steps_shown(last: int) -> dict[str, int]:
    """Return the steps that the three frames show, by moment."""
    return dict(zip(MOMENTS, (0, last // 2, last), strict=True))


class _Snapshots:
    """Returns to the steps of one approach in a simulator with snapshots."""

    def __init__(self, simulator: Any) -> None:
        self.simulator = simulator
        self.kept: list[Any] = []

    @staticmethod
    def can(simulator: Simulator) -> bool:
        """Return whether the simulator can restore snapshots."""
        return hasattr(simulator, "snapshot") and hasattr(simulator, "restore")

    def keep(self) -> None:
        """Take a snapshot of the current step."""
        self.kept.append(self.simulator.snapshot())

    def frames(self, camera: Camera | None) -> dict[str, Frame]:
        """Return the three frames, and leave the simulator at the last step."""
        frames = {}
        for moment, step in _steps_shown(len(self.kept) - 1).items():
            self.simulator.restore(self.kept[step])
            if camera:
                frames[moment] = self.simulator.render(camera)
        return frames


def visible_pixels(frame: Frame, ids: Sequence[str]) -> dict[str, int]:
    """Count the pixels of every visible actor in a frame."""
    counts = np.bincount(frame.ids.ravel(), minlength=len(ids) + 1)
    return {name: int(counts[2 + row]) for row, name in enumerate(ids[1:]) if counts[2 + row]}


def _shows_hazard(
    scene: Scene, frames: Mapping[str, Frame], visible: Mapping[str, Mapping[str, int]]
) -> bool | None:
    """Return whether a frame shows the hazard; `None` without frames or in a twin."""
    hazard = scene.hazard
    if not frames or scene.is_twin:
        return None
    if not hazard.actors:
        return hazard.weather is not None and is_noticeable(scene.weather, hazard.weather)
    for moment, frame in frames.items():
        least = VISIBLE_PX * frame.ids.size / (640 * 480)
        if any(visible[moment].get(name, 0) >= least for name in hazard.actors):
            return True
    return False


def approach(
    scene: Scene, simulator: Simulator, seed: int, snapshots: _Snapshots | None = None
) -> tuple[list[State], list[Control], bool]:
    """Drive blindly until the decision's trigger fires, a collision or leaving the road, or the time limit.

    Returns:
        The states, the controls between them, and true if the trigger fired.
    """
    state = simulator.reset(scene, seed)
    corridor = load_corridor(scene.map, simulator.catalogue())
    driver = Cruise()
    states = [state]
    controls: list[Control] = []
    while state.time < MAX_APPROACH_S:
        if snapshots:
            snapshots.keep()
        if is_due(scene.decision, None, state, corridor):
            return states, controls, True
        if state.contacts or state.off_road:
            break
        control = driver.act(simulator.observe())
        controls.append(control)
        state = simulator.step(control)
        states.append(state)
    else:
        if snapshots:
            snapshots.keep()
    return states, controls, False


class _Rollouts:
    """Executes actions from one decision point, by snapshot or by replaying the approach."""

    def __init__(
        self,
        simulator: Simulator,
        scene: Scene,
        seed: int,
        controls: Sequence[Control],
        trace: str,
        course: Course,
        collisions_only: bool = False,
    ) -> None:
        self.simulator = simulator
        self.scene = scene
        self.seed = seed
        self.controls = controls
        self.trace = trace
        self.course = course
        self.collisions_only = collisions_only
        self.restore = getattr(simulator, "restore", None)
        snapshot = getattr(simulator, "snapshot", None)
        self.snapshot = snapshot() if snapshot and self.restore else None

    def outcome(self, action: str) -> tuple[ActionOutcome, Trace | None, bool]:
        """Return the outcome and trace of an action, and whether the approach was the same as before."""
        first, same = self._rewind()
        observation = self.simulator.observe()
        if not is_available(action, observation):
            return ActionOutcome(safe=False, unavailable=True), None, same
        states = _executed(
            self.scene, self.simulator, action_driver(action), observation, self.collisions_only
        )
        trace = Trace.measured([first, *states], self.course)
        return judged(states, trace, self.collisions_only), trace, same

    def _rewind(self) -> tuple[State, bool]:
        if self.restore is not None and self.snapshot is not None:
            return self.restore(self.snapshot), True
        states = [self.simulator.reset(self.scene, self.seed)]
        states += [self.simulator.step(control) for control in self.controls]
        return states[-1], _fingerprint(states) == self.trace


def _executed(
    scene: Scene,
    simulator: Simulator,
    driver: Driver,
    observation: Observation,
    collisions_only: bool,
) -> list[State]:
    """Drive to the scene's horizon, or until a collision or leaving the road."""
    states: list[State] = []
    for _ in range(max(1, round(scene.horizon_s / simulator.dt))):
        state = simulator.step(driver.act(observation))
        states.append(state)
        if state.contacts or (state.off_road and not collisions_only):
            break
        observation = simulator.observe()
    return states


def judged(states: Sequence[State], trace: Trace, collisions_only: bool = False) -> ActionOutcome:
    """Return the outcome of an action, with margins from the first step on."""
    last = states[-1]
    margin = min(float(state.gaps[1:].min(initial=np.inf)) for state in states)
    met = trace.summary().values()
    return ActionOutcome(
        safe=not last.contacts and (collisions_only or not last.off_road),
        margin_m=None if margin == float("inf") else _millimetres(margin),
        min_ttc_s=min((one.min_ttc_s for one in met if one.min_ttc_s is not None), default=None),
        pet_s=min((one.pet_s for one in met if one.pet_s is not None), default=None),
        contacts=last.contacts,
        off_road=last.off_road,
        final_speed=round(float(last.speeds[0]), 3),
        peak_deceleration=peak_deceleration(trace),
        peak_jerk=peak_jerk(trace),
    )


def _millimetres(gap: float) -> float:
    """Round a gap in metres to millimetres; only contact becomes 0."""
    return max(round(gap, 3), 0.001) if gap > 0.0 else 0.0


def peak_deceleration(trace: Trace) -> float:
    """Return the ego's hardest braking, m/s^2, never negative."""
    return max(0.0, round(-float(trace["acceleration"][:, 0].min()), 3))


def peak_jerk(trace: Trace) -> float | None:
    """Return the largest change rate of the ego's acceleration along its path, m/s^3.

    Differences are taken over `JERK_S`, since within one step every change looks infinite; `None` for shorter
    traces.
    """
    time = trace["time"][:, 0]
    along = trace["acceleration"][1:, 0]
    steps = max(1, round(JERK_S / float(time[1] - time[0]))) if len(time) > 1 else 1
    if len(along) <= steps:
        return None
    changes = np.abs(along[steps:] - along[:-steps]) / (time[steps] - time[0])
    return round(float(changes.max()), 3)


def _fingerprint(states: Sequence[State]) -> str:
    digest = hashlib.sha256()
    for state in states:
        digest.update(state.fingerprint())
    return digest.hexdigest()
