"""Runs of a scene as arrays, for the files that hold the courses of its bodies."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from oodscen._display import Brief
from oodscen._members import of_the_caller
from oodscen.data._catalogue import Catalogue
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.data._scene import Scene
from oodscen.driving._motion.actions import action_driver, is_available
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import UsageError
from oodscen.interchange._moving import moving
from oodscen.numerics._exact import Floats
from oodscen.protocols import Simulator, State
from oodscen.stages._simulate import approach

_STEP_OF_ONE_STATE_S = 0.05
"""Time step of a run of one state, s."""


@dataclass(frozen=True, eq=False, repr=False)
class RecordedRun(Brief):
    """The states of one run as arrays, with the time of the decision."""

    ids: tuple[str, ...]
    """`ego`, then the actors in the scene's order."""
    time: Floats
    """[n], s."""
    poses: Floats
    """[n, bodies, 4] x, y, z and yaw of the footprints' centres."""
    speeds: Floats
    """[n, bodies] along the headings, m/s."""
    places: Floats
    """[n, bodies, 2] s and t on the corridor, m."""
    decision_s: float | None = None
    """Time of the decision; `None` if it never came."""

    @classmethod
    def of(
        cls, states: Sequence[State], corridor: Corridor, decision_s: float | None
    ) -> "RecordedRun":
        """Collect states."""
        poses = np.array([state.poses for state in states])
        if states[0].places is None:
            s, t = corridor.locate_all(poses[:, :, 0].ravel(), poses[:, :, 1].ravel())
            places = np.stack([s, t], axis=1).reshape(*poses.shape[:2], 2)
        else:
            places = np.array([state.places for state in states])
        return cls(
            states[0].ids,
            np.array([state.time for state in states]),
            poses,
            np.array([state.speeds for state in states]),
            places,
            decision_s,
        )

    @property
    def dt(self) -> float:
        """Seconds per step."""
        return float(self.time[1] - self.time[0]) if len(self.time) > 1 else _STEP_OF_ONE_STATE_S

    @property
    def velocities(self) -> Floats:
        """[n, bodies, 3] m/s; in a run of one state, along the headings."""
        if len(self.time) > 1:
            return self.rates(self.poses[:, :, :3])
        headings = self.poses[:, :, 3]
        along: Floats = np.stack(
            (np.cos(headings), np.sin(headings), np.zeros_like(headings)), axis=2
        )
        return self.speeds[:, :, None] * along

    def rates(self, values: Floats) -> Floats:
        """Return by how much values [n, ...] change per second; 0 in a run of one state."""
        if len(values) < 2:
            return np.zeros_like(values)
        rates: Floats = np.gradient(values, self.dt, axis=0, edge_order=2 if len(values) > 2 else 1)
        return rates


def replayed(
    scene: Scene,
    simulator: Simulator,
    action: str,
    seed: int,
    reaction_s: float = NOMINAL_REACTION_S,
) -> RecordedRun:
    """Record the approach and one action up to the horizon, a contact or the road's edge.

    Raises:
        UnknownComponent: If there is no such action.
        UsageError: If the ego lacks the lane that the action needs.
    """
    states, _, _ = approach(scene, simulator, seed)
    after = list(action_states(scene, simulator, states[-1], action, reaction_s))
    decision_s = states[-1].time if after else None
    states += after
    return RecordedRun.of(states, load_corridor(scene.map, simulator.catalogue()), decision_s)


def action_states(
    scene: Scene, simulator: Simulator, state: State, action: str, reaction_s: float
) -> Iterator[State]:
    """Yield the states of an action after the current one, up to the horizon, a contact or the road's edge.

    Raises:
        UnknownComponent: If there is no such action.
        UsageError: If the ego lacks the lane that the action needs.
    """
    observation = simulator.observe()
    with of_the_caller():
        driver = action_driver(action, reaction_s)
        if not is_available(action, observation):
            raise UsageError(f"the ego has no lane for its action {action}")
    for _ in range(max(1, round(scene.horizon_s / simulator.dt))):
        if state.contacts or state.off_road:
            return
        state = simulator.step(driver.act(simulator.observe()))
        yield state


def ordinary_twin(
    scene: Scene, catalogue: Catalogue, *, seed: int = 0, simulator: Simulator | None = None
) -> Scene:
    """Return a scene's ordinary twin, judged at the time of the scene's own decision."""
    with moving(simulator, catalogue) as world:
        states, _, _ = approach(scene, world, seed)
    return scene.twin(round(states[-1].time, 6))
