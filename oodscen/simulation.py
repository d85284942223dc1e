"""Simulate a scene: the approach up to the decision point, and every action from there."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from oodscen.driving import Cruise, action_driver, find_map, is_available, is_due, load_corridor
from oodscen.episode import ACTIONS, MOMENTS, ActionOutcome, Episode
from oodscen.protocols import Camera, Control, Driver, Frame, Observation, Simulator, State
from oodscen.scene import Scene

MAX_APPROACH_S = 15.0
"""When the decision is taken at the latest, although its trigger has not fired."""


@dataclass(frozen=True, eq=False)
class Simulated:
    """What `simulate` returns."""

    episode: Episode
    states: tuple[State, ...]
    """The approach, from the start to the decision point."""
    frames: dict[str, Frame]
    """By moment: `first`, `middle`, `last`."""


def simulate(
    scene: Scene,
    simulator: Simulator,
    *,
    seed: int = 0,
    camera: Camera | None = None,
    actions: Sequence[str] = ACTIONS,
    render: bool = True,
) -> Simulated:
    """Run one scene.

    A lane-keeping driver that is blind to the hazard drives up to the decision point. The approach
    is run twice: once to find that point, once to show it; both traces must be the same. Then each
    action is rolled out from the same state, unrendered, up to the scene's horizon.

    Args:
        scene: What to run.
        simulator: Where to run it.
        seed: Of the simulator's random streams.
        camera: The ego's dash camera if left out.
        actions: Which actions are rolled out.
        render: Whether the three frames are taken.

    Raises:
        SceneError: When the simulator refuses the scene.
        SimulatorError: When it fails.
    """
    states, controls, fired = _approach(scene, simulator, seed)
    trace = _fingerprint(states)
    frames: dict[str, Frame] = {}
    again: list[State] = []
    for index, control in enumerate([None, *controls]):
        again.append(simulator.step(control) if control else simulator.reset(scene, seed))
        if render:
            for moment, step in zip(MOMENTS, (0, len(controls) // 2, len(controls)), strict=True):
                if index == step:
                    frames[moment] = simulator.render(camera or Camera())
    is_deterministic = _fingerprint(again) == trace
    rollouts = _Rollouts(simulator, scene, seed, controls, trace)
    outcomes = {}
    for action in actions:
        outcome, same = rollouts.outcome(action)
        is_deterministic &= same
        outcomes[action] = outcome
    if not is_deterministic:
        outcomes = {
            name: outcome.model_copy(update={"safe": False}) for name, outcome in outcomes.items()
        }
    episode = Episode(
        id=scene.id,
        scene_id=scene.id,
        status="ok",
        simulator=simulator.name,
        seed=seed,
        dt=simulator.dt,
        decision_s=round(states[-1].time, 6),
        decision_fired=fired,
        frame_sha256={
            moment: hashlib.sha256(frame.rgb.tobytes()).hexdigest()
            for moment, frame in frames.items()
        },
        visible={moment: visible_pixels(frame, states[0].ids) for moment, frame in frames.items()},
        trace_sha256=trace,
        is_deterministic=is_deterministic,
        actions=outcomes,
    )
    return Simulated(episode, tuple(states), frames)


def visible_pixels(frame: Frame, ids: Sequence[str]) -> dict[str, int]:
    """Count the pixels of every actor in a frame; actors that cannot be seen are left out."""
    counts = np.bincount(frame.ids.ravel(), minlength=len(ids) + 1)
    return {name: int(counts[2 + row]) for row, name in enumerate(ids[1:]) if counts[2 + row]}


def _approach(
    scene: Scene, simulator: Simulator, seed: int
) -> tuple[list[State], list[Control], bool]:
    """Drive blindly until the decision's trigger fires, something is touched, or time is up."""
    state = simulator.reset(scene, seed)
    corridor = load_corridor(find_map(scene.map, simulator.catalogue()))
    driver = Cruise()
    states = [state]
    controls: list[Control] = []
    while state.time < MAX_APPROACH_S:
        if is_due(scene.decision, scene.decision_actor, state, corridor):
            return states, controls, True
        if state.contacts or state.off_road:
            break
        control = driver.act(simulator.observe())
        controls.append(control)
        state = simulator.step(control)
        states.append(state)
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
    ) -> None:
        self.simulator = simulator
        self.scene = scene
        self.seed = seed
        self.controls = controls
        self.trace = trace
        self.restore = getattr(simulator, "restore", None)
        snapshot = getattr(simulator, "snapshot", None)
        self.snapshot = snapshot() if snapshot and self.restore else None

    def outcome(self, action: str) -> tuple[ActionOutcome, bool]:
        """Return what an action leads to, and whether the approach was the same as before."""
        same = self._rewind()
        observation = self.simulator.observe()
        if not is_available(action, observation):
            return ActionOutcome(safe=False, unavailable=True), same
        return _executed(self.scene, self.simulator, action_driver(action), observation), same

    def _rewind(self) -> bool:
        if self.restore is not None and self.snapshot is not None:
            self.restore(self.snapshot)
            return True
        states = [self.simulator.reset(self.scene, self.seed)]
        states += [self.simulator.step(control) for control in self.controls]
        return _fingerprint(states) == self.trace


def _executed(
    scene: Scene, simulator: Simulator, driver: Driver, observation: Observation
) -> ActionOutcome:
    margin = float("inf")
    state = None
    for _ in range(round(scene.horizon_s / simulator.dt)):
        state = simulator.step(driver.act(observation))
        margin = min(margin, float(state.gaps[1:].min(initial=np.inf)))
        if state.contacts or state.off_road:
            break
        observation = simulator.observe()
    assert state is not None, "a horizon is at least one step"
    return ActionOutcome(
        safe=not (state.contacts or state.off_road),
        margin_m=None if margin == float("inf") else round(margin, 3),
        contacts=state.contacts,
        off_road=state.off_road,
        final_speed=round(float(state.speeds[0]), 3),
    )


def _fingerprint(states: Sequence[State]) -> str:
    digest = hashlib.sha256()
    for state in states:
        digest.update(state.fingerprint())
    return digest.hexdigest()
