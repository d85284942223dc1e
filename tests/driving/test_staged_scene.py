"""A staged scene knows its bodies at the start, and measures any places that are poses of all bodies."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving import StagedScene
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._staged_scene import lane_centrelines
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import UsageError
from oodscen.protocols import Camera
from oodscen.testing import example_scene
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

SCENE = example_scene()
STAGED = StagedScene(SCENE, FLAT_CATALOGUE)
START = np.array([body.pose for body in STAGED.bodies])


def test_the_ego_comes_first_and_actors_have_all_parameters_of_their_behaviours():
    ego, *others = STAGED.bodies
    assert (ego.id, ego.behaviour, ego.parameters, ego.actor) == ("ego", "", None, None)
    assert (ego.speed, ego.direction, ego.lane) == (SCENE.ego.speed, 1, ego.goal_lane)
    assert [body.actor for body in others] == list(SCENE.actors)
    for body in others:
        kind = FLAT_CATALOGUE.behaviour(body.behaviour)
        assert body.parameters.keys() == kind.parameters.keys()


@given(st.floats(-40.0, 40.0), st.floats(-1.0, 1.0))
def test_bodies_without_heights_stand_on_the_road(ahead, aside):
    moved = START + np.array([ahead, aside, 0.0, 0.0])
    flat = moved[:, [0, 1, 3]]
    assert STAGED.places(flat) == pytest.approx(STAGED.places(moved))
    assert STAGED.gaps(flat) == pytest.approx(STAGED.gaps(moved))
    assert STAGED.off_road(flat) == STAGED.off_road(moved)


MEASURES = {
    "places": STAGED.places,
    "gaps": STAGED.gaps,
    "off_road": STAGED.off_road,
    "draw": lambda poses: STAGED.draw(Camera(width=16, height=12), poses),
}


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize(
    "poses",
    [START[:1], START[:, :2], START * math.nan, START + 1e10, START.astype(str), START[0]],
    ids=["too few", "too narrow", "NaN", "too far", "words", "one row"],
)
def test_poses_that_are_not_those_of_all_bodies_are_refused(measure, poses):
    with pytest.raises(UsageError, match="poses must be those of all bodies"):
        MEASURES[measure](poses)


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_a_centreline_runs_in_the_middle_of_its_lane_in_its_direction_of_travel(road):
    corridor = load_corridor(road)
    lines = lane_centrelines(corridor)
    assert [line.strip for line in lines] == list(corridor.driving)
    for line in lines:
        assert len(line.points) == len(line.widths) > 2
        begin, end = (corridor.locate(*line.points[row]) for row in (0, -1))
        assert (end[0] > begin[0]) == (line.direction > 0)
        middle = len(line.points) // 2
        s, t = corridor.locate(*line.points[middle])
        right, left = corridor.edges(line.strip, s)
        assert t == pytest.approx(0.5 * (right + left), abs=0.05)
        assert line.widths[middle] == pytest.approx(left - right, abs=0.05)
