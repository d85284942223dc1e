"""Runs that tell how actors react to the ego, for reactive files."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from oodscen._display import Brief
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import MAX_TRIGGER, Behaviour, Scene, Trigger
from oodscen.driving._motion.actions import Cruise, action_driver
from oodscen.driving._motion.behaviours.table import MOVES_BEFORE_TRIGGER
from oodscen.driving._motion.triggers import MAX_APPROACH_S
from oodscen.interchange._moving import UnrenderedSimulator
from oodscen.interchange._recording import RecordedRun
from oodscen.numerics._exact import Floats
from oodscen.protocols import Driver

AFTER_S = 12.0
"""Duration of a reactive file beyond the nominal decision, s."""
_NEVER_S = MAX_TRIGGER
"""Time after the end of every run, s."""
_DIFFERS_M = 1e-3
"""Distance between two courses of an actor above which they differ, m."""


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
