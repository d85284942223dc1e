"""Simulation of a scene: the approach up to the decision point, and every action from there."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from oodscen._abilities import Snapshots
from oodscen._arguments import checked
from oodscen._display import Brief, picture, png
from oodscen._members import as_catalogue, conforming, working
from oodscen._numbers import finite_number, seed_number
from oodscen.data._bird_sketch import sketch
from oodscen.data._catalogue import Catalogue
from oodscen.data._episode import (
    ACTIONS,
    MOMENTS,
    ActionOutcome,
    Episode,
    Follower,
    in_order,
    share_of,
)
from oodscen.data._reactions import REACTIONS_S
from oodscen.data._scene import LONGEST_HORIZON_S, SHORTEST_HORIZON_S, Scene
from oodscen.driving._base_simulator import render_checked
from oodscen.driving._checked_simulator import checked_simulator, scene_copy
from oodscen.driving._exclusive import exclusive
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.triggers import MAX_APPROACH_S, is_due
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.visibility import least_area
from oodscen.driving._sight.weather import is_noticeable
from oodscen.driving._trace import Course, Trace, concatenate
from oodscen.errors import MissingExtra, UnknownComponent, UsageError
from oodscen.protocols import Camera, Control, Frame, Simulator, State, camera_for
from oodscen.stages._pictures.birds_eye import birds_eye
from oodscen.stages._pictures.visibility import sighting
from oodscen.stages._safe_actions import Rollouts, Trials, fingerprint

if TYPE_CHECKING:
    import pyarrow as pa

FOLLOWING_S = 4.0
"""Maximum time headway of a follower behind the ego, in seconds."""
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
        """Return the state that a frame shows: `first`, `middle`, `last` ..."""
        return self.states[_steps_shown(len(self.states) - 1, (moment,))[moment]]

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
        return concatenate({"approach": self.trace, **self.rollouts})


@checked
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
    reaction: Sequence[float] = REACTIONS_S,
    horizon: float | None = None,
    moments: Sequence[str] = MOMENTS,
) -> Simulated:
    """Run one scene.

    A lane-keeping driver that is blind to the hazard drives up to the decision point. The approach is run
    twice: once to find that point, once to render it; both traces must be identical. (A twin's approach is
    run once if the simulator can restore snapshots, since its scene's was checked.) Then each action is
    rolled out from the same state, unrendered, up to the scene's horizon; the outcome of an action does not
    depend on earlier rollouts.

    An action is rolled out by several drivers: with every reaction time, and, if the simulator can `rehearse`,
    on a road with a tenth less friction and at a speed of the ego that differs by a twentieth. In a demand whose
    event is a red light, driving over the stop line while it is red fails as well. An action is safe if
    all of them pass, unsafe if none does, and marginal otherwise. The margins and the trace are those of the
    driver with the middle reaction time on the road as it is.

    Args:
        scene: The scene to run.
        simulator: The simulator to run it in.
        seed: Seed of the simulator's random streams.
        camera: By default the ego's dash camera, or one above it if the simulator sees from there only.
        actions: The actions to roll out.
        render: Render the three frames.
        traces: Keep the ground truth of every action's rollout.
        protocol: `paper` shows the first, middle and last frame of the whole trace, on which the blind driver
            continues beyond the decision point until a collision or the horizon, and counts collisions only:
            leaving the road neither is unsafe nor ends the run, and there is one driver, who reacts at once.
        reaction: Reaction times of the drivers, s.
        horizon: Time for which an action is watched, s; by default the scene's.
        moments: The moments of the frames, `last` among them; the others `first`, `middle` or `at-N`, at N percent of
            the time between the first and the last.

    Raises:
        SceneError: When the simulator refuses the scene.
        SimulatorError: When the simulator fails, whatever it raises.
        UsageError: When the object is not a simulator or another thread uses it, an action or a moment is unknown, or
            a time is out of range.
    """
    conforming("simulator", simulator)
    seed_number(seed)
    for action in actions:
        if action not in ACTIONS:
            raise UnknownComponent("action", str(action), ACTIONS)
    trials = Trials.of((0.0,) if protocol == "paper" else reaction, protocol == "paper")
    moments = in_order(moments)  # A twin's are restored in turn; its actions begin at the last.
    if "last" not in moments:
        raise UsageError("moments must have the moment of the decision, 'last', among them")
    if horizon is not None:
        seconds = finite_number("horizon", horizon, SHORTEST_HORIZON_S, LONGEST_HORIZON_S)
        scene = scene.model_copy(update={"horizon_s": seconds})
    with exclusive(simulator), scene_copy(scene, simulator.name) as given:
        with working("simulator", simulator.name):
            offered = simulator.catalogue()
        catalogue = as_catalogue(offered, simulator.name)
        shown = camera_for(catalogue, camera) if render else None
        run = _Run(given, checked_simulator(simulator), seed, shown, moments, trials)
        with working("simulator", simulator.name):
            return run.simulated(actions, traces)


class _Shown(NamedTuple):
    """The approach to a decision, and the frames of it."""

    states: list[State]
    """States up to the decision; in the paper's protocol, up to the end."""
    controls: list[Control]
    """Controls up to the decision."""
    decided: State
    """The state at the decision."""
    fired: bool
    """True if the trigger of the decision fired."""
    frames: dict[str, Frame]
    digest: str
    """Fingerprint of the states up to the decision."""
    is_deterministic: bool


@dataclass(frozen=True)
class _Run:
    scene: Scene
    simulator: Simulator
    seed: int
    camera: Camera | None
    """`None` takes no frames."""
    moments: Sequence[str]
    trials: Trials

    def simulated(self, actions: Sequence[str], traces: bool) -> Simulated:
        scene, simulator, catalogue = self.scene, self.simulator, self.simulator.catalogue()
        shown = self._shown()
        states, frames, is_deterministic = shown.states, shown.frames, shown.is_deterministic
        course = Course.of(scene, catalogue)
        rollouts = Rollouts(
            simulator, scene, self.seed, shown.controls, shown.digest, course, self.trials
        )
        outcomes: dict[str, ActionOutcome] = {}
        kept: dict[str, Trace] = {}
        for action in actions:
            outcomes[action], rollout, same = rollouts.outcome(action)
            is_deterministic &= same
            if rollout is not None:
                kept[action] = rollout
        if not is_deterministic:
            outcomes = {
                name: outcome.model_copy(update={"safe": False, "marginal": False})
                for name, outcome in outcomes.items()
            }
        trace = Trace.from_states(states, course)
        behind = followers(trace)
        others = {variation.reaction_s for variation in self.trials.others}
        episode = Episode(
            id=scene.id,
            scene_id=scene.id,
            status="ok",
            simulator=simulator.name,
            seed=self.seed,
            dt=simulator.dt,
            decision_s=round(shown.decided.time, 6),
            decision_fired=shown.fired,
            **self._sights(states, frames),
            trace_sha256=shown.digest,
            is_deterministic=is_deterministic,
            actions=outcomes,
            sketch=sketch(course, trace, kept),
            reaction_s=tuple(sorted({self.trials.middle, *others})),
            horizon_s=scene.horizon_s,
            stop_line=rollouts.line,
            ego_speed_mps=round(shown.decided.speeds[0].item(), 3),
            followers=behind,
            follower=_follower(scene, trace, behind),
        )
        rolled = kept if traces else {}
        return Simulated(episode, tuple(states), frames, trace, rolled, scene, catalogue)

    def _shown(self) -> _Shown:
        """Drive to the decision, and again for the frames."""
        scene, simulator = self.scene, self.simulator
        is_paper = self.trials.collisions_only
        if scene.is_ordinary and not is_paper and isinstance(simulator, Snapshots):
            kept: list[Any] = []
            states, controls, fired = approach(
                scene, simulator, self.seed, lambda: kept.append(simulator.snapshot())
            )
            frames = {}
            for moment, step in _steps_shown(len(kept) - 1, self.moments).items():
                state = simulator.restore(kept[step])
                if self.camera:
                    frames[moment] = render_checked(simulator, self.camera, len(state.ids))
            digest = fingerprint(states)
            return _Shown(states, controls, states[-1], fired, frames, digest, True)
        states, controls, fired = approach(scene, simulator, self.seed)
        decided, digest = states[-1], fingerprint(states)
        if is_paper:
            whole = [*controls, *_blind(scene, simulator, decided)]
            frames, states = self._again(whole, self.camera)
            _, again = self._again(controls, None)
        else:
            frames, again = self._again(controls, self.camera)
        is_same = fingerprint(again) == digest
        return _Shown(states, controls, decided, fired, frames, digest, is_same)

    def _again(
        self, controls: Sequence[Control], camera: Camera | None
    ) -> tuple[dict[str, Frame], list[State]]:
        frames: dict[str, Frame] = {}
        states: list[State] = []
        steps = _steps_shown(len(controls), self.moments) if camera else {}
        for index, control in enumerate([None, *controls]):
            states.append(
                self.simulator.step(control)
                if control
                else self.simulator.reset(self.scene, self.seed)
            )
            for moment, step in steps.items():
                if index == step and camera:
                    frames[moment] = render_checked(self.simulator, camera, len(states[-1].ids))
        return frames, states

    def _sights(self, states: Sequence[State], frames: Mapping[str, Frame]) -> dict[str, Any]:
        """Return the fields of an episode about its frames."""
        visible = {moment: visible_pixels(one, states[0].ids) for moment, one in frames.items()}
        seen = None
        if self.camera and not self.trials.collisions_only:
            catalogue = self.simulator.catalogue()
            seen = sighting(self.scene, states[-1], frames["last"], catalogue, self.camera)
        return {
            "frame_sha256": {
                moment: hashlib.sha256(frame.rgb.tobytes()).hexdigest()
                for moment, frame in frames.items()
            },
            "visible": visible,
            "hazard_visible": _shows_hazard(self.scene, self.camera, visible),
            "sighting": seen,
            "frame_times_s": {
                moment: round(states[step].time, 6)
                for moment, step in _steps_shown(len(states) - 1, tuple(frames)).items()
            },
        }


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


def _follower(scene: Scene, trace: Trace, behind: Sequence[str]) -> Follower | None:
    """Return the nearest of the actors behind the ego at the end of a trace."""
    if not behind:
        return None
    row = min(map(trace.ids.index, behind), key=lambda row: _gap_behind(trace, row))
    what = next(actor.asset for actor in scene.actors if actor.id == trace.ids[row])
    gap, speed = _gap_behind(trace, row), float(trace["speed"][-1, row])
    return Follower(gap_m=round(gap, 3), speed_mps=round(speed, 3), what=what)


def _gap_behind(trace: Trace, row: int) -> float:
    """Return the last gap between the ego and a body behind it, m: along the road if none was measured between them."""
    gap = float(trace["gap_m"][-1, row])
    if gap < np.inf:
        return gap
    s, length = trace["s"][-1], trace["length"][-1]
    return max(0.0, float(s[0] - s[row] - 0.5 * (length[0] + length[row])))


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


def _steps_shown(last: int, moments: Sequence[str] = MOMENTS) -> dict[str, int]:
    """Return the steps that the frames show, by moment."""
    # Without the small addend, 29 % of 100 steps would be step 28.
    return {moment: int(last * share_of(moment) + 1e-9) for moment in moments}


def visible_pixels(frame: Frame, ids: Sequence[str]) -> dict[str, int]:
    """Count the pixels of every visible actor in a frame."""
    counts = np.bincount(frame.ids.ravel(), minlength=len(ids) + 1)
    return {name: int(counts[2 + row]) for row, name in enumerate(ids[1:]) if counts[2 + row]}


def _shows_hazard(
    scene: Scene, camera: Camera | None, visible: Mapping[str, Mapping[str, int]]
) -> bool | None:
    """Return whether a frame shows the hazard; `None` without frames or in a twin."""
    hazard = scene.hazard
    if camera is None or not visible or scene.is_ordinary:
        return None
    if not hazard.actors:
        if scene.map_state is not None:
            return True
        return hazard.weather is not None and is_noticeable(scene.weather, hazard.weather)
    least = least_area(VISIBLE_PX, camera)
    return any(
        pixels.get(name, 0) >= least for pixels in visible.values() for name in hazard.actors
    )


def approach(
    scene: Scene, simulator: Simulator, seed: int, keep: Callable[[], None] = lambda: None
) -> tuple[list[State], list[Control], bool]:
    """Drive blindly until the decision's trigger fires, a collision or leaving the road, or the time limit.

    Args:
        scene: The scene, whose decision has the trigger.
        simulator: The simulator; it is left at the end of the drive.
        seed: Seed of the simulator's random streams.
        keep: Called at every state.

    Returns:
        The states, the controls between them, and true if the trigger fired.
    """
    state = simulator.reset(scene, seed)
    corridor = load_corridor(scene.map, simulator.catalogue())
    driver = Cruise()
    states = [state]
    controls: list[Control] = []
    keep()
    while state.time < MAX_APPROACH_S:
        if is_due(scene.decision, None, state, corridor):
            return states, controls, True
        if state.contacts or state.off_road:
            break
        controls.append(driver.act(simulator.observe()))
        state = simulator.step(controls[-1])
        states.append(state)
        keep()
    return states, controls, False
