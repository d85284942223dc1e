"""Re-staging: every variant is a scene that can be written and read, and changes one thing in the right direction."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scene import MAX_ACTORS, MAX_SPEED, MAX_TRIGGER, Ego, Scene, Trigger
from oodscen.errors import DataError
from oodscen.stages._restaging.restage import COMPANION, changed_scene, variants
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

CATALOGUE = FlatSimulator().catalogue()

decisions = st.builds(
    Trigger,
    kind=st.sampled_from(["time", "distance", "ttc"]),
    value=st.one_of(st.just(MAX_TRIGGER), st.floats(1.0, MAX_TRIGGER)),
    actor=st.just("box"),
)
scenes = st.builds(
    lambda decision, speed: changed_scene(example_scene(), decision=decision, ego=Ego(speed=speed)),
    decisions,
    st.one_of(st.sampled_from([0.0, MAX_SPEED]), st.floats(1.0, MAX_SPEED)),
)


@given(scenes, st.booleans())
def test_every_variant_can_be_written_and_read(scene, is_too_easy):
    found = [variant for variant, _ in variants(scene, CATALOGUE, is_too_easy=is_too_easy)]
    assert all(Scene.parse(variant.to_json()) == variant for variant in found)
    assert all(variant not in [scene, *found[:number]] for number, variant in enumerate(found))


@given(scenes, st.booleans())
def test_a_scene_that_is_too_easy_leaves_less_room_and_another_more(scene, is_too_easy):
    for variant, how in variants(scene, CATALOGUE, is_too_easy=is_too_easy):
        before, after = scene.decision.value, variant.decision.value
        is_later = after > before if scene.decision.kind == "time" else after < before
        if how.startswith("decision"):
            assert is_later is is_too_easy
        else:
            assert after == before
        if how.startswith("approach"):
            assert (variant.ego.speed > scene.ego.speed) is is_too_easy


def companions(scene):
    added = (variant.actors[-1].id for variant, _ in variants(scene, CATALOGUE, is_too_easy=True))
    return sum(name == COMPANION for name in added)


def test_a_car_is_added_once_and_only_where_a_scene_has_room():
    scene = example_scene()
    (box,) = scene.actors
    assert companions(scene) == 4
    full = [box, *(box.model_copy(update={"id": f"b{n}"}) for n in range(MAX_ACTORS - 1))]
    assert companions(changed_scene(scene, actors=full)) == 0
    accompanied = [variant for variant, _ in variants(scene, CATALOGUE, is_too_easy=True)][-1]
    assert not any("car" in how for _, how in variants(accompanied, CATALOGUE, is_too_easy=True))


def test_a_change_that_makes_no_scene_is_an_error_in_the_library_s_words():
    with pytest.raises(DataError, match="horizon_s"):
        changed_scene(example_scene(), horizon_s=-1.0)


def test_the_companion_is_a_car_by_whatever_name():
    cars = tuple(
        asset.model_copy(update={"id": "my_car", "names": ("car",)}) if asset.id == "car" else asset
        for asset in CATALOGUE.assets
    )
    own = CATALOGUE.model_copy(update={"assets": cars})
    added = {
        actor.asset
        for variant, _ in variants(example_scene(), own, is_too_easy=True)
        for actor in variant.actors
        if actor.id == COMPANION
    }
    assert added == {"my_car"}
