"""One drive of a test, and what its failure shows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

from oodscen._words.text import printable
from oodscen.data._drive_result import DriveResult
from oodscen.data._scene import Scene
from oodscen.protocols import State
from oodscen.stages._drive import brakes_hard

_SHOWN_S = (3.0, 2.0, 1.5, 1.0, 0.5, 0.0)
"""Times before the shown moment of a drive that a failure lists, s."""


@dataclass(frozen=True, eq=False, repr=False)
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
    picture_fault: str = ""
    """The reason why they were not; empty if nothing went wrong."""

    @cached_property
    def shown(self) -> State:
        """The moment that a failure shows: where needless braking begins, else the end of the drive."""
        if self.is_safe and self.is_needless:
            for before, after in pairwise(self.states):
                if brakes_hard(before, after):
                    return after
        return self.states[-1]

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
        result = self.result
        end = f"after {result.seconds:.2f} s at {float(self.states[-1].speeds[0]):.1f} m/s"
        if result.collisions:
            assets = {actor.id: actor.asset for actor in self.scene.actors}
            touched = " and ".join(
                f"{actor} ({assets.get(actor, '?')})" for actor in result.collisions
            )
            return f"touches {touched} {end}"
        if result.off_road:
            return f"leaves the road {end}"
        braking = ""
        if self.is_needless:
            start_s = self.shown.time
            braking = f", braking hard after {start_s:.2f} s although keeping the speed is safe"
        return f"is safe{braking}; least time to collision {_measured(result.min_ttc_s, 's')}"

    def __repr__(self) -> str:
        return f"<{self.result.driver} in {self.scene.id}: {self.outcome}>"

    def report(self, safe_actions: Sequence[str] = ()) -> str:
        """Return what a reader needs in order to understand the drive, in a few lines.

        Args:
            safe_actions: The actions that were safe from the scene's decision on.
        """
        result = self.result
        gap, ttc = _measured(result.min_gap_m, "m"), _measured(result.min_ttc_s, "s")
        rows = [
            ("scene", self.scene.id),
            ("path", " > ".join(self.path)),
            ("text", self.text),
            ("outcome", self.outcome),
            (
                "figures",
                f"least gap {gap}, least time to collision {ttc}, hardest braking "
                f"{result.peak_deceleration:.1f} m/s2, {result.progress:.0%} of the way at constant speed",
            ),
            ("safe here", ", ".join(safe_actions)),
            *(("before" if not row else "", line) for row, line in enumerate(self._last_moments())),
            *zip(("frame", "plan view"), map(str, self.pictures), strict=False),
            ("pictures", self.picture_fault),
        ]
        return "\n".join(printable(f"{name:11}{value}") for name, value in rows if value)

    def _last_moments(self) -> list[str]:
        """Return the ego's speed and the nearest actor at a few times up to the shown moment."""
        moments = {}
        for before_s in _SHOWN_S:
            time_s = self.shown.time - before_s
            nearest = min(self.states, key=lambda state: abs(state.time - time_s))
            moments[nearest.step] = nearest
        return [_moment(state) for state in moments.values()]


def _measured(value: float | None, unit: str) -> str:
    return "none" if value is None else f"{value:.2f} {unit}"


def _moment(state: State) -> str:
    line = f"{state.time:6.2f} s  {float(state.speeds[0]):5.1f} m/s"
    if len(state.ids) > 1:
        row = int(state.gaps[1:].argmin()) + 1
        if state.gaps[row] < math.inf:
            line += f"  {float(state.gaps[row]):5.1f} m from {state.ids[row]}"
    return line
