"""Part about what is derived from poses: dynamics play no part in it, so tolerances are small."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from oodscen.data._scene import Actor, Scene
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._staged_scene import StagedScene
from oodscen.driving._states import check_observation
from oodscen.errors import OodscenError
from oodscen.protocols import Control, Observation, State
from oodscen.testing._kit.contact import gap_fault
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import constantly, follow_lane
from oodscen.testing._kit.shapes import state_faults

PLACE_M = 0.05
"""Tolerance of s, t and offsets, m."""
ACCELERATION = 0.5
"""Tolerance of accelerations against the change of speed in a step, m/s^2."""
SPEED = 0.5
"""Tolerance of speeds against the distance covered in half a second, m/s; and a tenth of the speed."""
YAW_DEG = 20.0
"""Tolerance of the ego's yaw against its direction of travel, degrees."""
WHEELBASE = 0.2
"""Relative tolerance of the wheelbase that the ego's turning implies."""
AFLOAT_M = 0.3
"""Tolerance of heights above the road, m."""

_OBSERVED = {
    "speed": 0.01,
    "offset_m": PLACE_M,
    "heading_error": 0.02,
    "curvature": 0.003,
    "lane_left_m": 0.2,
    "lane_right_m": 0.2,
    "roadside_m": 0.3,
    "friction": 0.01,
    "visual_range_m": 1.0,
    "curve_speed": 1.0,
}
"""Tolerances of the observation."""
_WINDOW_S = 0.5
"""Time over which speeds are compared with the distance covered, s."""
_EDGE_M = 0.3
"""Distance to a lane's edge within which its neighbours are ambiguous, m."""


def check_measures(probe: Probe) -> None:
    """Check gaps, places, accelerations, speeds, yaw, height, leaving the road and the observation."""
    _check_run(probe, _busy(probe), _weave, "driving between others")
    for steering, side in ((-0.1, "right"), (0.1, "left")):
        leave = constantly(Control(0.0, steering))
        _check_run(probe, probe.scene(speed=8.0), leave, f"leaving the road to the {side}")
    road = max(probe.catalogue.maps, key=lambda road: _sharpest_bend(load_corridor(road)))
    scene = probe.scene(road=road, lane=road.lanes - 1, speed=min(10.0, road.speed_limit))
    _check_run(probe, scene, follow_lane, f"following {road.id}")
    _check_wheelbase(probe)


def _sharpest_bend(road: Corridor) -> float:
    """Return the greatest curvature in the 100 m ahead of the ego's start, 1/m."""
    is_near = (road.s >= road.start) & (road.s <= road.start + 100.0)
    return float(np.abs(road.curvature[is_near]).max(initial=0.0))


def _busy(probe: Probe) -> Scene:
    """Return a scene with bodies on both sides of the road, or with one if the simulator refuses that."""
    actors: list[Actor] = []
    for index, asset in enumerate(probe.catalogue.assets[:4]):
        offset_m = 3.5 if index % 2 else -3.5
        ahead_m = 22.0 + 16.0 * index
        actors.append(
            probe.still(asset, id=f"s{index}", ahead=ahead_m, offset=offset_m, heading=30.0)
        )
    for name in ("follow_lane", "cross_road"):
        try:
            actors.append(probe.doing(name, id=name.replace("_", "-"), ahead=14.0))
            break
        except NotApplicable:
            continue
    scene = probe.scene(*actors, road=probe.widest, speed=9.0)
    try:
        probe.simulator.reset(scene, 0)
    except OodscenError:
        return probe.scene(probe.still(probe.catalogue.assets[0], ahead=25.0, offset=0.4))
    return scene


def _weave(observation: Observation) -> Control:
    acceleration = -2.0 if observation.time > 2.0 else 0.3
    steering = 0.03 if math.sin(3.0 * observation.time) > 0.0 else -0.03
    return Control(acceleration, steering)


def _check_run(
    probe: Probe, scene: Scene, control: Callable[[Observation], Control], subject: str
) -> None:
    """Run a scene for 5 s and check all measures in its states and observations."""
    dt, findings = probe.simulator.dt, probe.findings
    states: list[State] = []
    observations: list[Observation] = []
    with findings.trying(subject):
        for state in probe.states(scene, control, steps=round(5.0 / dt)):
            for fault in state_faults(scene, state, len(states), dt):
                findings.add(subject, fault)
                return
            states.append(state)
            observations.append(_observe(probe))
        staged = probe.staged(scene)
        for fault in (
            gap_fault(states, scene, probe.catalogue),
            _place_fault(staged, states),
            _acceleration_fault(states, dt),
            _speed_fault(scene, states, dt),
            _height_fault(staged, states),
            _off_road_fault(staged, states),
            *_observation_faults(staged, states, observations),
        ):
            findings.expect(not fault, subject, fault)


def _observe(probe: Probe) -> Observation:
    """Return the simulator's observation, or raise a `SimulatorError` that names a member of a wrong type."""
    observation = probe.simulator.observe()
    check_observation(observation, "observe()")
    return observation


def _largest(errors: NDArray[np.float64]) -> tuple[int, ...]:
    """Return the index of the largest error; NaN is larger than any number."""
    index = int(np.where(np.isnan(errors), np.inf, errors).argmax())
    return tuple(map(int, np.unravel_index(index, errors.shape)))


def _place_fault(staged: StagedScene, states: Sequence[State]) -> str:
    for state in states:
        if state.places is None:
            continue
        expected = staged.places(state.poses)
        errors = np.abs(expected - state.places)
        row, column = _largest(errors)
        if not errors[row, column] <= PLACE_M:
            return (
                f"places: {'st'[column]} of {state.ids[row]!r} is {state.places[row, column]:.2f} m, by "
                f"its pose {expected[row, column]:.2f} m"
            )
    return ""


def _acceleration_fault(states: Sequence[State], dt: float) -> str:
    for before, state in pairwise(states[1:]):
        if state.accelerations is None:
            continue
        expected = (state.speeds - before.speeds) / dt
        errors = np.abs(state.accelerations - expected)
        (row,) = _largest(errors)
        if not errors[row] <= ACCELERATION:
            return (
                f"accelerations: {state.accelerations[row]:.2f} m/s^2 for {state.ids[row]!r}, by its "
                f"change of speed {expected[row]:.2f}"
            )
    return ""


def _speed_fault(scene: Scene, states: Sequence[State], dt: float) -> str:
    """Compare speeds with the motion along the heading, and headings with the direction of travel.

    Of the actors, only those that follow their lane or stand are compared.
    """
    window = max(1, round(_WINDOW_S / dt))
    may_slide = {actor.id for actor in scene.actors if actor.behaviour.name != "follow_lane"}
    for first, last in zip(states, states[window:], strict=False):
        reported = np.mean([state.speeds for state in states[first.step : last.step + 1]], axis=0)
        for row, name in enumerate(first.ids):
            start, end = first.poses[row], last.poses[row]
            if name in may_slide and not np.allclose(start, end):
                continue
            if abs(start[3] - end[3]) > math.pi:
                continue
            yaw = 0.5 * (start[3] + end[3])
            velocity = (end[:2] - start[:2]) / (window * dt)
            along = float(velocity @ (math.cos(yaw), math.sin(yaw)))
            across = float(velocity @ (-math.sin(yaw), math.cos(yaw)))
            if abs(along) > 2.0 and abs(math.degrees(math.atan2(across, abs(along)))) > YAW_DEG:
                turn_deg = math.degrees(math.atan2(across, along))
                return f"the yaw of {name!r} is {turn_deg:.0f} degrees from its direction of travel"
            speed = float(reported[row])
            if not abs(along - speed) <= SPEED + 0.1 * abs(speed):
                return (
                    f"speeds: {speed:.1f} m/s for {name!r}, which covers {along:.1f} m in a second"
                )
    return ""


def _height_fault(staged: StagedScene, states: Sequence[State]) -> str:
    """Compare the heights at the start and at the end with the road's."""
    for state in (states[0], states[-1]):
        for row, (x, y, z, _) in enumerate(state.poses.tolist()):
            ground = staged.corridor.point(*staged.corridor.locate(x, y))[2]
            if abs(z - ground) > AFLOAT_M:
                side = "above" if z > ground else "below"
                return f"{state.ids[row]!r} is {abs(z - ground):.2f} m {side} the road"
    return ""


def _off_road_fault(staged: StagedScene, states: Sequence[State]) -> str:
    """Compare with the library's measure, except within a step of a change."""
    expected = [staged.off_road(state.poses) for state in states]
    for index, state in enumerate(states[:-1]):
        around = set(expected[max(0, index - 1) : index + 2])
        if len(around) == 1 and state.off_road not in around:
            words = "True on" if state.off_road else "False beside"
            return f"off_road is {words} the road at {state.time:.2f} s"
    return ""


def _observation_faults(
    staged: StagedScene, states: Sequence[State], observations: Sequence[Observation]
) -> list[str]:
    """Return the observation's members that differ from the library's, each once."""
    faults: dict[str, str] = {}
    for state, observation in zip(states, observations, strict=True):
        expected = staged.observation(state)
        is_at_edge = _is_at_edge(staged, state)
        for name, tolerance in _OBSERVED.items():
            if name in faults or (is_at_edge and name in ("lane_left_m", "lane_right_m")):
                continue
            pair = (getattr(observation, name), getattr(expected, name))
            if not _agree(*pair, tolerance, 0.1 if name == "curve_speed" else 0.0):
                shown = ["None" if value is None else f"{value:.3f}" for value in pair]
                faults[name] = f"observation: {name} is {shown[0]}, by the state {shown[1]}"
    return list(faults.values())


def _agree(
    observed: float | None, expected: float | None, absolute: float, relative: float
) -> bool:
    """Return whether two values, which may be missing, agree within tolerances."""
    if observed is None or expected is None:
        return observed is expected
    return abs(observed - expected) <= absolute + relative * abs(expected)


def _is_at_edge(staged: StagedScene, state: State) -> bool:
    """Return whether the ego's centre is so near a lane's edge that its neighbours are ambiguous."""
    s, t = map(float, staged.places(state.poses)[0])
    road = staged.corridor
    edges = [edge for strip in road.driving for edge in road.edges(strip, s)]
    return min(abs(edge - t) for edge in edges) < _EDGE_M


def _check_wheelbase(probe: Probe) -> None:
    """Compare the observed wheelbase with the one that the ego's turning at low speed implies."""
    steering = 0.15
    scene, dt = probe.scene(speed=4.0), probe.simulator.dt
    states = probe.run(scene, constantly(Control(0.0, steering)), steps=round(1.5 / dt))
    for step, state in enumerate(states):
        for fault in state_faults(scene, state, step, dt):
            probe.findings.add("steering left", fault)
            return
    poses = np.stack([state.poses[0] for state in states[len(states) // 2 :]])
    turn = math.remainder(float(poses[-1, 3] - poses[0, 3]), math.tau)
    covered_m = float(np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1).sum())
    if turn <= 1e-3 or covered_m <= 1e-3:
        probe.findings.add("", "the ego does not turn left when it steers left")
        return
    implied = 2.0 * math.sin(math.atan(0.5 * math.tan(steering))) * covered_m / turn
    observed = _observe(probe).wheelbase
    if not abs(observed - implied) <= WHEELBASE * implied:
        message = (
            f"observation: wheelbase is {observed:.2f} m, but the ego turns as with {implied:.2f} m"
        )
        probe.findings.add("", message)
