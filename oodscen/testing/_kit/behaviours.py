"""Runs of every behaviour beside the reference world, with parameters that show whether a simulator minds them.

A behaviour with an end is run beyond it: a walker past its distance, a driver past its pause.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from oodscen.data._catalogue import Asset, BehaviourKind
from oodscen.data._scene import Actor, Behaviour, Scene, Trigger
from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.testing._kit.comparing import compare
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.vocabulary import assets_for, cast_for

_SLOWER = 0.3
"""Share of its default speed with which a behaviour runs as usual: even a walker then shows it."""
_SECONDS = 4.0
"""Length of the run in which a behaviour is compared with its usual parameters, s."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A run of a behaviour whose motion tells its parameters from their defaults and their limits."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    seconds: float = 3.5
    """Length of the run, s; beyond the end of what the behaviour does, if it ends."""
    ahead: float = 35.0
    """From the ego, m."""
    heading_deg: float = 0.0
    """Against the direction of its lane."""
    lane: int = 0
    """Lanes to the left of the ego's, if the road has them in its direction."""
    ego_speed: float = 5.0
    """m/s"""
    trigger_s: float = 1.0
    """Time of its trigger."""


_USUAL = Case()
CASES: dict[str, tuple[Case, ...]] = {
    "follow_lane": (
        Case(parameters={"speed": 8, "headway": 5}, seconds=4.5, ahead=-24.0, ego_speed=8.0),
        Case(
            parameters={"speed": 14, "deceleration": 1.5}, seconds=1.5, ahead=-30.0, ego_speed=0.0
        ),
    ),
    "wrong_way": (Case(parameters={"speed": 6}),),
    "cut_in": (Case(parameters={"speed": 8, "lanes": -1, "duration": 4}, seconds=5.0, lane=1),),
    "cut_out": (Case(parameters={"speed": 8, "lanes": -1, "duration": 4}, seconds=5.0, lane=1),),
    "hard_brake": (Case(parameters={"speed": 12, "deceleration": 2.5}),),
    "stall": (Case(parameters={"speed": 12, "deceleration": 4}, seconds=4.0),),
    "stop_and_go": (Case(parameters={"speed": 10, "period": 4}, seconds=4.5),),
    "halt": (Case(parameters={"speed": 11, "deceleration": 4, "pause": 1.5}, seconds=7.2),),
    "reverse": (Case(parameters={"speed": 1}),),
    "swerve": (
        Case(parameters={"speed": 7, "amplitude": 1.6, "period": 4.5}, seconds=11.8, trigger_s=2.5),
    ),
    "pull_out": (Case(parameters={"speed": 6, "lanes": 1, "duration": 6}, seconds=6.0),),
    "u_turn": (Case(parameters={"speed": 2.5, "duration": 2.5}, seconds=4.0),),
    "cross_road": (Case(parameters={"speed": 1.5, "distance": 4}, seconds=6.2, heading_deg=90.0),),
    "hesitate": (
        Case(
            parameters={"speed": 1.5, "distance": 1.5, "pause": 0.5}, seconds=4.0, heading_deg=90.0
        ),
        Case(parameters={"speed": 1.5, "distance": 5, "pause": 5}, seconds=8.0, heading_deg=90.0),
    ),
    "walk_along": (Case(parameters={"speed": 1.5}, heading_deg=90.0),),
    "bolt": (Case(parameters={"speed": 3, "distance": 8}, seconds=4.8, heading_deg=90.0),),
    "wobble": (
        Case(parameters={"speed": 7, "amplitude": 1.2, "period": 4}, seconds=10.8, trigger_s=2.5),
    ),
    "drift": (Case(parameters={"speed": 7, "lateral": 1.5}),),
    "overtake": (Case(parameters={"speed": 7, "lateral": 3.6}, seconds=6.5, ahead=8.0),),
    "run_red": (Case(parameters={"speed": 8}, heading_deg=90.0),),
    "roll_away": (Case(parameters={"speed": -6, "acceleration": 3}, seconds=4.5),),
    "wander": (
        Case(parameters={"speed": 4, "radius": 15}, seconds=7.0),
        Case(parameters={"speed": 3, "radius": 1}, seconds=4.0),
    ),
    "dart": (Case(parameters={"speed": 8, "distance": 4}, heading_deg=90.0),),
    "fall": (Case(parameters={"height": 3, "lateral": -3, "spin_deg": -240}, seconds=4.0),),
    "towed": (Case(),),
    "open_door": (
        Case(parameters={"angle_deg": 90, "duration": 2.5}, seconds=4.0),
        Case(parameters={"angle_deg": 33}, seconds=2.0),
    ),
    "blown": (Case(parameters={"speed": 12, "period": 1.2, "lift": 1}, seconds=5.0),),
}
"""By behaviour; any other is run as usual only."""


def check_behaviour(probe: Probe, kind: BehaviourKind) -> None:
    """Compare the motion of a behaviour's actor in the ego's lane and in an oncoming one.

    Of a simulator's own behaviour only the start is known: the built-in one that it is `like` stands in for it
    where no simulator runs, and may go on in another way.
    """
    for asset in assets_for(probe, kind)[:1]:
        for where, scene, seconds in _runs(probe, kind, asset):
            subject = f"behaviour {kind.id}{where}"
            if probe.can_stage(scene, subject):
                compare(probe, scene, kind, subject, seconds)


def _runs(probe: Probe, kind: BehaviourKind, asset: Asset) -> Iterator[tuple[str, Scene, float]]:
    """Yield the place in words, scene and length, s, of a behaviour's runs."""
    cases = CASES.get(kind.id, ()) if kind.id in BUILT_IN else ()
    for case in cases:
        yield from _case_runs(probe, kind, asset, case)
    oncoming = [True] if probe.widest.oncoming_lanes and not kind.needs_other else []
    for is_oncoming in oncoming if cases and oncoming else [False, *oncoming]:
        lane, ahead = (probe.widest.lanes, 90.0) if is_oncoming else (0, 35.0)
        actors = cast_for(probe, kind, asset, lane=lane, ahead=ahead)
        if actors is None:
            return
        usual = {**_slower(kind), **actors[0].behaviour.parameters}
        if is_oncoming and "lanes" in usual:
            usual["lanes"] = 0.0
        first = _doing(actors[0], usual)
        scene = probe.scene(first, *actors[1:], road=probe.widest, speed=5.0)
        yield " in an oncoming lane" if is_oncoming else "", scene, _SECONDS


def _case_runs(
    probe: Probe, kind: BehaviourKind, asset: Asset, case: Case
) -> Iterator[tuple[str, Scene, float]]:
    """Yield the run of a case, in which the vehicle that an actor belongs to drives if any vehicle does."""
    lane = min(case.lane, probe.widest.lanes - 1)
    actors = cast_for(probe, kind, asset, lane=lane, ahead=case.ahead)
    if actors is None:
        return
    drives = "follow_lane" in {each.id for each in probe.catalogue.behaviours}
    first, *others = actors
    if others and drives:
        driving = Behaviour(name="follow_lane", parameters={"speed": 5.0})
        others = [other.model_copy(update={"behaviour": driving}) for other in others]
    parameters = {
        name: min(max(value, kind.parameters[name].minimum), kind.parameters[name].maximum)
        for name, value in case.parameters.items()
        if name in kind.parameters
    }
    if "lanes" in parameters and probe.widest.lanes < 2:
        parameters["lanes"] = 0.0
    first = _doing(first, parameters, case)
    scene = probe.scene(first, *others, road=probe.widest, speed=case.ego_speed)
    yield "", scene, case.seconds


def _doing(actor: Actor, parameters: Mapping[str, float], case: Case = _USUAL) -> Actor:
    """Return an actor with parameters of its behaviour, and with the heading and the trigger of a case."""
    update = {"parameters": dict(parameters), "trigger": Trigger(value=case.trigger_s)}
    return actor.model_copy(
        update={
            "behaviour": actor.behaviour.model_copy(update=update),
            "placement": actor.placement.model_copy(update={"heading_deg": case.heading_deg}),
        }
    )


def _slower(kind: BehaviourKind) -> dict[str, float]:
    """Return a parameter for a lower speed than the default, if the behaviour has one."""
    speed = kind.parameters.get("speed")
    if speed is None:
        return {}
    return {"speed": min(max(_SLOWER * speed.default, speed.minimum), speed.maximum)}
