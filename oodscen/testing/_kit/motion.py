"""Part about motion: ego and actors move as the reference world moves them, within stated tolerances.

The reference is `oodscen.driving.KinematicWorld`, under the same controls. Simulators with dynamics of their own
differ from it, and may; they must not differ by what changes the meaning of a scene.
"""

import math
from typing import NamedTuple

import numpy as np

from oodscen.data._catalogue import BehaviourKind, RoadMap
from oodscen.data._scene import Scene, Trigger
from oodscen.driving._motion.behaviours import BUILT_IN, DRIVES_IN_LANE, having
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.placement import staging_issues
from oodscen.protocols import Control
from oodscen.testing._kit.ego_motion import check_contact, check_ego, check_grip
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.lane_changes import check_lane_changes
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.reactions import check_reactions, check_triggers
from oodscen.testing._kit.samples import constantly
from oodscen.testing._kit.tracks import SECONDS, START_M, Tracks, run_both, start_fault, turned_by
from oodscen.testing._kit.vocabulary import assets_for, cast_for

ALONG_M = 2.0
"""Tolerance along the road, m; and a quarter of the way since the start."""
ACROSS_M = 1.0
"""Tolerance across the road, m; behaviours with chance in them get twice their amplitude in addition."""
HEADING_DEG = 30.0
"""Tolerance of a moving actor's heading, degrees."""
SPEED = 1.5
"""Tolerance of speeds, m/s; and a quarter of the reference's."""
_SECONDS = 3.5
"""Length of the run in which a behaviour is compared, s."""
_CHANCE = ("amplitude", "radius", "lift")
"""Parameters that bound how far chance moves an actor, m."""
_LOOSE = having(lambda row: row.has_chance or row.needs_other)
"""Behaviours whose headings and momentary speeds differ with chance or with the body that they belong to."""
_CALM = 2.0
"""Acceleration towards the inside of a bend that no driver minds, m/s^2."""
_FASTEST = 14.0
"""Greatest speed in a bend, m/s."""
_LEAST_BEND = 1e-9
"""Least curvature by which an acceleration is divided, 1/m."""


def check_motion(probe: Probe) -> None:
    """Check starts, controls, behaviours, triggers, lane changes, reactions and contacts against the reference world."""
    findings = probe.findings
    notes = []
    for name, part in (
        ("starts", _check_starts),
        ("ego", check_ego),
        ("grip", check_grip),
        ("triggers", check_triggers),
        ("bends", _check_bends),
        ("lane changes", check_lane_changes),
        ("reactions", check_reactions),
        ("contact", check_contact),
    ):
        with findings.trying(name):
            try:
                part(probe)
            except NotApplicable as reason:
                notes.append(f"{name} not tried, {reason}")
    own = [kind.id for kind in probe.catalogue.behaviours if kind.id not in BUILT_IN]
    if own:
        notes.append(
            f"of the simulator's own behaviours only starts are compared: {', '.join(own)}"
        )
    findings.note = "; ".join(notes)
    for kind in probe.catalogue.behaviours:
        with findings.trying(f"behaviour {kind.id}"):
            _check_behaviour(probe, kind)


def _check_starts(probe: Probe) -> None:
    """Check that standing bodies are where the scene places them, on both sides and at any angle."""
    firsts = {asset.category: asset for asset in reversed(probe.catalogue.assets)}
    actors = [
        probe.still(
            asset, id=f"s{index}", ahead=15.0 + 14.0 * index, offset=offset, heading=heading
        )
        for index, (asset, offset, heading) in enumerate(
            zip(firsts.values(), (1.6, -1.2, 0.8, -0.4), (25.0, -60.0, 160.0, -10.0), strict=False)
        )
    ]
    scene = probe.scene(*actors, road=probe.widest, lane=probe.widest.lanes - 1)
    tracks, reference = run_both(probe, scene, constantly(Control()), seconds=1.0)
    for row, actor in enumerate(actors, start=1):
        fault = start_fault(tracks, reference, row)
        probe.findings.expect(
            not fault, f"actor {actor.asset} at {actor.placement.offset_m:g} m", fault
        )
        moved_m = float(np.linalg.norm(tracks.poses[-1, row, :2] - tracks.poses[0, row, :2]))
        probe.findings.expect(
            moved_m < START_M, f"actor {actor.asset}", "moves though it should stand"
        )


def _check_behaviour(probe: Probe, kind: BehaviourKind) -> None:
    """Compare the motion of a behaviour's actor in the ego's lane and in an oncoming one.

    Of a simulator's own behaviour only the start is known: the built-in one that it is `like` stands in for it
    where no simulator runs, and may go on in another way.
    """
    lanes = [0]
    if probe.widest.oncoming_lanes and not kind.needs_other:
        lanes.append(probe.widest.lanes)
    for asset in assets_for(probe, kind)[:1]:
        for lane in lanes:
            actors = cast_for(probe, kind, asset, lane=lane, ahead=90.0 if lane else 35.0)
            if actors is None:
                return
            first, *others = actors
            parameters = {**_slower(kind), **first.behaviour.parameters}
            if lane and "lanes" in parameters:
                parameters["lanes"] = 0.0
            behaviour = first.behaviour.model_copy(
                update={"parameters": parameters, "trigger": Trigger(value=1.0)}
            )
            actor = first.model_copy(update={"behaviour": behaviour})
            scene = probe.scene(actor, *others, road=probe.widest, speed=5.0)
            if not staging_issues(scene, probe.catalogue):
                where = " in an oncoming lane" if lane else ""
                _compare(probe, scene, kind, f"behaviour {kind.id}{where}")


def _check_bends(probe: Probe) -> None:
    """Compare drivers in a bend with the reference world's, in the ego's lane and in an oncoming one.

    Raises:
        NotApplicable: If no map bends, or no behaviour drives along its lane.
    """
    bend = _sharpest_bend(probe)
    road = bend.road
    calm_speed = math.sqrt(_CALM / max(bend.curvature, _LEAST_BEND))
    speed = min(0.8 * road.speed_limit, calm_speed, _FASTEST)
    if 0.5 * bend.curvature * (speed * SECONDS) ** 2 < 2.0 * ACROSS_M:
        raise NotApplicable("no map has a bend within 150 m of the ego's start")
    names = [kind.id for kind in probe.catalogue.behaviours if kind.id in DRIVES_IN_LANE]
    if not names:
        raise NotApplicable("no behaviour drives along its lane")
    sides = [("", 0, -1.0)]
    if road.oncoming_lanes:
        sides.append((" in an oncoming lane", road.lanes, 1.0))
    for name in names:
        for words, lane, side in sides:
            kind = probe.catalogue.behaviour(name)
            actor = probe.doing(
                name,
                ahead=bend.ahead_m + side * 15.0,
                lane=lane,
                trigger=Trigger(value=2.0 * SECONDS),
                parameters={
                    parameter: value
                    for parameter, value in (("speed", speed), ("lanes", 0.0))
                    if parameter in kind.parameters
                },
            )
            scene = probe.scene(actor, road=road, speed=2.0)
            if not staging_issues(scene, probe.catalogue):
                _compare(probe, scene, kind, f"behaviour {name} in a bend{words}", SECONDS)


class _Bend(NamedTuple):
    """The sharpest point of a map near the ego's start."""

    curvature: float
    """1/m"""
    ahead_m: float
    road: RoadMap


def _sharpest_bend(probe: Probe) -> _Bend:
    """Return the sharpest bend of all maps, at least 30 m ahead of the ego.

    Bends tighter than 30 m, as on a roundabout, are left out.

    Raises:
        NotApplicable: If there is no other.
    """
    bends = []
    for road in probe.catalogue.maps:
        corridor = load_corridor(road, probe.catalogue)
        is_near = (corridor.s > corridor.start + 20.0) & (corridor.s < corridor.start + 150.0)
        curvatures = np.where(is_near, abs(corridor.curvature), 0.0)
        index = int(curvatures.argmax())
        if curvatures[index] < 1.0 / 30.0:
            ahead_m = max(float(corridor.s[index] - corridor.start), 30.0)
            bends.append(_Bend(float(curvatures[index]), ahead_m, road))
    if not bends:
        raise NotApplicable("every map has a tight turn near the ego's start")
    return max(bends, key=lambda bend: bend.curvature)


def _slower(kind: BehaviourKind) -> dict[str, float]:
    """Return a parameter for a lower speed than the default, if the behaviour has one."""
    speed = kind.parameters.get("speed")
    if speed is None:
        return {}
    return {"speed": min(max(0.7 * speed.default, speed.minimum), speed.maximum)}


def _compare(
    probe: Probe, scene: Scene, kind: BehaviourKind, subject: str, seconds: float = _SECONDS
) -> None:
    """Compare the motion of a scene's first actor, or only its start if no built-in moves it."""
    tracks, reference = run_both(probe, scene, constantly(Control()), seconds=seconds)
    fault = start_fault(tracks, reference, 1)
    probe.findings.expect(not fault, subject, fault)
    if fault or kind.id not in BUILT_IN:
        return
    defaults = {name: parameter.default for name, parameter in kind.parameters.items()}
    parameters = {**defaults, **scene.actors[0].behaviour.parameters}
    chance_m = 2.0 * sum(abs(parameters.get(name, 0.0)) for name in _CHANCE)
    road = load_corridor(scene.map, probe.catalogue)
    covered_m = 0.0
    for step in range(1, len(tracks.poses)):
        covered_m += abs(float(reference.speeds[step, 1])) * tracks.dt
        tolerances_m = (ALONG_M + 0.25 * covered_m + chance_m, ACROSS_M + chance_m)
        fault = _place_fault(tracks, reference, step, road, tolerances_m)
        if not fault and kind.id not in _LOOSE:
            fault = _motion_fault(tracks, reference, step)
        if fault:
            probe.findings.add(subject, f"{fault} after {step * tracks.dt:.1f} s")
            return


def _place_fault(
    tracks: Tracks, reference: Tracks, step: int, road: Corridor, tolerances_m: tuple[float, float]
) -> str:
    """Return how an actor's place in one step differs from the reference world's, along or across the road."""
    pose, expected = tracks.poses[step, 1], reference.poses[step, 1]
    yaw = road.heading(road.locate(float(expected[0]), float(expected[1]))[0])
    dx, dy = (pose[:2] - expected[:2]).tolist()
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
    """Return how an actor's speed or heading in one step differs from the reference world's."""
    speed, expected = float(tracks.speeds[step, 1]), float(reference.speeds[step, 1])
    if not abs(speed - expected) <= SPEED + 0.25 * abs(expected):
        return f"has {speed:.1f} m/s, in the reference world {expected:.1f}"
    turn_deg = turned_by(float(tracks.poses[step, 1, 3]), float(reference.poses[step, 1, 3]))
    if abs(expected) > 1.0 and not abs(turn_deg) <= HEADING_DEG:
        return f"is turned by {turn_deg:.0f} degrees against the reference world"
    return ""
