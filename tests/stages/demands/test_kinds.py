"""Kinds of demands: whatever the setting, the draws that are tried are scenes that can be written and read."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue

from oodscen.data._scene import MAX_SPEED, Actor, Scene
from oodscen.driving._motion.triggers import MAX_APPROACH_S
from oodscen.stages._demands.kinds import KINDS, ranked_candidates
from oodscen.stages._demands.setting import NearbyBodies, Setting
from oodscen.testing._scenes import example_scene

CATALOGUE = load_catalogue()


@st.composite
def settings(draw):
    road = draw(st.sampled_from([road.id for road in CATALOGUE.maps]))
    scene = Scene.parse({**example_scene().model_dump(), "map": road})
    gap_m = draw(st.floats(0.1, 80.0))
    return Setting(
        scene=scene,
        catalogue=CATALOGUE,
        decision_m=draw(st.floats(0.0, 300.0)),
        speed=draw(st.floats(0.0, MAX_SPEED)),
        decision_s=draw(st.floats(0.0, MAX_APPROACH_S)),
        gap_m=gap_m,
        area_m2=draw(st.floats(0.5, 12.0)),
        look=NearbyBodies.of([(gap_m, 0.0, 2.8)]),
    )


@given(settings(), st.integers(0, 9))
def test_every_candidate_s_actors_can_be_written_and_read(setting, seed):
    for candidate in ranked_candidates(setting.scene, setting, seed):
        for actor in candidate.actors:
            assert Actor.parse(actor.to_json()) == actor


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.id)
@given(setting=settings())
def test_no_kind_fails_before_a_standing_ego_or_far_along_the_road(kind, setting):
    standing = replace(setting, speed=0.0)
    far = replace(setting, decision_m=300.0)
    for extreme in (standing, far):
        draft = kind.drawn(extreme, np.random.default_rng(0))
        assert draft is None or draft.actors


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.id)
@given(setting=settings(), kept=st.sets(st.sampled_from([one.id for one in CATALOGUE.assets])))
def test_every_kind_does_with_the_assets_that_there_are(kind, setting, kept):
    kept |= set(kind.assets)
    assets = tuple(asset for asset in CATALOGUE.assets if asset.id in kept)
    fewer = replace(setting, catalogue=CATALOGUE.model_copy(update={"assets": assets}))
    draft = kind.drawn(fewer, np.random.default_rng(0))
    assert draft is None or {actor.asset for actor in draft.actors} <= kept
    assert draft is None or draft.actors
