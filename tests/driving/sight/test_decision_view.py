from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._sighting import Sighting
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.decision_view import SCALE_PX, best, drawn, groups
from oodscen.driving._sight.scene_checks import bodies
from oodscen.protocols import Camera
from oodscen.testing import example_scene
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

SCENE = example_scene()
CORRIDOR = load_corridor(SCENE.map, FLAT_CATALOGUE)
CAST = bodies(SCENE, FLAT_CATALOGUE, KinematicWorld(CORRIDOR, SCENE, FLAT_CATALOGUE, 0).poses())


def sighting(size_px, hidden=0.0):
    return Sighting(actor="box", distance_m=9.0, height_px=size_px, size_px=size_px, hidden=hidden)


@given(st.lists(st.tuples(st.floats(0.0, 300.0), st.sampled_from([0.0, 0.9])), max_size=5))
def test_the_best_look_has_the_fewest_faults_and_then_the_largest_size(looks):
    sightings = [sighting(*look) for look in looks]
    chosen = best(sightings)
    if not sightings:
        assert chosen is None
        return
    assert all(len(chosen.faults) <= len(other.faults) for other in sightings)
    rivals = [other for other in sightings if len(other.faults) == len(chosen.faults)]
    assert chosen.size_px == max(other.size_px for other in rivals)


def test_actors_of_one_asset_are_seen_together_and_usual_ones_not_at_all():
    row = next(row for row, body in enumerate(CAST) if body.id in SCENE.hazard.actors)
    assert groups(SCENE, CAST) == [[row]]
    usual = SCENE.model_copy(update={"hazard": SCENE.hazard.model_copy(update={"actors": {}})})
    assert groups(usual, CAST) == []
    assert drawn(usual, CAST, CORRIDOR, Camera()) is None


def test_a_look_is_stated_for_a_picture_of_480_rows():
    small, large = (
        drawn(SCENE, CAST, CORRIDOR, Camera(width=4 * rows // 3, height=rows))
        for rows in (240, 960)
    )
    assert small.height_px == pytest.approx(large.height_px, rel=0.02)
    assert 0.0 < small.height_px < SCALE_PX
    assert small.distance_m == large.distance_m


def test_a_nearer_body_looks_larger_and_one_behind_another_is_hidden():
    row = groups(SCENE, CAST)[0][0]
    ego, box = CAST[0].solid, CAST[row]
    near = box._replace(solid=replace(box.solid, x=0.5 * (box.solid.x + ego.x)))
    nearer = drawn(SCENE, [*CAST[:row], near, *CAST[row + 1 :]], CORRIDOR, Camera())
    look = drawn(SCENE, CAST, CORRIDOR, Camera())
    assert nearer.size_px > look.size_px
    wall = box._replace(id="wall", solid=replace(near.solid, width=20.0, height=9.0))
    hidden = drawn(SCENE, [*CAST, wall], CORRIDOR, Camera())
    assert (hidden.hidden, hidden.size_px) == (1.0, 0.0)
