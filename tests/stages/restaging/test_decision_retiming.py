"""Decisions that come too early for a viewer move to where the hazard can be named."""

import pytest

from oodscen import simulate
from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._claim import Claim
from oodscen.data._scene import Actor, Behaviour, Placement, Trigger
from oodscen.protocols import Camera
from oodscen.stages._restaging import decision_retiming as _decision_retiming
from oodscen.stages._restaging.decision_retiming import SLOWER, _slow_ego, retime
from oodscen.stages._restaging.rerun import Rerunner
from oodscen.stages._restaging.restage import changed_scene, contradiction, variants
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

SMALL = Camera(width=160, height=120)


@pytest.fixture(scope="module")
def flat():
    with FlatSimulator() as simulator:
        yield simulator


@pytest.fixture
def few(monkeypatch):
    """Try two approach speeds, each with two moments."""
    monkeypatch.setattr(_decision_retiming, "SLOWER", SLOWER[:2])
    monkeypatch.setattr(_decision_retiming, "MOST_MOMENTS", 2)


def far(**fields):
    early = {"decision": Trigger(kind="distance", value=50.0, actor="box")}
    return example_scene().model_copy(update={**early, **fields})


@pytest.mark.parametrize(
    "decision",
    [
        Trigger(kind="distance", value=50.0, actor="box"),
        Trigger(kind="ttc", value=6.0, actor="box"),
        Trigger(kind="time", value=1.0),
    ],
    ids=lambda one: one.kind,
)
def test_the_first_moment_at_which_it_can_be_named_is_taken(flat, decision):
    scene = far(decision=decision)
    before = simulate(scene, flat, camera=SMALL)
    assert before.episode.sighting.faults == ("small",)
    found = retime(scene, before, Rerunner(flat, camera=SMALL))
    after = found.simulated.episode
    assert after.sighting.faults == ()
    assert after.is_decidable
    assert after.decision_s > before.episode.decision_s
    assert found.scene.decision.kind == decision.kind
    assert found.scene == scene.model_copy(update={"decision": found.scene.decision})
    assert after.restaged.startswith("to name the hazard: decision")
    assert found.simulated.states[0].fingerprint() == before.states[0].fingerprint()


def test_a_slower_approach_is_tried_and_else_nothing_changes(flat):
    behind = example_scene().actors[0].placement.model_copy(update={"ahead_m": -40.0})
    passed = example_scene().actors[0].model_copy(update={"placement": behind})
    scene = far(actors=(passed,), decision=Trigger(value=1.0))
    before = simulate(scene, flat, camera=SMALL)
    found = retime(scene, before, Rerunner(flat, camera=SMALL))
    assert found.scene is scene
    assert found.simulated is before
    assert [attempt.why for attempt in found.tried] == [
        "the hazard cannot be named before the ego reaches it"
    ] * len(SLOWER)


def test_a_hazard_that_can_be_named_too_late_to_matter_is_named_all_the_same(flat, few):
    """From where the box is large enough, a fast ego is past it before a change of lanes could touch it."""
    box = example_scene().actors[0]
    aside = box.placement.model_copy(update={"offset_m": 3.8})
    fast = example_scene().ego.model_copy(update={"speed": 16.0})
    scene = far(actors=(box.model_copy(update={"placement": aside}),), ego=fast)
    before = simulate(scene, flat, camera=SMALL)
    assert before.episode.is_decidable
    assert before.episode.is_below_floor
    told = (said("ego_speed", "58"),)
    found = retime(scene, before, Rerunner(flat, camera=SMALL), told)
    after = found.simulated.episode
    assert found.scene.ego == fast
    assert not after.is_below_floor
    assert after.safe_set
    assert not after.is_decidable
    assert found.tried[0].why.endswith("every action is safe")


@pytest.mark.parametrize("share", [0.85, 0.5])
def test_only_ordinary_traffic_behind_slows_with_the_ego(share):
    scene = example_scene()
    behaviour = Behaviour(name="follow_lane", parameters={"speed": 8.0, "headway": 1.0})
    cars = [
        Actor(id=name, asset="car", placement=Placement(ahead_m=ahead), behaviour=behaviour)
        for name, ahead in (("behind", -20.0), ("ahead", 30.0))
    ]
    slowed = _slow_ego(changed_scene(scene, actors=(*scene.actors, *cars)), share)
    speeds = {actor.id: actor.behaviour.parameters.get("speed") for actor in slowed.actors}
    assert speeds == {"box": None, "behind": 8.0 * share, "ahead": 8.0}
    assert slowed.ego.speed == scene.ego.speed * share


def said(kind, value, **of):
    return Claim(kind=kind, value=value, quote=value, **of)


AWAY = said("distance", "40", subject="box")
THERE = said("thing", "present", subject="box")


def test_no_move_contradicts_what_the_text_says(flat, few):
    """The decision moves while every claim still holds; one that a later decision breaks prevents it."""
    scene = far()
    before = simulate(scene, flat, camera=SMALL)
    told = (THERE, AWAY, said("ego_speed", str(round(3.6 * scene.ego.speed))))
    found = retime(scene, before, Rerunner(flat, camera=SMALL), told)
    assert found.scene.decision != scene.decision
    assert mismatches(check_claims(told, found.scene, flat.catalogue())) == []
    box = scene.actors[0]
    leaves = box.model_copy(
        update={
            "placement": box.placement.model_copy(update={"heading_deg": 90.0}),
            "behaviour": Behaviour(
                name="dart",
                trigger=Trigger(kind="distance", value=45.0),
                parameters={"speed": 0.5, "distance": 0.6},
            ),
        }
    )
    early = changed_scene(scene, actors=(leaves,))
    rests = (THERE, said("motion", "stationary", subject="box"))
    assert mismatches(check_claims(rests, early, flat.catalogue())) == []
    run = simulate(early, flat, camera=SMALL)
    assert retime(early, run, Rerunner(flat, camera=SMALL)).scene != early
    kept = retime(early, run, Rerunner(flat, camera=SMALL), rests)
    assert kept.scene == early
    assert any("the text says box" in one.why for one in kept.tried)


@pytest.mark.parametrize("metres", [12, 25, 40, 60])
def test_a_distance_in_the_text_bounds_how_early_a_decision_may_come(flat, metres):
    catalogue = flat.catalogue()
    scene = example_scene()
    told = (THERE, said("distance", str(metres), subject="box"))
    known = {mismatch.claim for mismatch in mismatches(check_claims(told, scene, catalogue))}
    for variant, _ in variants(scene, catalogue, is_too_easy=False):
        new = {
            mismatch.claim for mismatch in mismatches(check_claims(told, variant, catalogue))
        } - known
        assert bool(contradiction(told, scene, variant, catalogue)) == bool(new)
        assert contradiction((), scene, variant, catalogue) == ""
