"""Part about what is derived from poses: it does not depend on anybody's dynamics, so tolerances are small."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from oodscen.data._scene import Actor, Scene
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._staged_scene import StagedScene
from oodscen.protocols import Control, Observation, State
from oodscen.testing._kit.contact import gap_fault
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import constantly, follow_lane
from oodscen.testing._kit.shapes import state_faults

Drive = Callable[[Observation], Control]

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
_EDGE_M = 0.3
"""Distance to a lane's edge within which its neighbours are ambiguous, m."""


def check_measures(probe: Probe) -> None:
    """Check gaps, places, accelerations, speeds, yaw, height, leaving the road and the observation."""
    _check_run(probe, _busy(probe), _weave, "driving between others")
    for steering, side in ((-0.1, "right"), (0.1, "left")):
        leave = constantly(Control(0.0, steering))
        _check_run(probe, probe.scene(speed=8.0), leave, f"leaving the road to the {side}")
    bent = max(probe.catalogue.maps, key=lambda road: _bend(load_corridor(road)))
    scene = probe.scene(road=bent, lane=bent.lanes - 1, speed=min(10.0, bent.speed_limit))
    _check_run(probe, scene, follow_lane, f"following {bent.id}")
    _check_wheelbase(probe)


def _bend(road: Corridor) -> float:
    near = (road.s >= road.start) & (road.s <= road.start + 100.0)
    return float(np.abs(road.curvature[near]).max(initial=0.0))


def _busy(probe: Probe) -> Scene:
    """Return a scene with several bodies to measure, some to the left and some to the right."""
    actors: list[Actor] = []
    for index, asset in enumerate(probe.catalogue.assets[:4]):
        side = 3.5 if index % 2 else -3.5
        actors.append(
            probe.still(asset, id=f"s{index}", ahead=22.0 + 16.0 * index, offset=side, heading=30.0)
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
    except Exception:
        return probe.scene(probe.still(probe.catalogue.assets[0], ahead=25.0, offset=0.4))
    return scene


def _weave(observation: Observation) -> Control:
    slow = -2.0 if observation.time > 2.0 else 0.3
    return Control(slow, 0.03 if math.sin(3.0 * observation.time) > 0.0 else -0.03)


def _check_run(probe: Probe, scene: Scene, control: Drive, what: str) -> None:
    steps = round(5.0 / probe.simulator.dt)
    staged, findings = probe.staged(scene), probe.findings
    states: list[State] = []
    seen: list[Observation] = []
    for state in probe.states(scene, control, steps=steps):
        for fault in state_faults(scene, state, len(states), probe.simulator.dt):
            findings.add(what, fault)
            return
        states.append(state)
        seen.append(probe.simulator.observe())
    fault = gap_fault(states, scene, probe.catalogue)
    findings.expect(not fault, what, fault)
    for one in (
        _places(staged, states),
        _accelerations(states, probe.simulator.dt),
        _speeds(scene, states, probe.simulator.dt),
        _heights(staged, states),
        _off_road(staged, states),
        *_observations(staged, states, seen),
    ):
        findings.expect(not one, what, one)


def _places(staged: StagedScene, states: Sequence[State]) -> str:
    for state in states:
        if state.places is None:
            return ""
        apart = np.abs(staged.places(state.poses) - state.places)
        if not apart.max() <= PLACE_M:
            row, column = np.unravel_index(int(np.nanargmax(apart)), apart.shape)
            return (
                f"places: {'st'[column]} of {state.ids[row]!r} is {state.places[row, column]:.2f} m, by "
                f"its pose {staged.places(state.poses)[row, column]:.2f} m"
            )
    return ""


def _accelerations(states: Sequence[State], dt: float) -> str:
    for before, state in pairwise(states[1:]):
        if state.accelerations is None:
            return ""
        wanted = (state.speeds - before.speeds) / dt
        apart = np.abs(state.accelerations - wanted)
        if not apart.max() <= ACCELERATION:
            row = int(np.nanargmax(apart))
            return (
                f"accelerations: {state.accelerations[row]:.2f} m/s^2 for {state.ids[row]!r}, by its "
                f"change of speed {wanted[row]:.2f}"
            )
    return ""


def _speeds(scene: Scene, states: Sequence[State], dt: float) -> str:
    """Compare speeds with the way along the heading, and the ego's yaw with its direction of travel."""
    window = max(1, round(_WINDOW_S / dt))
    apart = {actor.id for actor in scene.actors if actor.behaviour.name != "follow_lane"}
    for first, last in zip(states, states[window:], strict=False):
        part = states[first.step : last.step + 1]
        for row, name in enumerate(first.ids):
            if name in apart and not np.allclose(first.poses[row], last.poses[row]):
                continue
            yaw = 0.5 * (first.poses[row, 3] + last.poses[row, 3])
            if abs(first.poses[row, 3] - last.poses[row, 3]) > math.pi:
                continue
            way = last.poses[row, :2] - first.poses[row, :2]
            along = float(way @ (math.cos(yaw), math.sin(yaw))) / (window * dt)
            across = float(way @ (-math.sin(yaw), math.cos(yaw))) / (window * dt)
            told = float(np.mean([state.speeds[row] for state in part]))
            if abs(along) > 2.0 and abs(math.degrees(math.atan2(across, abs(along)))) > YAW_DEG:
                turn = math.degrees(math.atan2(across, along))
                return f"the yaw of {name!r} is {turn:.0f} degrees from its direction of travel"
            if not abs(along - told) <= SPEED + 0.1 * abs(told):
                return (
                    f"speeds: {told:.1f} m/s for {name!r}, which covers {along:.1f} m in a second"
                )
    return ""


def _heights(staged: StagedScene, states: Sequence[State]) -> str:
    for state in (states[0], states[-1]):
        for row, (x, y, z, _) in enumerate(state.poses.tolist()):
            ground = staged.corridor.point(*staged.corridor.locate(x, y))[2]
            if abs(z - ground) > AFLOAT_M:
                return f"{state.ids[row]!r} is {z - ground:.2f} m above the road"
    return ""


def _off_road(staged: StagedScene, states: Sequence[State]) -> str:
    """Compare with the library's measure, except within a step of a change."""
    wanted = [staged.off_road(state.poses) for state in states]
    for index in range(1, len(states) - 1):
        near = wanted[index - 1 : index + 2]
        if all(one == near[0] for one in near) and states[index].off_road != near[0]:
            words = "False beside" if near[0] else "True on"
            return f"off_road is {words} the road at {states[index].time:.2f} s"
    return ""


def _observations(
    staged: StagedScene, states: Sequence[State], seen: Sequence[Observation]
) -> list[str]:
    """Return the observation's members that differ from the library's, each once."""
    faults: dict[str, str] = {}
    for state, observation in zip(states, seen, strict=True):
        wanted = staged.observation(state)
        for name, tolerance in _OBSERVED.items():
            one, other = getattr(observation, name), getattr(wanted, name)
            if name in faults or (
                name in ("lane_left_m", "lane_right_m") and _is_at_edge(staged, state)
            ):
                continue
            if one is None and other is None:
                continue
            relative = 0.1 * abs(other) if other is not None and name == "curve_speed" else 0.0
            if one is None or other is None or not abs(one - other) <= tolerance + relative:
                shown = [f"{value:.3f}" if value is not None else "None" for value in (one, other)]
                faults[name] = f"observation: {name} is {shown[0]}, by the state {shown[1]}"
    return list(faults.values())


def _is_at_edge(staged: StagedScene, state: State) -> bool:
    s, t = staged.places(state.poses)[0]
    road = staged.corridor
    edges = [edge for strip in road.driving for edge in road.edges(strip, float(s))]
    return min(abs(edge - float(t)) for edge in edges) < _EDGE_M


def _check_wheelbase(probe: Probe) -> None:
    """Compare the observed wheelbase with the one that the ego's turning at low speed implies."""
    steering = 0.15
    turning, steps = constantly(Control(0.0, steering)), round(1.5 / probe.simulator.dt)
    states = probe.run(probe.scene(speed=4.0), turning, steps=steps)
    half = len(states) // 2
    turn = math.remainder(float(states[-1].poses[0, 3] - states[half].poses[0, 3]), math.tau)
    way = sum(math.dist(a.poses[0, :2], b.poses[0, :2]) for a, b in pairwise(states[half:]))
    if turn <= 1e-3 or way <= 1e-3:
        probe.findings.add("", "the ego does not turn when it steers left")
        return
    implied = 2.0 * math.sin(math.atan(0.5 * math.tan(steering))) * way / turn
    told = probe.simulator.observe().wheelbase
    if not abs(told - implied) <= WHEELBASE * implied:
        message = (
            f"observation: wheelbase is {told:.2f} m, but the ego turns as with {implied:.2f} m"
        )
        probe.findings.add("", message)
