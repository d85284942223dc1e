"""The sketch of a decision, against the traces that it shortens."""

import math
from itertools import pairwise

import pytest

from oodscen import simulate
from oodscen.data import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._episode import ACTIONS
from oodscen.testing._flat import FlatSimulator

SCENE = Scene(
    id="s",
    scenario_id="s",
    map="urban_avenue",
    ego=Ego(speed=10.0),
    actors=tuple(
        Actor(
            id=name,
            asset=asset,
            placement=Placement(ahead_m=ahead, lane=lane, heading_deg=heading),
            behaviour=Behaviour(name=behaviour),
        )
        for name, asset, behaviour, ahead, lane, heading in (
            ("lead", "car", "follow_lane", 30.0, 0, 0.0),
            ("ghost", "car", "wrong_way", 90.0, 1, 0.0),
            ("oncoming", "car", "follow_lane", 60.0, 2, 0.0),
            ("askew", "car", "stand", 45.0, 1, -30.0),
            ("far", "car", "stand", 190.0, 1, 0.0),
        )
    ),
    hazard=Hazard(actors={"ghost": None}),
    decision=Trigger(value=0.5),
)


@pytest.fixture(scope="module")
def result():
    with FlatSimulator() as simulator:
        return simulate(SCENE, simulator, render=False, traces=True)


def test_headings_are_relative_to_the_road(result):
    bodies = result.episode.sketch.bodies
    assert set(bodies) == {"ego", "lead", "ghost", "oncoming", "askew"}
    turned = {name: body.heading_deg for name, body in bodies.items()}
    assert turned == {"ego": 0, "lead": 0, "ghost": 180, "oncoming": 180, "askew": -30}
    assert (bodies["ego"].x, bodies["ego"].y) == (0.0, 0.0)
    assert bodies["lead"].y == 0.0 < bodies["askew"].y < bodies["oncoming"].y


def test_paths_begin_at_the_ego_and_end_where_the_traces_end(result):
    sketch, trace = result.episode.sketch, result.trace
    assert list(sketch.paths) == [name for name in ACTIONS if name in result.rollouts]
    for action, path in sketch.paths.items():
        rollout = result.rollouts[action]
        assert path[:2] == (0.0, 0.0)
        end = (rollout["s"][-1, 0] - trace["s"][-1, 0], rollout["t"][-1, 0] - trace["t"][-1, 0])
        assert path[-2:] == pytest.approx(end, abs=0.051)


def test_only_actors_that_moved_have_an_end(result):
    for action, ends in result.episode.sketch.ends.items():
        rollout = result.rollouts[action]
        moved = {
            name
            for row, name in enumerate(rollout.ids)
            if math.dist(*((rollout["x"][i, row], rollout["y"][i, row]) for i in (0, -1))) > 1.0
        }
        assert set(ends) == moved - {"ego", "far"}


def test_lanes_lie_side_by_side(result):
    lanes = result.episode.sketch.lanes
    assert all(one.left == pytest.approx(two.right) for one, two in pairwise(lanes))
    own = next(lane for lane in lanes if lane.right < 0.0 < lane.left)
    assert (own.kind, own.direction) == ("driving", 1)
