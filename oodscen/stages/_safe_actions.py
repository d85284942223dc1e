"""Safe actions from a decision on, found by rollouts with drivers who react sooner or later."""

import hashlib
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple, Self

import numpy as np

from oodscen._abilities import Rehearses, Snapshots
from oodscen._numbers import finite_number, said
from oodscen.data._episode import ActionOutcome
from oodscen.data._reactions import LONGEST_REACTION_S
from oodscen.data._scene import Scene, StopLine
from oodscen.driving._motion.actions import action_driver, is_available
from oodscen.driving._motion.rollouts import Variation
from oodscen.driving._trace import Course, Trace
from oodscen.errors import SimulatorError, UsageError
from oodscen.protocols import Control, Observation, Simulator, State

JERK_S = 0.2
"""Interval over which a change of acceleration is measured, in seconds."""
FRICTIONS = (1.0, 0.9)
"""Shares of the road's friction."""
SPEEDS = (0.95, 1.0, 1.05)
"""Shares of the ego's speed at the decision."""


class Trials(NamedTuple):
    """The drivers who try every action."""

    middle: float
    """Reaction time of the driver whose drive is recorded, s."""
    others: tuple[Variation, ...]
    """The other drivers and roads, from easy to hard."""
    collisions_only: bool = False
    """Leaving the road neither is unsafe nor ends a drive."""

    @classmethod
    def of(cls, reactions: Sequence[float], collisions_only: bool = False) -> Self:
        """Return the drivers with these reaction times, s.

        Raises:
            UsageError: If there is none, or one is no number from 0 to `LONGEST_REACTION_S`.
        """
        ordered = sorted(
            {finite_number("reaction", time, 0.0, LONGEST_REACTION_S) for time in reactions}
        )
        if not ordered:
            raise UsageError("reaction: give one or more times, in seconds")
        middle = ordered[(len(ordered) - 1) // 2]
        if collisions_only:
            return cls(middle, (), True)
        grid = [
            Variation(reaction, friction, speed)
            for reaction in ordered
            for friction in FRICTIONS
            for speed in SPEEDS
        ]
        return cls(middle, tuple(variation for variation in grid if variation != Variation(middle)))

    def other_variations(self, action: str, passed: bool) -> Iterator[Variation]:
        """Yield the other variations of an action, those first whose outcome most likely differs.

        An ego that keeps the speed has nothing to react to.
        """
        for variation in reversed(self.others) if passed else self.others:
            if action != "keep_speed" or variation.reaction_s == self.middle:
                yield variation


class Rollouts:
    """Executes actions from one decision point, by snapshot or by replaying the approach.

    Args:
        simulator: The simulator, at the decision.
        scene: The scene that it runs.
        seed: Seed of its random streams.
        controls: The controls of the approach.
        digest: Fingerprint of the approach's states.
        course: The scene's road and bodies.
        trials: The drivers who try every action.
    """

    def __init__(
        self,
        simulator: Simulator,
        scene: Scene,
        seed: int,
        controls: Sequence[Control],
        digest: str,
        course: Course,
        trials: Trials,
    ) -> None:
        self.simulator = simulator
        self.scene = scene
        self.seed = seed
        self.controls = controls
        self.digest = digest
        self.course = course
        self.trials = trials
        self.line = None if trials.collisions_only else scene.stop_line
        self.rehearse = simulator.rehearse if isinstance(simulator, Rehearses) else None
        self.restore = simulator.restore if isinstance(simulator, Snapshots) else None
        self.snapshot = simulator.snapshot() if isinstance(simulator, Snapshots) else None

    def outcome(self, action: str) -> tuple[ActionOutcome, Trace | None, bool]:
        """Return the outcome and trace of an action, and whether the approach was the same as before."""
        first, is_same = self._rewind()
        observation = self.simulator.observe()
        if not is_available(action, observation):
            return ActionOutcome(safe=False, unavailable=True), None, is_same
        states = self._execute(action, self.trials.middle, observation)
        trace = Trace.from_states([first, *states], self.course)
        ran_red = self._ran_red([first, *states])
        outcome = judge_outcome(states, trace, self.trials.collisions_only, ran_red=ran_red)
        for variation in self.trials.other_variations(action, outcome.safe):
            if self.rehearse is None and variation != Variation(variation.reaction_s):
                continue
            passes, is_same_again = self._passes(action, variation)
            is_same &= is_same_again
            if passes != outcome.safe:
                outcome = outcome.model_copy(update={"safe": False, "marginal": True})
                break
        return outcome, trace, is_same

    def _passes(self, action: str, variation: Variation) -> tuple[bool, bool]:
        """Return whether a driver passes, and whether the approach was the same as before."""
        first, is_same = self._rewind()
        if self.rehearse is not None:
            passes = self.rehearse(action, self.scene.horizon_s, **variation._asdict())
            if not isinstance(passes, bool | np.bool_):
                raise SimulatorError(
                    f"{self.simulator.name}: rehearse() returned {said(passes, 80)}, not True or False"
                )
            return bool(passes), is_same
        states = self._execute(action, variation.reaction_s, self.simulator.observe())
        has_failed = _has_failed(states[-1], self.trials.collisions_only)
        return not (has_failed or self._ran_red([first, *states])), is_same

    def _ran_red(self, states: Sequence[State]) -> bool:
        """Return whether the ego passes the stop line while the light is red."""
        return self.line is not None and runs_red(states, self.line, self.course)

    def _execute(self, action: str, reaction_s: float, observation: Observation) -> list[State]:
        """Drive to the scene's horizon, or until a collision or leaving the road."""
        simulator, driver = self.simulator, action_driver(action, reaction_s)
        states: list[State] = []
        for _ in range(max(1, round(self.scene.horizon_s / simulator.dt))):
            state = simulator.step(driver.act(observation))
            states.append(state)
            if _has_failed(state, self.trials.collisions_only):
                break
            observation = simulator.observe()
        return states

    def _rewind(self) -> tuple[State, bool]:
        """Return to the decision; return its state, and whether the approach was the same as before."""
        if self.restore is not None and self.snapshot is not None:
            return self.restore(self.snapshot), True
        states = [self.simulator.reset(self.scene, self.seed)]
        states += [self.simulator.step(control) for control in self.controls]
        return states[-1], fingerprint(states) == self.digest


def _has_failed(state: State, collisions_only: bool) -> bool:
    """Return whether the ego touches something or, if that counts, is off the road."""
    return bool(state.contacts) or (state.off_road and not collisions_only)


def runs_red(states: Sequence[State], line: StopLine, course: Course) -> bool:
    """Return whether the ego's front passes a stop line in consecutive states while the light is red."""
    road, reach = course.corridor, 0.5 * float(course.sizes[0, 0])
    line_s = road.start + line.ahead_m - reach
    is_beyond = [road.locate(*state.poses[0, :2].tolist())[0] > line_s for state in states]
    if is_beyond[0] or not any(is_beyond):
        return False
    return states[is_beyond.index(True)].time >= line.red_from_s


def judge_outcome(
    states: Sequence[State], trace: Trace, collisions_only: bool = False, *, ran_red: bool = False
) -> ActionOutcome:
    """Return the outcome of an action, with margins from the first step on."""
    last = states[-1]
    margin = min(float(state.gaps[1:].min(initial=np.inf)) for state in states)
    encounters = trace.summary().values()
    times_to_collision_s = [
        encounter.min_ttc_s for encounter in encounters if encounter.min_ttc_s is not None
    ]
    encroachment_times_s = [
        encounter.pet_s for encounter in encounters if encounter.pet_s is not None
    ]
    return ActionOutcome(
        safe=not (_has_failed(last, collisions_only) or ran_red),
        margin_m=None if math.isinf(margin) else _millimetres(margin),
        min_ttc_s=min(times_to_collision_s, default=None),
        pet_s=min(encroachment_times_s, default=None),
        contacts=last.contacts,
        off_road=last.off_road,
        ran_red=ran_red,
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
    time, along = trace["time"][1:, 0], trace["acceleration"][1:, 0]
    if len(time) < 2:
        return None
    steps = max(1, round(JERK_S / float(np.median(np.diff(time)))))
    if len(time) <= steps:
        return None
    changes = np.abs(along[steps:] - along[:-steps]) / (time[steps:] - time[:-steps])
    return round(float(changes.max()), 3)


def fingerprint(states: Sequence[State]) -> str:
    """Return the SHA-256 of consecutive states."""
    digest = hashlib.sha256()
    for state in states:
        digest.update(state.fingerprint())
    return digest.hexdigest()
