"""Part about motion: ego and actors move as the reference world moves them, within stated tolerances.

The reference is `oodscen.driving.KinematicWorld`, under the same controls. Simulators with dynamics of their own
differ from it, and may; they must not differ by what changes the meaning of a scene.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import BehaviourKind
from oodscen.data._scene import Actor, Scene, Trigger
from oodscen.driving._motion.behaviours import BUILT_IN, having
from oodscen.driving._motion.boxes import Box, gap
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.placement import staging_issues
from oodscen.errors import OodscenError
from oodscen.protocols import Control, State
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import follow_lane
from oodscen.testing._kit.vocabulary import assets_for, cast_for

START_M = 0.3
"""Tolerance of a body's place at the start, m."""
START_DEG = 5.0
"""Tolerance of its heading there, degrees."""
START_SPEED = 0.5
"""Tolerance of its speed there, m/s."""
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
CONTROL = 0.2
"""Relative tolerance of the ego's change of speed and of heading under a constant control."""

_SECONDS = 5.0
_LAST_S = 3.5
_CHANCE = ("amplitude", "radius", "lift")
_LOOSE = having(lambda row: row.has_chance or row.needs_other)
"""Behaviours whose headings and momentary speeds differ with chance or with the body that they belong to."""
_WAITING = (
    "cross_road",
    "pull_out",
    "dart",
    "bolt",
    "walk_along",
    "roll_away",
    "reverse",
    "hard_brake",
    "stall",
    "halt",
    "cut_in",
)
"""Behaviours that show when their trigger fires, best first."""


@dataclass(frozen=True)
class Tracks:
    """The motion of all bodies in a run."""

    dt: float
    poses: NDArray[np.float64]
    """[steps, n, 4]"""
    speeds: NDArray[np.float64]
    """[steps, n]"""

    @classmethod
    def of(cls, states: Sequence[State], dt: float) -> "Tracks":
        """Return the tracks of a run."""
        return cls(dt, np.stack([s.poses for s in states]), np.stack([s.speeds for s in states]))

    def onset(self, row: int) -> float | None:
        """Return the time at which a body leaves its initial uniform motion, s."""
        first, speed = self.poses[0, row], self.speeds[0, row]
        time = self.dt * np.arange(len(self.poses))
        ahead = np.stack([np.cos(first[3]), np.sin(first[3])]) * speed
        away = np.linalg.norm(self.poses[:, row, :2] - first[:2] - time[:, None] * ahead, axis=1)
        off = np.flatnonzero(away > 0.15)
        return float(time[off[0]]) if len(off) else None


def check_motion(probe: Probe) -> None:
    """Check starts, controls, behaviours, triggers, reactions and contacts against the reference world."""
    found = probe.findings
    for part in (
        _check_starts,
        _check_ego,
        _check_friction,
        _check_triggers,
        _check_reactions,
        _check_contact,
    ):
        with found.trying(part.__name__.removeprefix("_check_")):
            try:
                part(probe)
            except NotApplicable:
                continue
    own = [kind.id for kind in probe.catalogue.behaviours if kind.id not in BUILT_IN]
    if own:
        found.note = f"of the simulator's own behaviours only starts are compared: {', '.join(own)}"
    for kind in probe.catalogue.behaviours:
        with found.trying(f"behaviour {kind.id}"):
            _check_behaviour(probe, kind)


# ------------------------------------------------------------------ both worlds


def _both(
    probe: Probe,
    scene: Scene,
    control: Callable[[float], Control],
    *,
    seconds: float = _SECONDS,
) -> tuple[Tracks, Tracks]:
    """Run a scene in the simulator and in the reference world, under controls by time."""
    dt = probe.simulator.dt
    steps = round(seconds / dt)
    states = [probe.simulator.reset(scene, 0)]
    world = KinematicWorld(
        load_corridor(scene.map, probe.catalogue), scene, probe.catalogue, 0, dt=dt
    )
    poses, speeds = [world.poses()], [world.speeds()]
    for step in range(steps):
        given = control(step * dt)
        states.append(probe.simulator.step(given))
        world.step(given)
        poses.append(world.poses())
        speeds.append(world.speeds())
    return Tracks.of(states, dt), Tracks(dt, np.stack(poses), np.stack(speeds))


def _constantly(control: Control) -> Callable[[float], Control]:
    return lambda _: control


def _start_fault(one: Tracks, other: Tracks, row: int) -> str:
    """Return how a body's start differs from the reference world's."""
    apart = float(np.linalg.norm(one.poses[0, row, :2] - other.poses[0, row, :2]))
    if not apart <= START_M:
        return f"starts {apart:.1f} m from its place"
    turn = _turn(float(one.poses[0, row, 3]), float(other.poses[0, row, 3]))
    if not abs(turn) <= START_DEG:
        return f"starts with a heading {turn:.0f} degrees off"
    told, wanted = float(one.speeds[0, row]), float(other.speeds[0, row])
    if not abs(told - wanted) <= START_SPEED:
        return f"starts at {told:.1f} m/s, not {wanted:.1f}"
    return ""


def _turn(one: float, other: float) -> float:
    return math.degrees(math.remainder(one - other, math.tau))


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
    one, other = _both(probe, scene, _constantly(Control()), seconds=1.0)
    for row, actor in enumerate(actors, start=1):
        fault = _start_fault(one, other, row)
        probe.findings.expect(
            not fault, f"actor {actor.asset} at {actor.placement.offset_m:g} m", fault
        )
        way = float(np.linalg.norm(one.poses[-1, row, :2] - one.poses[0, row, :2]))
        probe.findings.expect(way < START_M, f"actor {actor.asset}", "moves though it should stand")


# ------------------------------------------------------------------ the ego


def _check_ego(probe: Probe) -> None:
    """Compare the ego's response to constant controls with the reference world's."""
    for name, speed, control in (
        ("braking at 5 m/s^2", 12.0, Control(-5.0)),
        ("accelerating at 2 m/s^2", 5.0, Control(2.0)),
        ("steering left by 0.05 rad", 8.0, Control(0.0, 0.05)),
        ("steering right by 0.05 rad", 8.0, Control(0.0, -0.05)),
    ):
        scene = probe.scene(speed=speed)
        one, other = _both(probe, scene, _constantly(control), seconds=1.5)
        fault = _start_fault(one, other, 0)
        probe.findings.expect(not fault, "ego", fault)
        told, wanted = (float(t.speeds[-1, 0] - t.speeds[0, 0]) for t in (one, other))
        if not abs(told - wanted) <= 0.3 + CONTROL * abs(wanted):
            message = f"{name} changes its speed by {told:.1f} m/s in 1.5 s, not {wanted:.1f}"
            probe.findings.add("ego", message)
        told, wanted = (_turn(*t.poses[[-1, 0], 0, 3]) for t in (one, other))
        if not abs(told - wanted) <= 1.0 + CONTROL * abs(wanted):
            message = f"{name} turns it by {told:.1f} degrees in 1.5 s, not {wanted:.1f}"
            probe.findings.add("ego", message)
        apart = float(np.linalg.norm(one.poses[-1, 0, :2] - other.poses[-1, 0, :2]))
        probe.findings.expect(
            apart <= 1.5, "ego", f"{name} ends {apart:.1f} m from the reference after 1.5 s"
        )


def _check_friction(probe: Probe) -> None:
    """Compare the ego's braking and steering on a slippery road with the reference world's."""
    least = max(0.3, probe.catalogue.weather.min_friction)
    if least > 0.7:
        raise NotApplicable("the road is always dry")
    weather = probe.clear.model_copy(update={"friction": least})
    for name, control in (("braking", Control(-9.0)), ("steering", Control(0.0, 0.1))):
        one, other = _both(
            probe,
            probe.scene(speed=14.0, weather=weather),
            _constantly(control),
            seconds=1.5,
        )
        told, wanted = (float(t.speeds[-1, 0] - t.speeds[0, 0]) for t in (one, other))
        turned, turning = (_turn(*t.poses[[-1, 0], 0, 3]) for t in (one, other))
        is_like = abs(told - wanted) <= 0.5 + 0.3 * abs(wanted)
        is_like &= abs(turned - turning) <= 3.0 + 0.3 * abs(turning)
        message = f"{name} at friction {least:g} does not stay within the grip"
        probe.findings.expect(is_like, "ego", message)


def _check_contact(probe: Probe) -> None:
    """Check that bodies keep moving after a contact, and that the contact is in the state."""
    box = max(probe.catalogue.assets, key=lambda one: (not one.is_passable(), one.height > 0.5))
    scene = probe.scene(probe.still(box, ahead=15.0), speed=8.0)
    states = probe.run(scene, follow_lane, steps=round(3.0 / probe.simulator.dt))
    touched = [state.step for state in states if state.contacts]
    probe.findings.expect(touched, "ego", f"drives through a {box.id} without a contact")
    way = float(np.linalg.norm(states[-1].poses[0, :2] - states[0].poses[0, :2]))
    message = f"covers {way:.0f} m through a {box.id} in 3 s at 8 m/s: a contact must not stop it"
    probe.findings.expect(way > 18.0, "ego", message)


# ------------------------------------------------------------------ actors


def _check_behaviour(probe: Probe, kind: BehaviourKind) -> None:
    """Compare the motion of a behaviour's actor in the ego's lane and in an oncoming one.

    Of a simulator's own behaviour only the start is known: the built-in one that it is `like` stands in for it
    where no simulator runs, and may go on in another way.
    """
    lanes = [0]
    if probe.widest.oncoming_lanes:
        lanes.append(probe.widest.lanes)
    for asset in assets_for(probe, kind)[:1]:
        for lane in lanes:
            actors = cast_for(probe, kind, asset, lane=lane, ahead=90.0 if lane else 35.0)
            if actors is None:
                return
            parameters = {**_slower(kind), **actors[0].behaviour.parameters}
            if lane and "lanes" in parameters:
                parameters["lanes"] = 0.0
            acting = actors[0].behaviour.model_copy(
                update={"parameters": parameters, "trigger": Trigger(value=1.0)}
            )
            first = actors[0].model_copy(update={"behaviour": acting})
            if lane and kind.needs_other:
                continue
            scene = probe.scene(first, *actors[1:], road=probe.widest, speed=5.0)
            if staging_issues(scene, probe.catalogue):
                continue
            where = " in an oncoming lane" if lane else ""
            _compare(probe, scene, kind, f"behaviour {kind.id}{where}")


def _slower(kind: BehaviourKind) -> dict[str, float]:
    """Return a speed other than the default, to see that it is heeded."""
    speed = kind.parameters.get("speed")
    if speed is None:
        return {}
    return {"speed": min(max(0.7 * speed.default, speed.minimum), speed.maximum)}


def _compare(probe: Probe, scene: Scene, kind: BehaviourKind, what: str) -> None:
    one, other = _both(probe, scene, _constantly(Control()), seconds=_LAST_S)
    start = _start_fault(one, other, 1)
    probe.findings.expect(not start, what, start)
    if start or kind.id not in BUILT_IN:
        return
    actor = scene.actors[0]
    defaults = {name: each.default for name, each in kind.parameters.items()}
    given = {**defaults, **actor.behaviour.parameters}
    chance = 2.0 * sum(abs(given.get(name, 0.0)) for name in _CHANCE)
    road = load_corridor(scene.map, probe.catalogue)
    way = 0.0
    for step in range(1, len(one.poses)):
        way += abs(float(other.speeds[step, 1])) * one.dt
        fault = _step_fault(one, other, step, road.heading, road.locate, way, chance, kind.id)
        if fault:
            probe.findings.add(what, f"{fault} after {step * one.dt:.1f} s")
            return


def _step_fault(
    one: Tracks,
    other: Tracks,
    step: int,
    heading: Callable[[float], float],
    locate: Callable[[float, float], tuple[float, float]],
    way: float,
    chance: float,
    name: str,
) -> str:
    """Return how an actor's motion in one step differs from the reference world's."""
    told, wanted = one.poses[step, 1], other.poses[step, 1]
    yaw = heading(locate(float(wanted[0]), float(wanted[1]))[0])
    dx, dy = (told[:2] - wanted[:2]).tolist()
    along = dx * math.cos(yaw) + dy * math.sin(yaw)
    across = dy * math.cos(yaw) - dx * math.sin(yaw)
    if not abs(along) <= ALONG_M + 0.25 * way + chance:
        return f"is {abs(along):.1f} m further {'on' if along > 0.0 else 'back'} than in the reference world"
    if not abs(across) <= ACROSS_M + chance:
        side = "left" if across > 0.0 else "right"
        return f"is {abs(across):.1f} m further {side} than in the reference world"
    speed, right = float(one.speeds[step, 1]), float(other.speeds[step, 1])
    if name in _LOOSE:
        return ""
    if not abs(speed - right) <= SPEED + 0.25 * abs(right):
        return f"has {speed:.1f} m/s, in the reference world {right:.1f}"
    if abs(right) > 1.0 and not abs(_turn(float(told[3]), float(wanted[3]))) <= HEADING_DEG:
        turn = _turn(float(told[3]), float(wanted[3]))
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
        actor = probe.doing(name, ahead=50.0, trigger=trigger, offset=0.0)
        if "lanes" in probe.catalogue.behaviour(name).parameters:
            actor = _with(actor, lanes=0.0)
        scene = probe.scene(actor, road=probe.widest, speed=10.0)
        one, other = _both(probe, scene, _constantly(Control()))
        told, wanted = one.onset(1), other.onset(1)
        if wanted is None:
            continue
        what = f"trigger by {trigger.kind}"
        if told is None:
            probe.findings.add(what, f"never shows in {name!r}")
        elif not abs(told - wanted) <= ONSET_S:
            message = f"shows in {name!r} after {told:.2f} s, in the reference world {wanted:.2f} s"
            probe.findings.add(what, message)


def _with(actor: Actor, **parameters: float) -> Actor:
    behaviour = actor.behaviour
    merged = {**behaviour.parameters, **parameters}
    return actor.model_copy(
        update={"behaviour": behaviour.model_copy(update={"parameters": merged})}
    )


def _check_reactions(probe: Probe) -> None:
    """Check that a driver brakes for a standing body ahead, and for the ego."""
    follower = probe.doing("follow_lane", id="follower", ahead=20.0)
    block = probe.asset_for("vehicle", "object", "work_zone")
    ahead = probe.scene(follower, probe.still(block, id="block", ahead=75.0), speed=3.0)
    _check_stop(probe, ahead, 1, 2, "brakes for a body ahead", _constantly(Control()))
    behind = probe.scene(
        probe.doing("follow_lane", id="follower", ahead=-30.0, parameters={"speed": 12.0}),
        speed=12.0,
    )
    _check_stop(
        probe, behind, 1, 0, "brakes for the ego", lambda time: Control(-3.0 if time > 0.5 else 0.0)
    )


def _check_stop(
    probe: Probe,
    scene: Scene,
    row: int,
    other_row: int,
    what: str,
    control: Callable[[float], Control],
) -> None:
    try:
        one, other = _both(probe, scene, control, seconds=9.0)
    except OodscenError as error:
        probe.findings.add("reaction", str(error))
        return
    sizes = [(asset.length, asset.width) for _, asset, _ in probe.catalogue.bodies(scene)]
    gaps = [_least(tracks, row, other_row, sizes) for tracks in (one, other)]
    if gaps[1] > 0.3 and not gaps[0] > 0.0:
        message = f"no driver of follow_lane {what}: it drives into it"
        probe.findings.add("reaction", message)
    elif gaps[1] > 0.3:
        told, wanted = (float(t.speeds[-1, row]) for t in (one, other))
        first = float(other.speeds[0, row])
        if told > wanted + 0.5 * max(0.0, first - wanted) + 1.0:
            message = f"hardly {what}: still {told:.1f} m/s, in the reference world {wanted:.1f}"
            probe.findings.add("reaction", message)


def _least(tracks: Tracks, row: int, other: int, sizes: Sequence[tuple[float, float]]) -> float:
    def box(step: int, index: int) -> Box:
        x, y, _, yaw = map(float, tracks.poses[step, index])
        return Box(x, y, yaw, *sizes[index])

    return min(gap(box(step, row), box(step, other)) for step in range(0, len(tracks.poses), 4))
