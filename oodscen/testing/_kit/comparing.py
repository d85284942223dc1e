"""Comparison of an actor's motion with the reference world's, within stated tolerances."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import BehaviourKind
from oodscen.data._scene import Scene, Trigger
from oodscen.driving._motion.behaviours import BUILT_IN, DRIVES_IN_LANE, having
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
    parameters = {**defaults, **behaviour.parameters}
    road = load_corridor(scene.map, probe.catalogue)
    fault = (
        _onset_fault(tracks, reference, kind, road, behaviour.trigger)
        or _step_fault(tracks, reference, kind, road, parameters)
        or _course_fault(tracks, reference, kind, parameters)
        or _swing_fault(tracks, reference, kind, road, behaviour.trigger.value, parameters)
    )
    probe.findings.expect(not fault, subject, fault)


def _onset_fault(
    tracks: Tracks, reference: Tracks, kind: BehaviourKind, road: Corridor, trigger: Trigger
) -> str:
    """Return how an actor fails to wait for its trigger by time, or to move at all."""
    row = BUILT_IN[kind.id]
    if "amplitude" in kind.parameters:
        waiting = max(1, round((trigger.value - ONSET_S) / tracks.dt))
        swayed_m = float(np.ptp(_places(tracks, road)[:waiting]))
        return f"sways over {swayed_m:.1f} m before its trigger" if swayed_m > EARLY_SWAY_M else ""
    if row.moves_before_trigger or row.needs_other:
        return ""
    onset_s = tracks.onset(1)
    if onset_s is None:
        return "never moves" if reference.onset(1) is not None else ""
    is_early = onset_s < trigger.value - ONSET_S
    return f"moves after {onset_s:.1f} s, before its trigger" if is_early else ""


def _step_fault(
    tracks: Tracks,
    reference: Tracks,
    kind: BehaviourKind,
    road: Corridor,
    parameters: Mapping[str, float],
) -> str:
    """Return how and when an actor's place, speed or heading first differs from the reference world's."""
    chance_m = 2.0 * sum(abs(parameters.get(name, 0.0)) for name in _CHANCE)
    covered_m = 0.0
    for step in range(1, len(tracks.poses)):
        covered_m += abs(float(reference.speeds[step, 1])) * tracks.dt
        tolerances_m = (ALONG_M + 0.25 * covered_m + chance_m, ACROSS_M + chance_m)
        x, y, _, yaw = map(float, reference.poses[step if kind.id in DRIVES_IN_LANE else 0, 1])
        if kind.id in DRIVES_IN_LANE:
            yaw = road.heading(road.locate(x, y)[0])
        fault = _place_fault(tracks, reference, step, yaw, tolerances_m)
        if not fault and kind.id not in _LOOSE:
            fault = _motion_fault(tracks, reference, step)
        if not fault and "angle_deg" in kind.parameters:
            fault = _turn_fault(tracks, reference, step)
        if fault:
            return f"{fault} after {step * tracks.dt:.1f} s"
    return ""


def _place_fault(
    tracks: Tracks, reference: Tracks, step: int, yaw: float, tolerances_m: tuple[float, float]
) -> str:
    """Return how an actor's place in one step differs from the reference world's, along a direction or across it."""
    dx, dy = (tracks.poses[step, 1, :2] - reference.poses[step, 1, :2]).tolist()
    along = dx * math.cos(yaw) + dy * math.sin(yaw)
    across = dy * math.cos(yaw) - dx * math.sin(yaw)
    if not abs(along) <= tolerances_m[0]:
        side = "on" if along > 0.0 else "back"
        return f"is {abs(along):.1f} m further {side} than in the reference world"
    if not abs(across) <= tolerances_m[1]:
        side = "left" if across > 0.0 else "right"
        return f"is {abs(across):.1f} m further {side} than in the reference world"
    return ""


def _motion_fault(tracks: Tracks, reference: Tracks, step: int) -> str:
    """Return how an actor's speed or heading in one step differs from the reference world's about that time."""
    speed, expected = float(tracks.speeds[step, 1]), float(reference.speeds[step, 1])
    late = round(_LATE_S / tracks.dt)
    about = reference.speeds[max(0, step - late) : step + late + 1, 1]
    if not _within(
        about - SPEED - 0.25 * np.abs(about), speed, about + SPEED + 0.25 * np.abs(about)
    ):
        return f"has {speed:.1f} m/s, in the reference world {expected:.1f}"
    return _turn_fault(tracks, reference, step) if abs(expected) > 1.0 else ""


def _within(low: NDArray[np.float64], value: float, high: NDArray[np.float64]) -> bool:
    """Return whether a value lies within some limits."""
    return bool(low.min() <= value <= high.max())


def _turn_fault(tracks: Tracks, reference: Tracks, step: int) -> str:
    """Return how an actor's heading in one step differs from the reference world's."""
    turn_deg = turned_by(float(tracks.poses[step, 1, 3]), float(reference.poses[step, 1, 3]))
    if not abs(turn_deg) <= HEADING_DEG:
        return f"is turned by {turn_deg:.0f} degrees against the reference world"
    return ""


def _course_fault(
    tracks: Tracks, reference: Tracks, kind: BehaviourKind, parameters: Mapping[str, float]
) -> str:
    """Return how an actor's whole course differs from the reference world's: what chance does not change."""
    rises, should = (float(np.ptp(each.poses[:, 1, 2])) for each in (tracks, reference))
    if not abs(rises - should) <= HEIGHT_M + 0.25 * should:
        return f"rises or falls by {rises:.1f} m, in the reference world by {should:.1f} m"
    if "radius" in kind.parameters:
        return _stray_fault(tracks, reference, parameters["radius"])
    return _spin_fault(tracks, reference) if "spin_deg" in kind.parameters else ""


def _swing_fault(
    tracks: Tracks,
    reference: Tracks,
    kind: BehaviourKind,
    road: Corridor,
    trigger_s: float,
    parameters: Mapping[str, float],
) -> str:
    """Return how the width or the number of an actor's swings differs, once they have grown and if a period is left."""
    first = round((trigger_s + parameters.get("period", 0.0)) / tracks.dt)
    last = first + round(parameters.get("period", 0.0) / tracks.dt)
    if not first < last < len(tracks.poses):
        return ""
    if "lift" in kind.parameters:
        swings, should = (_swings(each.poses[first:, 1, 2]) for each in (tracks, reference))
    elif "amplitude" in kind.parameters:
        across, expected = (_places(each, road)[first:] for each in (tracks, reference))
        width, wide = float(np.ptp(across)), float(np.ptp(expected))
        if not abs(width - wide) <= SWAY_M + 0.4 * wide:
            return f"sways over {width:.1f} m, in the reference world over {wide:.1f} m"
        swings, should = _swings(across), _swings(expected)
    else:
        return ""
    if not abs(swings - should) <= SWINGS * should:
        return f"swings {swings:.1f} times in the time of {should:.1f} in the reference world"
    return ""


def _places(tracks: Tracks, road: Corridor) -> NDArray[np.float64]:
    """Return the first actor's places across the road in all steps, m."""
    return np.array([road.locate(float(x), float(y))[1] for x, y in tracks.poses[:, 1, :2]])


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
