"""Comparison of an actor's motion with the reference world's, within stated tolerances."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import BehaviourKind
from oodscen.data._scene import Scene
from oodscen.driving._motion.behaviours.table import BUILT_IN, DRIVES_IN_LANE, having
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.protocols import Control
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import constantly
from oodscen.testing._kit.tracks import ONSET_S, Tracks, run_both, start_fault, turned_by

ALONG_M = 2.0
"""Tolerance along the road for drivers, along their heading for others, m; and a quarter of the way since the start."""
ACROSS_M = 1.0
"""Tolerance across that, m; behaviours with chance in them get twice their amplitude in addition."""
HEADING_DEG = 30.0
"""Tolerance of a moving actor's heading, and of a door's, degrees."""
SPEED = 1.5
"""Tolerance of speeds, m/s; and a quarter of the reference's."""
_LATE_S = 0.5
"""Time by which a change of speed may be early or late, s."""
HEIGHT_M = 0.3
"""Tolerance of the range of an actor's heights in a run, m; and a quarter of the reference's."""
SWAY_M = 0.1
"""Tolerance of the width over which an actor sways, m; and two fifths of the reference's."""
EARLY_SWAY_M = 0.3
"""Tolerance of that width before the trigger, m."""
SWINGS = 0.3
"""Relative tolerance of the number of swings from side to side, or up and down."""
_CHANCE = ("amplitude", "radius", "lift")
"""Parameters that bound how far chance moves an actor, m."""
_LOOSE = having(lambda row: row.has_chance or row.needs_other)
"""Behaviours whose headings and momentary speeds differ with chance or with the body that they belong to."""
_LEAST_SPIN_DEG = 60.0
"""Least turn of the reference whose direction is compared, degrees."""
_LEAST_SWAY_M = 0.1
"""Least width or height of swings that are counted, m."""


def compare(probe: Probe, scene: Scene, kind: BehaviourKind, subject: str, seconds: float) -> None:
    """Compare the motion of a scene's first actor, or only its start if no built-in moves it."""
    tracks, reference = run_both(probe, scene, constantly(Control()), seconds=seconds)
    fault = start_fault(tracks, reference, 1)
    probe.findings.expect(not fault, subject, fault)
    if fault or kind.id not in BUILT_IN:
        return
    behaviour = scene.actors[0].behaviour
    defaults = {name: parameter.default for name, parameter in kind.parameters.items()}
    comparison = _Comparison(
        tracks,
        reference,
        kind,
        load_corridor(scene.map, probe.catalogue),
        behaviour.trigger.value,
        {**defaults, **behaviour.parameters},
    )
    fault = comparison.fault()
    probe.findings.expect(not fault, subject, fault)


@dataclass(frozen=True)
class _Comparison:
    """The motion of a scene's first actor in a simulator, and what it should be."""

    tracks: Tracks
    reference: Tracks
    kind: BehaviourKind
    road: Corridor
    trigger_s: float
    """The value of the actor's trigger, a time."""
    parameters: Mapping[str, float]
    """All parameters of its behaviour."""

    def fault(self) -> str:
        """Return how the motion differs from the reference world's; empty if it does not."""
        return (
            self._onset_fault() or self._step_fault() or self._course_fault() or self._swing_fault()
        )

    def _onset_fault(self) -> str:
        """Return how the actor fails to wait for its trigger, or to move at all."""
        row, earliest_s = BUILT_IN[self.kind.id], self.trigger_s - ONSET_S
        if "amplitude" in self.parameters:
            waiting = max(1, round(earliest_s / self.tracks.dt))
            swayed_m = float(np.ptp(self._places(self.tracks)[:waiting]))
            is_early = swayed_m > EARLY_SWAY_M
            return f"sways over {swayed_m:.1f} m before its trigger" if is_early else ""
        if row.moves_before_trigger or row.needs_other:
            return ""
        onset_s = self.tracks.onset(1)
        if onset_s is None:
            return "never moves" if self.reference.onset(1) is not None else ""
        is_early = onset_s < earliest_s
        return f"moves after {onset_s:.1f} s, before its trigger" if is_early else ""

    def _step_fault(self) -> str:
        """Return how and when the actor's place, speed or heading first differs."""
        chance_m = 2.0 * sum(abs(self.parameters.get(name, 0.0)) for name in _CHANCE)
        covered_m = 0.0
        for step in range(1, len(self.tracks.poses)):
            covered_m += abs(float(self.reference.speeds[step, 1])) * self.tracks.dt
            fault = self._place_fault(
                step, ALONG_M + 0.25 * covered_m + chance_m, ACROSS_M + chance_m
            )
            if not fault and self.kind.id not in _LOOSE:
                fault = self._motion_fault(step)
            if not fault and "angle_deg" in self.parameters:
                fault = self._turn_fault(step)
            if fault:
                return f"{fault} after {step * self.tracks.dt:.1f} s"
        return ""

    def _place_fault(self, step: int, along_m: float, across_m: float) -> str:
        """Return how the actor's place in one step differs by more than tolerances along its way or across it."""
        is_driver = self.kind.id in DRIVES_IN_LANE
        x, y, _, yaw = map(float, self.reference.poses[step if is_driver else 0, 1])
        if is_driver:
            yaw = self.road.heading(self.road.locate(x, y)[0])
        dx, dy = (self.tracks.poses[step, 1, :2] - self.reference.poses[step, 1, :2]).tolist()
        along = dx * math.cos(yaw) + dy * math.sin(yaw)
        across = dy * math.cos(yaw) - dx * math.sin(yaw)
        if not abs(along) <= along_m:
            side = "on" if along > 0.0 else "back"
            return f"is {abs(along):.1f} m further {side} than in the reference world"
        if not abs(across) <= across_m:
            side = "left" if across > 0.0 else "right"
            return f"is {abs(across):.1f} m further {side} than in the reference world"
        return ""

    def _motion_fault(self, step: int) -> str:
        """Return how the actor's speed or heading in one step differs from the reference world's about that time."""
        speed, expected = float(self.tracks.speeds[step, 1]), float(self.reference.speeds[step, 1])
        late = round(_LATE_S / self.tracks.dt)
        about = self.reference.speeds[max(0, step - late) : step + late + 1, 1]
        tolerances = SPEED + 0.25 * np.abs(about)
        if not (about - tolerances).min() <= speed <= (about + tolerances).max():
            return f"has {speed:.1f} m/s, in the reference world {expected:.1f}"
        return self._turn_fault(step) if abs(expected) > 1.0 else ""

    def _turn_fault(self, step: int) -> str:
        """Return how the actor's heading in one step differs."""
        heading, expected = (
            float(each.poses[step, 1, 3]) for each in (self.tracks, self.reference)
        )
        turn_deg = turned_by(heading, expected)
        if not abs(turn_deg) <= HEADING_DEG:
            return f"is turned by {turn_deg:.0f} degrees against the reference world"
        return ""

    def _course_fault(self) -> str:
        """Return how the actor's whole course differs: what chance does not change."""
        rises, should = (
            float(np.ptp(each.poses[:, 1, 2])) for each in (self.tracks, self.reference)
        )
        if not abs(rises - should) <= HEIGHT_M + 0.25 * should:
            return f"rises or falls by {rises:.1f} m, in the reference world by {should:.1f} m"
        if "radius" in self.parameters:
            return _stray_fault(self.tracks, self.reference, self.parameters["radius"])
        return _spin_fault(self.tracks, self.reference) if "spin_deg" in self.parameters else ""

    def _swing_fault(self) -> str:
        """Return how the width or the number of swings differs, once they have grown and if a period is left."""
        period_s = self.parameters.get("period", 0.0)
        first = round((self.trigger_s + period_s) / self.tracks.dt)
        last = first + round(period_s / self.tracks.dt)
        if not first < last < len(self.tracks.poses):
            return ""
        if "lift" in self.parameters:
            swings, should = (
                _swings(each.poses[first:, 1, 2]) for each in (self.tracks, self.reference)
            )
        elif "amplitude" in self.parameters:
            across, expected = (
                self._places(each)[first:] for each in (self.tracks, self.reference)
            )
            width, wide = float(np.ptp(across)), float(np.ptp(expected))
            if not abs(width - wide) <= SWAY_M + 0.4 * wide:
                return f"sways over {width:.1f} m, in the reference world over {wide:.1f} m"
            swings, should = _swings(across), _swings(expected)
        else:
            return ""
        if not abs(swings - should) <= SWINGS * should:
            return f"swings {swings:.1f} times in the time of {should:.1f} in the reference world"
        return ""

    def _places(self, tracks: Tracks) -> NDArray[np.float64]:
        """Return the actor's places across the road in all steps of a run, m."""
        return np.array(
            [self.road.locate(float(x), float(y))[1] for x, y in tracks.poses[:, 1, :2]]
        )


def _swings(values: NDArray[np.float64]) -> float:
    """Return how often values go from one end of their range to the other."""
    return float(np.abs(np.diff(values)).sum() / max(np.ptp(values), _LEAST_SWAY_M))


def _stray_fault(tracks: Tracks, reference: Tracks, radius_m: float) -> str:
    """Return how far or how fast an actor strays, if not about as in the reference world."""
    far, should = (
        float(np.linalg.norm(each.poses[:, 1, :2] - each.poses[0, 1, :2], axis=1).max())
        for each in (tracks, reference)
    )
    if not 0.4 * should - 0.5 <= far <= 2.0 * radius_m + 1.0:
        return f"strays {far:.1f} m from its place, in the reference world {should:.1f} m"
    fastest, expected = (float(each.speeds[:, 1].max()) for each in (tracks, reference))
    if not abs(fastest - expected) <= SPEED + 0.25 * expected:
        return f"reaches {fastest:.1f} m/s, in the reference world {expected:.1f}"
    return ""


def _spin_fault(tracks: Tracks, reference: Tracks) -> str:
    """Return how an actor's turn differs from a great one of the reference world; its end may differ."""
    turn, should = (
        math.degrees(float(np.ptp(headings) * np.sign(headings[-1] - headings[0])))
        for headings in (np.unwrap(each.poses[:, 1, 3]) for each in (tracks, reference))
    )
    if abs(should) > _LEAST_SPIN_DEG and not turn * math.copysign(1.0, should) > 0.25 * abs(should):
        return f"turns by {turn:.0f} degrees, in the reference world by {should:.0f}"
    return ""
