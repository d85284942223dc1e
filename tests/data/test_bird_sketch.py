"""The sketch of a decision, against the traces that it shortens."""

from itertools import pairwise

import numpy as np
import pytest

from oodscen import simulate
from oodscen.data import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._episode import ACTIONS
from oodscen.testing._flat import FlatSimulator

TENTH = 0.051
"""Rounding of the sketch, m."""
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
    assert bodies["lead"].y == 0.0
    assert bodies["lead"].y < bodies["askew"].y < bodies["oncoming"].y


def from_ego(result, action, row=0):
    """Return the way of a body after the decision, [n, 2], from where the ego was then."""
    rollout, trace = result.rollouts[action], result.trace
    return np.stack([rollout[axis][:, row] - trace[axis][-1, 0] for axis in ("s", "t")], axis=1)


def test_paths_begin_at_the_ego_and_end_where_the_traces_end(result):
    sketch = result.episode.sketch
    assert list(sketch.paths) == [name for name in ACTIONS if name in result.rollouts]
    for action, path in sketch.paths.items():
        assert path[:2] == (0.0, 0.0)
        assert path[-2:] == pytest.approx(from_ego(result, action)[-1], abs=TENTH)


def test_paths_have_a_point_a_second_until_the_ego_stops(result):
    per_second = round(1.0 / FlatSimulator.dt)
    for action, path in result.episode.sketch.paths.items():
        points = np.reshape(path, (-1, 2))
        seconds = from_ego(result, action)[::per_second]
        moving = len(points) - 1
        np.testing.assert_allclose(points[:-1], seconds[:moving], atol=TENTH)
        np.testing.assert_allclose(
            seconds[moving:], np.tile(points[-1], (len(seconds) - moving, 1)), atol=TENTH
        )
    stops = result.episode.sketch.paths["emergency_brake"]
    assert len(stops) < len(result.episode.sketch.paths["keep_speed"])


def test_actors_that_moved_have_the_end_of_their_trace(result):
    sketch = result.episode.sketch
    assert set(sketch.ends) == set(result.rollouts)
    for action, ends in sketch.ends.items():
        assert set(ends) == {"lead", "ghost", "oncoming"}
        for name, (x, y, heading) in ends.items():
            row = result.rollouts[action].ids.index(name)
            assert (x, y) == pytest.approx(from_ego(result, action, row)[-1], abs=TENTH)
            assert heading == sketch.bodies[name].heading_deg, "on a straight road"


def test_lanes_lie_side_by_side(result):
    lanes = result.episode.sketch.lanes
    assert all(one.left == pytest.approx(two.right) for one, two in pairwise(lanes))
    own = next(lane for lane in lanes if lane.right < 0.0 < lane.left)
    assert (own.kind, own.direction) == ("driving", 1)
