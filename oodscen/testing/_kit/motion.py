"""Part about motion: ego and actors move as the reference world moves them, within stated tolerances.

The reference is `oodscen.driving.KinematicWorld`, under the same controls. Simulators with dynamics of their own
differ from it, and may; they must not differ by what changes the meaning of a scene.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from oodscen.data._catalogue import BehaviourKind, RoadMap
from oodscen.data._scene import Scene, Trigger
from oodscen.driving._motion.behaviours import BUILT_IN, DRIVES_IN_LANE, having
from oodscen.driving._motion.boxes import Footprint, gap
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.placement import staging_issues
from oodscen.errors import OodscenError
from oodscen.protocols import Control
from oodscen.testing._kit.ego_motion import check_contact, check_ego, check_grip
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
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
ONSET_S = 0.35
"""Tolerance of the time at which a trigger shows in an actor's motion, s."""
_LAST_S = 3.5
_CHANCE = ("amplitude", "radius", "lift")
_LOOSE = having(lambda row: row.has_chance or row.needs_other)
"""Behaviours whose headings and momentary speeds differ with chance or with the body that they belong to."""
_CALM = 2.0
"""Acceleration towards the inside of a bend that no driver minds, m/s^2."""
_FASTEST = 14.0
"""Greatest speed in a bend, m/s."""
_WAITING = "cross_road pull_out dart bolt walk_along roll_away reverse hard_brake stall halt cut_in".split()
"""Behaviours that show when their trigger fires, best first."""
_LEAST_BEND = 1e-9
"""Least curvature by which an acceleration is divided, 1/m."""


def check_motion(probe: Probe) -> None:
    """Check starts, controls, behaviours, triggers, reactions and contacts against the reference world."""
    findings = probe.findings
    notes = []
    for name, part in (
        ("starts", _check_starts),
        ("ego", check_ego),
        ("grip", check_grip),
        ("triggers", _check_triggers),
        ("bends", _check_bends),
        ("reactions", _check_reactions),
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
    kinds = {asset.category: asset for asset in reversed(probe.catalogue.assets)}
    actors = [
        probe.still(
            asset, id=f"s{index}", ahead=15.0 + 14.0 * index, offset=offset, heading=heading
        )
        for index, (asset, offset, heading) in enumerate(
            zip(kinds.values(), (1.6, -1.2, 0.8, -0.4), (25.0, -60.0, 160.0, -10.0), strict=False)
        )
    ]
    scene = probe.scene(*actors, road=probe.widest, lane=probe.widest.lanes - 1)
    tracks, other = run_both(probe, scene, constantly(Control()), seconds=1.0)
    for row, actor in enumerate(actors, start=1):
        fault = start_fault(tracks, other, row)
        probe.findings.expect(
            not fault, f"actor {actor.asset} at {actor.placement.offset_m:g} m", fault
        )
        way = float(np.linalg.norm(tracks.poses[-1, row, :2] - tracks.poses[0, row, :2]))
        probe.findings.expect(way < START_M, f"actor {actor.asset}", "moves though it should stand")


# ------------------------------------------------------------------ actors


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
            update = {"parameters": parameters, "trigger": Trigger(value=1.0)}
            does = first.behaviour.model_copy(update=update)
            actor = first.model_copy(update={"behaviour": does})
            scene = probe.scene(actor, *others, road=probe.widest, speed=5.0)
            if not staging_issues(scene, probe.catalogue):
                where = " in an oncoming lane" if lane else ""
                _compare(probe, scene, kind, f"behaviour {kind.id}{where}")


def _check_bends(probe: Probe) -> None:
    """Compare drivers in a bend with the reference world's, in the ego's lane and in an oncoming one.

    Raises:
        NotApplicable: If no map bends, or no behaviour drives along its lane.
    """
    road, at, sharpness = _sharpest(probe)
    speed = min(0.8 * road.speed_limit, math.sqrt(_CALM / max(sharpness, _LEAST_BEND)), _FASTEST)
    if 0.5 * sharpness * (speed * SECONDS) ** 2 < 2.0 * ACROSS_M:
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
            wanted = {"speed": speed, "lanes": 0.0}
            actor = probe.doing(
                name,
                ahead=at + side * 15.0,
                lane=lane,
                trigger=Trigger(value=2.0 * SECONDS),
                parameters={one: wanted[one] for one in wanted if one in kind.parameters},
            )
            scene = probe.scene(actor, road=road, speed=2.0)
            if not staging_issues(scene, probe.catalogue):
                _compare(probe, scene, kind, f"behaviour {name} in a bend{words}", SECONDS)


def _sharpest(probe: Probe) -> tuple[RoadMap, float, float]:
    """Return the map with the sharpest bend near the ego's start, its distance ahead in m, and its curvature in 1/m.

    Bends tighter than 30 m, as on a roundabout, are left out.
    """
    found = []
    for road in probe.catalogue.maps:
        corridor = load_corridor(road, probe.catalogue)
        near = (corridor.s > corridor.start + 20.0) & (corridor.s < corridor.start + 150.0)
        bends = np.where(near, abs(corridor.curvature), 0.0)
        place = int(bends.argmax())
        if bends[place] < 1.0 / 30.0:
            found.append((float(bends[place]), float(corridor.s[place] - corridor.start), road))
    if not found:
        raise NotApplicable("every map has a tight turn near the ego's start")
    sharpness, at, road = max(found, key=lambda one: one[0])
    return road, max(at, 30.0), sharpness


def _slower(kind: BehaviourKind) -> dict[str, float]:
    """Return a speed other than the default, to see that it is heeded."""
    speed = kind.parameters.get("speed")
    if speed is None:
        return {}
    return {"speed": min(max(0.7 * speed.default, speed.minimum), speed.maximum)}


def _compare(
    probe: Probe, scene: Scene, kind: BehaviourKind, what: str, seconds: float = _LAST_S
) -> None:
    tracks, other = run_both(probe, scene, constantly(Control()), seconds=seconds)
    start = start_fault(tracks, other, 1)
    probe.findings.expect(not start, what, start)
    if start or kind.id not in BUILT_IN:
        return
    actor = scene.actors[0]
    defaults = {name: each.default for name, each in kind.parameters.items()}
    given = {**defaults, **actor.behaviour.parameters}
    chance = 2.0 * sum(abs(given.get(name, 0.0)) for name in _CHANCE)
    road = load_corridor(scene.map, probe.catalogue)
    way = 0.0
    for step in range(1, len(tracks.poses)):
        way += abs(float(other.speeds[step, 1])) * tracks.dt
        fault = _place_fault(
            tracks, other, step, road, (ALONG_M + 0.25 * way + chance, ACROSS_M + chance)
        )
        if not fault and kind.id not in _LOOSE:
            fault = _motion_fault(tracks, other, step)
        if fault:
            probe.findings.add(what, f"{fault} after {step * tracks.dt:.1f} s")
            return


def _place_fault(
    one: Tracks, other: Tracks, step: int, road: Corridor, tolerances: tuple[float, float]
) -> str:
    """Return how an actor's place in one step differs from the reference world's, along or across the road."""
    told, wanted = one.poses[step, 1], other.poses[step, 1]
    yaw = road.heading(road.locate(float(wanted[0]), float(wanted[1]))[0])
    dx, dy = (told[:2] - wanted[:2]).tolist()
    along = dx * math.cos(yaw) + dy * math.sin(yaw)
    across = dy * math.cos(yaw) - dx * math.sin(yaw)
    if not abs(along) <= tolerances[0]:
        return f"is {abs(along):.1f} m further {'on' if along > 0.0 else 'back'} than in the reference world"
    if not abs(across) <= tolerances[1]:
        side = "left" if across > 0.0 else "right"
        return f"is {abs(across):.1f} m further {side} than in the reference world"
    return ""


def _motion_fault(one: Tracks, other: Tracks, step: int) -> str:
    """Return how an actor's speed or heading in one step differs from the reference world's."""
    speed, right = float(one.speeds[step, 1]), float(other.speeds[step, 1])
    if not abs(speed - right) <= SPEED + 0.25 * abs(right):
        return f"has {speed:.1f} m/s, in the reference world {right:.1f}"
    turn = turned_by(float(one.poses[step, 1, 3]), float(other.poses[step, 1, 3]))
    if abs(right) > 1.0 and not abs(turn) <= HEADING_DEG:
        return f"is turned by {turn:.0f} degrees against the reference world"
    return ""


# ------------------------------------------------------------------ triggers and reactions


def _check_triggers(probe: Probe) -> None:
    """Compare when actors act on triggers by time, distance and time to collision."""
    known = {kind.id for kind in probe.catalogue.behaviours}
    name = next((name for name in _WAITING if name in known), None)
    if name is None:
        raise NotApplicable("no behaviour waits for its trigger")
    for trigger in (
        Trigger(kind="time", value=1.5),
        Trigger(kind="distance", value=30.0),
        Trigger(kind="ttc", value=4.0),
    ):
        in_lane = {"lanes": 0.0} if "lanes" in probe.catalogue.behaviour(name).parameters else {}
        actor = probe.doing(name, ahead=50.0, trigger=trigger, parameters=in_lane)
        scene = probe.scene(actor, road=probe.widest, speed=10.0)
        tracks, other = run_both(probe, scene, constantly(Control()))
        told, wanted = tracks.onset(1), other.onset(1)
        if wanted is None:
            continue
        what = f"trigger by {trigger.kind}"
        if told is None:
            probe.findings.add(what, f"never shows in {name!r}")
        elif not abs(told - wanted) <= ONSET_S:
            message = f"shows in {name!r} after {told:.2f} s, in the reference world {wanted:.2f} s"
            probe.findings.add(what, message)


def _check_reactions(probe: Probe) -> None:
    """Check that a driver brakes for a standing body ahead, and for the ego."""
    follower = probe.doing("follow_lane", id="follower", ahead=20.0)
    block = probe.asset_for("vehicle", "object", "work_zone")
    ahead = probe.scene(follower, probe.still(block, id="block", ahead=75.0), speed=3.0)
    _check_stop(probe, ahead, 2, "brakes for a body ahead", constantly(Control()))
    behind = probe.scene(
        probe.doing("follow_lane", id="follower", ahead=-30.0, parameters={"speed": 12.0}),
        speed=12.0,
    )
    _check_stop(
        probe, behind, 0, "brakes for the ego", lambda time: Control(-3.0 if time > 0.5 else 0.0)
    )


def _check_stop(
    probe: Probe, scene: Scene, row: int, what: str, control: Callable[[float], Control]
) -> None:
    """Check that the driver in row 1 does not drive into the body in another row."""
    try:
        one, other = run_both(probe, scene, control, seconds=9.0)
    except OodscenError as error:
        probe.findings.add("reaction", str(error))
        return
    sizes = [(asset.length, asset.width) for _, asset, _ in probe.catalogue.bodies(scene)]
    gaps = [_least_gap(tracks, row, sizes) for tracks in (one, other)]
    if gaps[1] > 0.3 and not gaps[0] > 0.0:
        message = f"no driver of follow_lane {what}: it drives into it"
        probe.findings.add("reaction", message)
    elif gaps[1] > 0.3:
        told, wanted = (float(t.speeds[-1, 1]) for t in (one, other))
        first = float(other.speeds[0, 1])
        if told > wanted + 0.5 * max(0.0, first - wanted) + 1.0:
            message = f"hardly {what}: still {told:.1f} m/s, in the reference world {wanted:.1f}"
            probe.findings.add("reaction", message)


def _least_gap(tracks: Tracks, row: int, sizes: Sequence[tuple[float, float]]) -> float:
    def box(step: int, index: int) -> Footprint:
        x, y, _, yaw = map(float, tracks.poses[step, index])
        return Footprint(x, y, yaw, *sizes[index])

    return min(gap(box(step, 1), box(step, row)) for step in range(0, len(tracks.poses), 4))
