"""Verdicts on runs that another player drove, as the simulation itself would judge them."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked
from oodscen.data._base import Data
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._drive_result import DriveResult
from oodscen.data._episode import ActionOutcome
from oodscen.data._scene import Scene
from oodscen.driving import KinematicWorld
from oodscen.driving._motion.triggers import MAX_APPROACH_S, is_due
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._trace import Course, Trace
from oodscen.errors import DataError, Issue
from oodscen.interchange._verdicts.expected import start_of, strayed
from oodscen.interchange._verdicts.plausibility import (
    check_bounds,
    check_motion,
    check_steps,
    unusable,
)
from oodscen.interchange._verdicts.poses import PlayedPoses, read_poses
from oodscen.numerics._exact import Floats
from oodscen.protocols import State
from oodscen.stages._drive import drive_result, inconclusive_drive
from oodscen.stages._safe_actions import judge_outcome, runs_red

_ALIGNED = 0.8
"""Cosine to the road's direction from which an actor drives along the road."""
_STRAIGHT = 0.1
"""Share of a bend of mean speeds up to which those before and after it are straight."""
_EARLY_S = 0.25
"""Time before the horizon at which a run may end, s."""
_SIZE_M = 0.25
"""Difference of the ego's length or width from the scene's above which it is noted, m."""
_ROUNDING_S = 1e-6
"""Time after the horizon up to which a moment of a recording is within it, s."""


class PlayedVerdict(Data):
    """The judgement of one run of one scene in another player."""

    scene_id: str
    decision_s: float
    """Time of the decision, or of the end if the decision never came, s."""
    decision_fired: bool
    """False if the decision's trigger never fired."""
    is_complete: bool
    """True if the run lasted to the scene's horizon, a contact, or the road's edge."""
    inconclusive: str = ""
    """The reason why the run is neither passed nor failed; empty if it was judged."""
    notes: tuple[str, ...] = ()
    """Assumptions made in reading the run."""
    outcome: ActionOutcome | None
    """The outcome from the decision on; `None` if the run is inconclusive."""
    drive: DriveResult
    """The whole run as a drive, for the table of drivers."""


@checked
def verdict(
    scene: Scene,
    played: PlayedPoses | str | Path,
    catalogue: Catalogue,
    *,
    driver: str = "played",
    seed: int = 0,
) -> PlayedVerdict:
    """Judge a run by its poses: the decision, contacts, margins and safety.

    A run is inconclusive if its bodies do not start where the scene's do, an unusual actor leaves the course that the
    scene gives it, or the run ends before the decision or the horizon without harm.

    Args:
        scene: The scene or twin that was played.
        played: The poses of `ego` and of every actor, by the ids of the scene, or the file that holds them: CSV with
            the columns `time,name,x,y,h`, esmini's CSV log, or a trace of OSI ground truth.
        catalogue: The catalogue with which the scene was exported, for sizes and the road.
        driver: Name of what drove the ego.
        seed: Seed of the export.

    Raises:
        DataError: If the file is malformed, with the line of the first fault, a body is missing, the poses have a
            hole, or their motion shows that a unit is wrong.
    """
    if not isinstance(played, PlayedPoses):
        played = read_poses(played)
    check_bounds(played.names, played.time, played.poses)
    check_steps(played.time)
    corridor = load_corridor(scene.map, catalogue)

    def world() -> KinematicWorld:
        return KinematicWorld(corridor, scene, catalogue, seed)

    poses, notes = _poses_of(scene, played, world().ids)
    begun_s, doubt = start_of(world(), played.time, poses)
    notes += _ego_notes(played, catalogue.ego)
    if begun_s:
        notes.append(f"times start at {begun_s:g} s and are counted from there")
    run = _judged_run(scene, _states(world(), played.time - begun_s, poses), corridor)
    steps = len(run.states)
    steered = _steered_rows(scene, catalogue)
    heading_note = check_motion(run.last.ids, played.time[:steps], poses[:steps], steered)
    if heading_note:
        notes.append(heading_note)
    step_s = float(np.median(np.diff(played.time)))
    is_complete = run.is_harmed or run.last.time >= run.horizon_s - max(_EARLY_S, 1.5 * step_s)
    doubt = (
        doubt
        or strayed(world(), run.states, run.decision.time)
        or _doubt_about_end(run, is_complete=is_complete)
    )
    outcome = None
    if doubt:
        drive = inconclusive_drive(scene.id, driver, doubt)
    else:
        outcome = _outcome(scene, catalogue, run)
        horizon_steps = round(run.horizon_s / step_s)
        drive = drive_result(scene, run.states, catalogue, driver, horizon_steps, step_s)
    return PlayedVerdict(
        scene_id=scene.id,
        decision_s=round(run.decision.time, 6),
        decision_fired=run.is_fired,
        is_complete=is_complete,
        inconclusive=doubt,
        notes=tuple(notes),
        outcome=outcome,
        drive=drive,
    )


class _JudgedRun(NamedTuple):
    """The part of a run that is judged: up to the horizon, the first harm, or its end."""

    states: list[State]
    decision_step: int
    is_fired: bool
    """False if the decision's trigger never fired."""
    horizon_s: float
    """Time of the horizon, s."""

    @property
    def decision(self) -> State:
        """The state at the decision, or the last one before it."""
        return self.states[self.decision_step]

    @property
    def last(self) -> State:
        """The last state."""
        return self.states[-1]

    @property
    def is_harmed(self) -> bool:
        """Return whether the run ends with a contact or off the road."""
        return _is_harm(self.last)


def _judged_run(scene: Scene, states: Sequence[State], corridor: Corridor) -> _JudgedRun:
    step, is_fired = _decision(scene, states, corridor)
    horizon_s = states[step].time + scene.horizon_s
    within = [state for state in states[step + 1 :] if state.time <= horizon_s + _ROUNDING_S]
    judged = [*states[: step + 1], *_until_harm(within)]
    return _JudgedRun(judged, step, is_fired, horizon_s)


def _doubt_about_end(run: _JudgedRun, *, is_complete: bool) -> str:
    """Return that a run ends too early to be judged, or an empty text."""
    is_undecided = not run.is_harmed and not run.is_fired
    if is_undecided and run.decision.time < MAX_APPROACH_S:
        return f"the run ends at {run.decision.time:g} s, before its decision"
    if not is_complete:
        return f"the run ends at {run.last.time:g} s, before the horizon at {run.horizon_s:g} s"
    return ""


def _steered_rows(scene: Scene, catalogue: Catalogue) -> list[int]:
    """Return the rows of the bodies that turn by steering."""
    bodies = enumerate(catalogue.bodies(scene))
    return [row for row, (_, asset, _) in bodies if asset.category in ("vehicle", "cyclist")]


def _outcome(scene: Scene, catalogue: Catalogue, run: _JudgedRun) -> ActionOutcome:
    """Judge the states from the decision on."""
    course, line = Course.of(scene, catalogue), scene.stop_line
    watched = run.states[run.decision_step :]
    ran_red = line is not None and runs_red(watched, line, course)
    trace = Trace.from_states(watched, course)
    return judge_outcome(watched[1:] or watched, trace, ran_red=ran_red)


def _poses_of(scene: Scene, played: PlayedPoses, ids: tuple[str, ...]) -> tuple[Floats, list[str]]:
    """Return the poses of the scene's bodies, [n, bodies, 4] in the order of a world, and notes.

    Raises:
        DataError: If a body, or one of its poses, is missing.
    """
    if missing := [name for name in ids if name not in played.names]:
        issues = [Issue(name, "has no poses") for name in missing]
        raise DataError("run of a player", issues, source=scene.id)
    poses = played.poses[:, [played.names.index(name) for name in ids]]
    if np.isnan(poses).any():
        step, row = np.argwhere(np.isnan(poses).any(axis=2))[0]
        raise unusable(ids[row], f"has no pose at {played.time[step]:g} s")
    others = [name for name in played.names if name not in ids]
    if played.unnamed:
        others.append(f"{played.unnamed} without a name")
    if not others:
        return poses, []
    return poses, [f"not in the scene, and not looked at: {', '.join(others)}"]


def _ego_notes(played: PlayedPoses, ego: Asset) -> list[str]:
    """Return notes on what a file tells about the ego otherwise than the scene."""
    notes = []
    for length, width in played.ego_sizes:
        difference_m = max(abs(length - ego.length), abs(width - ego.width))
        if not difference_m <= _SIZE_M:  # A size may be NaN.
            notes.append(
                f"ego is {length:g} x {width:g} m in the file, and judged as {ego.length:g} x {ego.width:g} m"
            )
            break
    if played.other_host is not None:
        notes.append(f"host_vehicle_id is that of {played.other_host}, not of ego, which is judged")
    return notes


def _states(world: KinematicWorld, times: Floats, poses: Floats) -> list[State]:
    """Return the states of a world with the played poses; speeds are those of the poses."""
    actors = enumerate(world.scene.actors, start=1)
    towed = [row for row, actor in actors if actor.behaviour.name == "towed"]
    speeds = _speeds(times, poses, world.corridor, towed)
    states = []
    for step, time in enumerate(times.tolist()):
        world.set_poses(poses[step], speeds[step])
        states.append(replace(world.state(), step=step, time=time, accelerations=None))
    return states


def _speeds(time: Floats, poses: Floats, corridor: Corridor, towed: Sequence[int]) -> Floats:
    """Return the speeds along the headings at the end of every step, from the steps before.

    The acceleration is taken as constant over two steps, or over the last one if it changed then. Where a simulator
    moves bodies by the speed at the start of a step, the mean speed bends at once; there the speed is the mean of the
    steps before and after. A body that would end a step moving backwards against it has come to rest. An actor that drives along the road has the speed of its
    way along the road, since its heading need not follow its swaying. A towed body has its mean speed over the last
    step, as in the simulation.
    """
    mean = _mean_speeds(time, poses, corridor, towed)
    change = np.diff(mean, axis=0)
    speeds = np.empty(poses.shape[:2])
    speeds[0] = mean[0] if len(mean) < 2 else mean[0] - 0.5 * (mean[1] - mean[0])
    speeds[1:] = mean
    speeds[2:] += 0.5 * change
    turn = np.diff(change, axis=0)
    is_sudden = np.abs(turn[:-1]) < 0.5 * np.abs(turn[1:])
    speeds[4:] += np.where(is_sudden, 0.5 * turn[1:], 0.0)
    at, rows = np.nonzero(_bends_at_once(turn))
    for step in (at + 3, at + 4):
        speeds[step, rows] = 0.5 * (mean[step - 1, rows] + mean[step, rows])
    speeds[1:][speeds[1:] * mean <= 0.0] = 0.0
    speeds[2:, towed] = mean[1:, towed]
    return speeds


def _bends_at_once(turn: Floats) -> NDArray[np.bool_]:
    """Return where mean speeds, straight before and after, bend between two steps: [n - 6, bodies].

    `turn` has the second differences of the mean speeds, [n - 3, bodies].
    """
    now = _STRAIGHT * np.abs(turn[1:-2])
    others = (turn[:-3], turn[2:-1], turn[3:])
    bends: NDArray[np.bool_] = np.all([np.abs(other) < now for other in others], axis=0)
    return bends


def _mean_speeds(time: Floats, poses: Floats, corridor: Corridor, towed: Sequence[int]) -> Floats:
    """Return the mean speeds along the headings in every step: [n - 1, bodies], m/s."""
    heading, durations_s = poses[:, :, 3], np.diff(time)[:, None]
    velocities = np.diff(poses[:, :, :2], axis=0) / durations_s[:, :, None]
    mean: Floats = velocities[:, :, 0] * np.cos(heading[1:]) + velocities[:, :, 1] * np.sin(
        heading[1:]
    )
    flat_s, flat_t = corridor.locate_all(poses[:, :, 0].ravel(), poses[:, :, 1].ravel())
    s, t = flat_s.reshape(heading.shape), flat_t.reshape(heading.shape)
    sin, cos, curvature = (
        np.interp(s, corridor.s, values)
        for values in (corridor.sin, corridor.cos, corridor.curvature)
    )
    alignment = np.cos(heading) * cos + np.sin(heading) * sin
    along = np.diff(s, axis=0) / durations_s * (1.0 - curvature * t)[1:]
    drives_along = np.abs(alignment[:-1]) > _ALIGNED
    drives_along[:, [0, *towed]] = False
    mean[drives_along] = along[drives_along] / alignment[:-1][drives_along]
    return mean


def _decision(scene: Scene, states: Sequence[State], corridor: Corridor) -> tuple[int, bool]:
    """Return the step of the decision, and true if its trigger fired."""
    for index, state in enumerate(states):
        if is_due(scene.decision, None, state, corridor):
            return index, True
        if _is_harm(state) or state.time >= MAX_APPROACH_S:
            return index, False
    return len(states) - 1, False


def _until_harm(states: Sequence[State]) -> list[State]:
    """Return the states up to the first contact or the road's edge."""
    for index, state in enumerate(states):
        if _is_harm(state):
            return list(states[: index + 1])
    return list(states)


def _is_harm(state: State) -> bool:
    return bool(state.contacts) or state.off_road
