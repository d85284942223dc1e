"""Rules of one number: what they learn, and what does not change it."""

import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._bird_sketch import Sketch, SketchBody, SketchLane
from oodscen.errors import UnknownComponent
from oodscen.judging._items import Items
from oodscen.judging._leaderboard.leaderboard import leaderboard
from oodscen.judging._shortcuts.facts import FAR_M, lane_distance, nearest_places, swept_distance
from oodscen.judging._shortcuts.rules import Guess, folds_of, is_audited, rule_calls
from tests.judging.cases import Case
from tests.judging.leaderboard.test_leaderboard import knows

LANE = (SketchLane(kind="driving", direction=1, right=-1.6, left=1.6),)


def road(x: float, y: float, heading: float = 0.0) -> Sketch:
    ego = SketchBody(x=0, y=0, heading_deg=0, length=4.5, width=1.9)
    body = SketchBody(x=x, y=y, heading_deg=heading, length=4.5, width=1.9)
    return Sketch(lanes=LANE, bodies={"ego": ego, "other": body})


@given(st.floats(0.1, 120), st.floats(-8, 8))
def test_a_body_is_in_the_lane_where_its_middle_is(x, y):
    found = lane_distance(road(x, y))
    assert found == (x if abs(y) <= 1.6 else FAR_M)
    assert swept_distance(road(x, y)) == (x if abs(y) < 1.9 else FAR_M)
    assert lane_distance(road(-x, 0)) == swept_distance(road(-x, 0)) == FAR_M


@given(st.lists(st.tuples(st.floats(-120, 120), st.floats(-8, 8)), max_size=6))
def test_the_three_nearest_bodies_ahead_have_places(bodies):
    drawn = road(-1, 0)
    others = {
        str(at): drawn.bodies["other"].model_copy(update={"x": x, "y": y})
        for at, (x, y) in enumerate(bodies)
    }
    found = nearest_places(drawn.model_copy(update={"bodies": drawn.bodies | others}))
    ahead = sorted(place for place in bodies if place[0] > 0)[:3]
    assert list(zip(found[::2], found[1::2], strict=True)) == ahead + [(FAR_M, 0)] * (
        3 - len(ahead)
    )
    assert nearest_places(None) == 3 * [FAR_M, 0]


def test_a_body_across_the_road_reaches_further_aside():
    assert swept_distance(road(10, 2.5)) == FAR_M
    assert swept_distance(road(10, 2.5, 90)) == 10
    assert lane_distance(None) == swept_distance(None) == FAR_M


@settings(max_examples=25)
@given(st.integers(0, 2**32), st.booleans())
def test_a_rule_learns_direction_and_threshold_on_other_paths_whatever_the_order(seed, is_high):
    rng = np.random.default_rng(seed)
    rare = np.repeat([True, False], 60)
    values = (rare == is_high) * 1.0 + rng.random(120) * 0.5
    paths = [f"path {k % 12}" for k in range(120)]
    guess = Guess.of("x", values, rare, folds_of(paths))
    assert guess.balanced(rare) >= 0.95
    order = rng.permutation(120)
    again = Guess.of("x", values[order], rare[order], folds_of([paths[k] for k in order]))
    assert again.is_called.tolist() == guess.is_called[order].tolist()


def test_noise_is_told_no_better_than_by_guessing():
    rng = np.random.default_rng(0)
    rare = np.repeat([True, False], 2_000)
    folds = folds_of([str(k % 80) for k in range(4_000)])
    assert Guess.of("x", rng.random(4_000), rare, folds).balanced(rare) == pytest.approx(
        0.5, abs=0.04
    )


@settings(max_examples=3, deadline=None)
@given(st.integers(0, 2**32))
def test_the_shortcut_of_a_board_is_the_floor_and_does_not_depend_on_the_order(seed):
    case = Case(paths=6, per_path=2)
    for at, one in enumerate(case.episodes):
        seen = {} if one.is_twin else {"last": {"thing": 900}}
        case.episodes[at] = one.model_copy(update={"visible": seen})
    rows = case.verdicts("m", knows)
    board = leaderboard(rows, case.episodes, case.scenarios)
    # Keeping the speed is safe in twins alone, too, but the outcome of an action is no floor.
    assert board.shortcut.model == "shortcut: number of visible actors"
    assert (
        board.shortcut.paired.notice.value == board.shortcut.detection.balanced_accuracy.value == 1
    )
    assert board.floor("detection") == board.shortcut
    assert board.floor("control") is None
    with pytest.raises(UnknownComponent, match="nosuch"):
        board.floor("nosuch")
    rng = random.Random(seed)
    shuffled = [rng.sample(found, len(found)) for found in (rows, case.episodes, case.scenarios)]
    again = leaderboard(*shuffled).shortcut
    hits = [
        (row.model, row.paired.notice.hits, row.detection.alarms.hits)
        for row in (again, board.shortcut)
    ]
    assert hits[0] == hits[1]


def test_scenes_without_ordinary_drives_and_single_paths_are_not_audited():
    case = Case(paths=3, per_path=1)
    kept = [episode for episode in case.episodes if episode.scene_id != "leaf-0-000~twin"]
    scenarios = {scenario.id: scenario for scenario in case.scenarios}
    items = Items.of(kept, scenarios)
    assert is_audited(items).sum() == 4
    assert rule_calls(Items.of(case.episodes[:2], scenarios)) is None
    assert rule_calls(Items.of([], {})) is None
