"""Demands: accepted like scenes, true to their texts, never like the hazard, the same again for the same seed."""

from dataclasses import replace
from functools import cache
from itertools import islice

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._reading.claim_extraction import read_claims
from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._scene import Scene
from oodscen.driving._sight.placement import check_scene
from oodscen.protocols import Camera
from oodscen.stages._demands.demanding import (
    _COMPARED,
    _admitted,
    _alike_first,
    _difference,
    _picture_bytes,
    draw_demand,
)
from oodscen.stages._demands.kinds import KINDS, ranked_candidates
from oodscen.stages._demands.setting import NearbyBodies, Setting
from oodscen.stages._restaging.rerun import Rerunner
from oodscen.stages._simulate import simulate
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

MAPS = ("residential_two_lane", "urban_avenue", "highway", "rural_curve", "roundabout", "tunnel")
SMALL = Camera(width=160, height=120)


@pytest.fixture(scope="module")
def simulator():
    with FlatSimulator() as one:
        yield one


def placed(road):
    return Scene.model_validate({**example_scene().model_dump(), "map": road, "id": "s-0"})


@pytest.fixture(scope="module")
def run_on(simulator):
    """Return what runs the scene on a road, once."""
    return cache(lambda road: simulate(placed(road), simulator, camera=SMALL))


@pytest.mark.parametrize("road", MAPS)
def test_a_demand_passes_the_checks_of_scenes_and_its_text_is_true(simulator, run_on, road):
    scene, catalogue = placed(road), simulator.catalogue()
    run = run_on(road)
    found = draw_demand(scene, run, Rerunner(simulator, camera=SMALL)).scene
    assert found.is_ordinary
    assert not found.is_twin
    assert not check_scene(found, catalogue)
    for told in (found.demand.claims, read_claims(found.demand.text)):
        assert not mismatches(check_claims(told, found, catalogue))
    assert (found.map, found.ego) == (scene.map, scene.ego)
    assert found.decision.value == run.episode.decision_s
    assert Scene.parse(found.model_dump_json()) == found


def test_a_demand_leaves_an_action_safe_and_is_the_same_again(simulator, run_on):
    scene = placed("urban_avenue")
    run = run_on("urban_avenue")
    first, second = (
        draw_demand(scene, run, Rerunner(simulator, 3, camera=SMALL)) for _ in range(2)
    )
    assert first.scene == second.scene
    assert first.simulated.episode == second.simulated.episode
    assert first.simulated.episode.safe_set


@pytest.mark.parametrize(
    ("asset", "left_out"),
    [("cone", "works"), ("cyclist", "cyclist"), ("adult", "zebra"), ("bus", "bus_stop")],
)
def test_no_kind_looks_like_the_hazard(simulator, run_on, asset, left_out):
    scene = placed("urban_avenue")
    known = {one.id for one in simulator.catalogue().assets}
    if asset not in known:
        pytest.skip(f"the catalogue has no {asset}")
    (box,) = scene.actors
    changed = scene.model_copy(update={"actors": (box.model_copy(update={"asset": asset}),)})
    run = run_on("urban_avenue")
    setting = Setting.of(scene, simulator.catalogue(), run.trace, run.episode.sketch)
    kinds = {
        ranked_candidate.kind.id for ranked_candidate in ranked_candidates(changed, setting, 0)
    }
    assert left_out not in kinds
    assert kinds < {kind.id for kind in KINDS}


@pytest.mark.parametrize("road", MAPS)
def test_nobody_of_a_demand_drives_in_the_very_middle_of_a_lane(simulator, run_on, road):
    scene = placed(road)
    run = run_on(road)
    setting = Setting.of(scene, simulator.catalogue(), run.trace, run.episode.sketch)
    drivers = [
        actor.placement.offset_m
        for candidate in ranked_candidates(scene, setting, 0)
        for actor in candidate.draft.actors
        if actor.behaviour.name in ("follow_lane", "halt", "cut_in")
    ]
    assert drivers
    assert sum(offset == 0.0 for offset in drivers) <= 0.1 * len(drivers)


BODIES = st.lists(
    st.tuples(st.floats(-40.0, 120.0), st.floats(-30.0, 30.0), st.floats(0.1, 12.0)), max_size=8
)


@given(BODIES, BODIES)
def test_looks_differ_as_much_either_way_and_not_from_themselves(one, other):
    first, second = NearbyBodies.of(one), NearbyBodies.of(other)
    assert first.difference(second) == pytest.approx(second.difference(first))
    assert first.difference(first) == 0.0
    assert first.difference(NearbyBodies.of([*one, (20.0, 0.0, 3.0)])) > 0.0


def test_a_demand_has_about_as_many_bodies_as_its_scene(simulator, run_on):
    scene = placed("urban_avenue")
    run = run_on("urban_avenue")
    setting = Setting.of(scene, simulator.catalogue(), run.trace, run.episode.sketch)

    def first_bodies(bodies):
        like = replace(setting, look=setting.look._replace(bodies=bodies))
        return np.mean([len(ranked_candidates(scene, like, seed)[0].actors) for seed in range(30)])

    assert first_bodies(1) < first_bodies(10)


def candidates_for(scene, run, rerunner, picture):
    """Return the first few admitted candidates, and the same in the order for a rare picture."""
    setting = Setting.of(scene, rerunner.simulator.catalogue(), run.trace, run.episode.sketch)
    ranked = ranked_candidates(scene, setting, 0)
    few = list(islice(_admitted(scene, setting, ranked), _COMPARED))
    frame = replace(run.frames["last"], rgb=picture)
    return few, list(_alike_first(few, replace(run, frames={"last": frame}), rerunner))


@pytest.mark.parametrize("road", MAPS[:3])
def test_demands_whose_pictures_are_about_as_full_come_first(simulator, run_on, road):
    scene, rerunner = placed(road), Rerunner(simulator, camera=SMALL)
    run = run_on(road)
    shape = run.frames["last"].rgb.shape
    noise = np.random.default_rng(0).integers(0, 256, shape, np.uint8)
    few, for_full = candidates_for(scene, run, rerunner, noise)
    _, for_empty = candidates_for(scene, run, rerunner, np.zeros(shape, np.uint8))
    sizes = [_picture_bytes(one.scene, rerunner) for one in few]
    by_full, by_empty = (
        [sizes[few.index(one)] for one in order] for order in (for_full, for_empty)
    )
    assert by_full == sorted(sizes, reverse=True)
    assert by_empty == sorted(sizes)
    assert by_full[0] > by_empty[0]


SIZES = st.floats(1.0, 1e7)


@given(SIZES, SIZES, st.floats(1.01, 10.0))
def test_pictures_differ_more_the_less_alike_and_most_if_fuller(one, other, factor):
    assert _difference(one, one) == 0.0
    farther = other * factor if other >= one else other / factor
    assert _difference(one, farther) > _difference(one, other)
    assert _difference(one, one * factor) > _difference(one, one / factor)
