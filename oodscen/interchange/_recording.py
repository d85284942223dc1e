"""Runs of a scene as arrays, for the files that hold the courses of its bodies."""

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from oodscen._display import Brief
from oodscen._members import of_the_caller, working
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.data._scene import MAX_TRIGGER, Behaviour, Scene, Trigger
from oodscen.driving import MirrorSimulator
from oodscen.driving._checked_simulator import checked_simulator, moves_as_world
from oodscen.driving._exclusive import exclusive
from oodscen.driving._motion.actions import Cruise, action_driver, is_available
from oodscen.driving._motion.behaviours import MOVES_BEFORE_TRIGGER
from oodscen.driving._motion.triggers import MAX_APPROACH_S
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import SimulatorError, UsageError
from oodscen.numerics._exact import Floats
from oodscen.protocols import Camera, Driver, Frame, Simulator, State
from oodscen.stages._simulate import approach

AFTER_S = 12.0
"""Duration of a reactive file beyond the nominal decision, s."""
_NEVER_S = MAX_TRIGGER
"""Time after the end of every run, s."""
_DIFFERS_M = 1e-3
"""Distance between two courses of an actor above which they differ, m."""
_STEP_OF_ONE_STATE_S = 0.05
"""Time step of a run of one state, s."""


class UnrenderedSimulator(MirrorSimulator):
    """The kinematic world of a catalogue without pictures."""

    name = "unrendered"

    def __init__(self, catalogue: Catalogue, dt: float = MirrorSimulator.dt) -> None:
        super().__init__()
        self._catalogue = catalogue
        self.dt = dt

    def catalogue(self) -> Catalogue:
        """Return the catalogue of the world."""
        return self._catalogue

    def load(self, corridor: Corridor, scene: Scene, seed: int) -> None:
        """Do nothing: there is no scenery."""

    def spawn(
        self, actor_id: str, asset: Asset, state: str, pose: tuple[float, float, float, float]
    ) -> None:
        """Do nothing: bodies are only boxes of the world."""

    def place(self, poses: Floats, speeds: Floats) -> None:
        """Do nothing: poses are only those of the world."""

    def draw(self, camera: Camera) -> Frame:
        """Refuse.

        Raises:
            SimulatorError: Always.
        """
        raise SimulatorError("this simulator has no pictures")


@contextmanager
def moving(simulator: Simulator | None, catalogue: Catalogue) -> Iterator[Simulator]:
    """Lend a simulator; in place of none, and of one that moves as the kinematic world, that world without pictures.

    Raises:
        SimulatorError: When the simulator fails, whatever it raises.
        UsageError: When another thread uses the simulator.
    """
    if simulator is None:
        yield UnrenderedSimulator(catalogue)
    elif moves_as_world(simulator):
        yield UnrenderedSimulator(catalogue, simulator.dt)
    else:
        with exclusive(simulator), working("simulator", simulator.name):
            yield checked_simulator(simulator)


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


@dataclass(frozen=True, eq=False, repr=False)
class Reactions(Brief):
    """The courses with and without triggers, and the actors that mind the ego."""

    nominal: RecordedRun
    """The run with the blind ego, to its end; actors ahead of it do not mind it."""
    quiet: RecordedRun
    """The same run without triggers on the ego: the courses before the reactions."""
    triggered: dict[str, int]
    """Step at which each actor's trigger fired in the nominal run."""
    mindful: frozenset[str]
    """Actors whose courses depend on the ego before any trigger."""
    behaviours: dict[str, Behaviour]
    """The behaviour of each actor as the built-in one that it is or is like, with all its parameters."""


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


def reactions(scene: Scene, catalogue: Catalogue, seed: int) -> Reactions:
    """Record what a reactive file needs."""
    simulator = UnrenderedSimulator(catalogue)
    nominal = _driven(scene, simulator, Cruise(), seed)
    triggered = _trigger_steps(nominal, simulator)
    steps = len(nominal.time) - 1
    untriggered = _without_triggers(scene)
    behaviours = _built_in_behaviours(scene, catalogue)
    has_early_movers = any(does.name in MOVES_BEFORE_TRIGGER for does in behaviours.values())
    reacting = {actor.id for actor in scene.actors if actor.behaviour.trigger.kind != "time"}
    if not reacting:
        quiet = nominal
    elif has_early_movers or _has_actors_moved_by_others(scene):
        quiet = _driven(untriggered, simulator, Cruise(), seed, steps)
    else:
        quiet = _resting(nominal, reacting)
    if not has_early_movers:
        return Reactions(nominal, quiet, triggered, frozenset(), behaviours)
    stopped = _driven(untriggered, simulator, action_driver("stop"), seed, steps)
    mindful = _differing(quiet, stopped) - {"ego"}
    # A blind ego drives through whatever is ahead, which would then mind it.
    ahead = _rows_ahead_of_ego(quiet, mindful)
    without_reaction = [row for row in ahead if quiet.ids[row] not in reacting]
    return Reactions(
        _replaced(nominal, stopped, without_reaction),
        _replaced(quiet, stopped, ahead),
        triggered,
        frozenset(mindful),
        behaviours,
    )


def _built_in_behaviours(scene: Scene, catalogue: Catalogue) -> dict[str, Behaviour]:
    """Return the behaviours of actors by built-in names, with the defaults of their own parameters."""
    kinds = {kind.id: kind for kind in catalogue.for_scene(scene).behaviours}
    behaviours = {}
    for actor in scene.actors:
        kind, given = kinds[actor.behaviour.name], actor.behaviour.parameters
        defaults = {name: parameter.default for name, parameter in kind.parameters.items()}
        built_in = {"name": kind.built_in, "parameters": {**defaults, **given}}
        behaviours[actor.id] = actor.behaviour.model_copy(update=built_in)
    return behaviours


def _trigger_steps(run: RecordedRun, simulator: UnrenderedSimulator) -> dict[str, int]:
    """Return the step at which each actor's trigger fired in a run that has just ended."""
    times_s = {actor: simulator.world.motion(actor).triggered for actor in run.ids[1:]}
    return {actor: round(time_s / run.dt) for actor, time_s in times_s.items() if time_s >= 0.0}


def _has_actors_moved_by_others(scene: Scene) -> bool:
    """Return whether an actor follows another, or a motion that begins before its trigger."""
    moving = {motion.id for motion in scene.motions if motion.begins == "moving"}
    return any(
        actor.behaviour.other is not None or actor.behaviour.name in moving
        for actor in scene.actors
    )


def _differing(run: RecordedRun, other: RecordedRun) -> set[str]:
    """Return the bodies whose courses differ between two runs."""
    apart_m = np.abs(run.poses[:, :, :2] - other.poses[:, :, :2]).max(axis=(0, 2))
    return {
        body for body, distance_m in zip(run.ids, apart_m, strict=True) if distance_m > _DIFFERS_M
    }


def _rows_ahead_of_ego(run: RecordedRun, bodies: Collection[str]) -> list[int]:
    """Return the rows of those of some bodies that start ahead of the ego."""
    start_s_m = run.places[0, :, 0]
    return [
        row for row, body in enumerate(run.ids) if body in bodies and start_s_m[row] > start_s_m[0]
    ]


def _driven(
    scene: Scene,
    simulator: UnrenderedSimulator,
    driver: Driver,
    seed: int,
    steps: int | None = None,
) -> RecordedRun:
    """Record a drive, contacts or not, for some steps or by default to `AFTER_S` beyond the decision."""
    states = [simulator.reset(scene, seed)]
    world = simulator.world
    decision_s: float | None = None
    last = steps if steps is not None else round((MAX_APPROACH_S + AFTER_S) / simulator.dt)
    while len(states) <= last:
        if decision_s is None and world.is_due(scene.decision):
            decision_s = world.time
            if steps is None:
                last = min(last, world.step_count + round(AFTER_S / simulator.dt))
        world.step(driver.act(world.observe()))
        states.append(world.state())
    return RecordedRun.of(states, world.corridor, decision_s)


def _replaced(run: RecordedRun, other: RecordedRun, rows: Sequence[int]) -> RecordedRun:
    """Return a run with the courses of some bodies from another."""
    return _with_courses(run, rows, other.poses, other.speeds, other.places)


def _resting(run: RecordedRun, bodies: Collection[str]) -> RecordedRun:
    """Return a run in which some bodies never leave their start."""
    rows = [row for row, body in enumerate(run.ids) if body in bodies]
    return _with_courses(run, rows, run.poses[:1], np.zeros_like(run.speeds), run.places[:1])


def _with_courses(
    run: RecordedRun, rows: Sequence[int], poses: Floats, speeds: Floats, places: Floats
) -> RecordedRun:
    """Return a run with other courses of some bodies; one step stands for all."""
    new_poses, new_speeds, new_places = run.poses.copy(), run.speeds.copy(), run.places.copy()
    new_poses[:, rows] = poses[:, rows]
    new_speeds[:, rows] = speeds[:, rows]
    new_places[:, rows] = places[:, rows]
    return replace(run, poses=new_poses, speeds=new_speeds, places=new_places)


def _without_triggers(scene: Scene) -> Scene:
    """Return the scene with triggers on the ego that never fire."""
    never = Trigger(kind="time", value=_NEVER_S)
    actors = []
    for actor in scene.actors:
        if actor.behaviour.trigger.kind != "time":
            behaviour = actor.behaviour.model_copy(update={"trigger": never})
            actor = actor.model_copy(update={"behaviour": behaviour})
        actors.append(actor)
    return scene.model_copy(update={"actors": tuple(actors)})


def ordinary_twin(
    scene: Scene, catalogue: Catalogue, *, seed: int = 0, simulator: Simulator | None = None
) -> Scene:
    """Return a scene's ordinary twin, judged at the time of the scene's own decision."""
    with moving(simulator, catalogue) as world:
        states, _, _ = approach(scene, world, seed)
    return scene.twin(round(states[-1].time, 6))
