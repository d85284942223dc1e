"""A simulator that ignores a parameter, a trigger or the other actor of a behaviour is found."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from oodscen.data import Actor, Behaviour, BehaviourKind
from oodscen.data._scene import Trigger
from oodscen.driving._motion.behaviours.table import BEHAVIOURS, BUILT_IN
from oodscen.testing._check import examine_parts
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._kit.behaviours import CASES, check_behaviour
from oodscen.testing._kit.findings import Findings
from oodscen.testing._kit.probe import Probe
from oodscen.testing._new.adapter import MySimulator

DEFAULT_ONLY = {
    ("follow_lane", "headway"),
    ("stall", "deceleration"),
    ("halt", "deceleration"),
    ("roll_away", "acceleration"),
    ("open_door", "angle_deg"),
    ("cut_in", "lanes"),
    ("cut_out", "lanes"),
    ("pull_out", "lanes"),
}
"""Parameters that only their default is told from; the road has not as many lanes as the greatest number."""
KINDS = pytest.mark.parametrize("kind", BEHAVIOURS, ids=lambda kind: kind.id)


class Altering(FlatSimulator):
    """Runs the first actor with another behaviour than the scene says."""

    alter: Callable[[Behaviour], Behaviour] | None = None

    def reset(self, scene, seed):
        if self.alter and scene.actors:
            first, *others = scene.actors
            first = first.model_copy(update={"behaviour": self.alter(first.behaviour)})
            scene = scene.model_copy(update={"actors": (first, *others)})
        return super().reset(scene, seed)


@pytest.fixture(scope="module")
def simulator() -> Iterator[Altering]:
    with Altering() as opened:
        yield opened


def faults(
    simulator: Altering, kind: BehaviourKind, alter: Callable[[Behaviour], Behaviour] | None
) -> list[str]:
    """Return what the runs of a behaviour find."""
    findings = Findings()
    probe = Probe(
        simulator=simulator,
        catalogue=FLAT_CATALOGUE,
        factory=Altering,
        source=Altering,
        scenes=(),
        states_only=True,
        resets=5,
        findings=findings,
    )
    simulator.alter = alter
    check_behaviour(probe, kind)
    return [finding.message for finding in findings.recorded]


def setting(name: str, value: float) -> Callable[[Behaviour], Behaviour]:
    """Return what gives a parameter a fixed value, whatever the scene says."""

    def alter(behaviour: Behaviour) -> Behaviour:
        return behaviour.model_copy(update={"parameters": {**behaviour.parameters, name: value}})

    return alter


@KINDS
def test_a_simulator_that_ignores_a_parameter_is_found(
    simulator: Altering, kind: BehaviourKind
) -> None:
    assert faults(simulator, kind, None) == []
    missed = []
    for name, parameter in kind.parameters.items():
        values = {parameter.default, parameter.maximum}
        if (kind.id, name) in DEFAULT_ONLY:
            values = {parameter.default}
        missed += [
            (name, value)
            for value in sorted(values)
            if not faults(simulator, kind, setting(name, value))
        ]
    assert missed == []


@KINDS
def test_a_simulator_that_ignores_a_trigger_is_found(
    simulator: Altering, kind: BehaviourKind
) -> None:
    for value in (0.0, 500.0):
        found = faults(
            simulator,
            kind,
            lambda behaviour, value=value: behaviour.model_copy(
                update={"trigger": Trigger(value=value)}
            ),
        )
        assert bool(found) == BUILT_IN[kind.id].has_trigger, value


@pytest.mark.parametrize("name", [kind.id for kind in BEHAVIOURS if kind.needs_other])
def test_a_body_that_ignores_the_vehicle_it_belongs_to_is_found(
    simulator: Altering, name: str
) -> None:
    assert faults(simulator, FLAT_CATALOGUE.behaviour(name), lambda _: Behaviour())


def test_every_parameter_has_a_run_in_which_it_is_not_its_default() -> None:
    for kind in BEHAVIOURS:
        cases = CASES.get(kind.id, ())
        for name, parameter in kind.parameters.items():
            values = {case.parameters.get(name, parameter.default) for case in cases}
            assert values - {parameter.default} or name == "speed", (kind.id, name)
            assert all(parameter.minimum <= value <= parameter.maximum for value in values)


class NeverArriving(MySimulator):
    """Moves who crosses the road like who walks along: at full speed at once, and for ever."""

    def catalogue(self):
        kept = super().catalogue()
        cross = FLAT_CATALOGUE.behaviour("cross_road")
        return kept.model_copy(update={"behaviours": (*kept.behaviours, cross)})

    def begin(self, staged, seed):
        super().begin(staged, seed)
        for mover in self.movers:
            if mover.body.behaviour == "cross_road":
                mover.body = replace(mover.body, behaviour="walk_along")


class Arriving(NeverArriving):
    """Stops at the end of the distance, at once."""

    def move(self, control):
        super().move(control)
        for mover in self.movers:
            x, y, *_ = mover.body.pose
            distance = mover.parameter("distance", math.inf)
            if math.dist((mover.x, mover.y), (x, y)) >= distance:
                mover.speed, mover.is_triggered = 0.0, False


class Sideways(Arriving):
    """Walkers go along the road, whatever their heading."""

    def move(self, control):
        super().move(control)
        for mover in self.movers:
            if mover.body.behaviour == "walk_along" and mover.is_triggered:
                x, y, *_ = mover.body.pose
                mover.x, mover.y = x + math.dist((mover.x, mover.y), (x, y)), y


def test_a_walker_that_never_arrives_or_goes_along_the_road_is_found() -> None:
    result, _ = examine_parts(Arriving, parts=("motion",))
    assert result.lines() == []
    for wrong in (NeverArriving, Sideways):
        result, _ = examine_parts(wrong, parts=("motion",))
        assert "behaviour cross_road" in {finding.subject for finding in result.findings}, wrong


class MeasuresToItself(FlatSimulator):
    """Measures every trigger to the actor that has it."""

    def reset(self, scene, seed):
        actors: list[Actor] = []
        for actor in scene.actors:
            trigger = actor.behaviour.trigger.model_copy(update={"actor": None})
            behaviour = actor.behaviour.model_copy(update={"trigger": trigger})
            actors.append(actor.model_copy(update={"behaviour": behaviour}))
        return super().reset(scene.model_copy(update={"actors": tuple(actors)}), seed)


def test_a_trigger_that_measures_to_the_wrong_actor_is_found() -> None:
    result, _ = examine_parts(MeasuresToItself, parts=("motion",))
    assert [finding.subject for finding in result.findings] == [
        "trigger by distance to another actor"
    ]
