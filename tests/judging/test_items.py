"""Items and columns of answers: one row per item, missing answers are never wrong ones."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._verdict import Verdict
from oodscen.judging._items import AnswerColumns, Items, Ratio, answer_values, last_by
from tests.judging.cases import Case


@given(st.lists(st.tuples(st.integers(0, 5), st.integers())))
def test_the_last_value_of_a_key_stands_where_the_key_came_first(pairs):
    kept = last_by(pairs, lambda pair: pair[0])
    assert [key for key, _ in kept] == list(dict.fromkeys(key for key, _ in pairs))
    assert dict(kept) == dict(pairs)


def test_every_ordinary_drive_has_its_scene_and_its_path():
    case = Case(paths=3, per_path=2)
    items = Items.of(case.episodes, {scenario.id: scenario for scenario in case.scenarios})
    for row, episode in enumerate(items.episodes):
        owner = int(items.owners[row])
        assert (owner < 0) == (items.kinds[row] == "rare")
        if owner >= 0:
            assert items.episodes[owner].scene_id == episode.scene_id.removesuffix("~twin")
            assert items.clusters[owner] == items.clusters[row]
    assert items.leaf_of("leaf-9-001") == "leaf-9"
    assert items.chance_over(np.zeros(len(items.episodes), np.bool_)) is None


def test_texts_from_elsewhere_are_paths_of_their_own():
    names = ["fog", "fog~twin", "ice", "ice~twin"]
    drives = [Episode(id=name, scene_id=name, status="ok") for name in names]
    truths = {name: Scenario(id=name, text=f"{name} on the road") for name in ("fog", "ice")}
    for known in (truths, {}):
        items = Items.of(drives, known)
        assert items.leaves == items.clusters == ["fog", "fog", "ice", "ice"]
    assert items.leaf_of("smoke~twin") == "smoke"


def test_failed_and_unknown_drives_are_no_items():
    case = Case(paths=1, per_path=2)
    failed = case.episodes[0].model_copy(update={"status": "failed"})
    items = Items.of([failed, *case.episodes[1:]], {})
    assert failed.scene_id not in items.index
    assert int(items.owners[items.index[f"{failed.scene_id}~twin"]]) == -1
    assert set(items.leaves) == {"leaf-0"}


def test_a_verdict_without_answers_is_missing_everywhere():
    case = Case(paths=1, per_path=1)
    items = Items.of(case.episodes, {})
    silent = [
        Verdict(id=drive.id, scene_id=drive.scene_id, model="m", status="failed")
        for drive in case.episodes
    ]
    stranger = Verdict(id="y-001", scene_id="y-001", model="m", is_ood=True)
    sheet = AnswerColumns.of(items, [*silent, stranger])
    for task in ("detection", "open", "closed", "control"):
        assert np.isnan(sheet.right(task, items)).all()
        asked = np.ones(2, np.bool_) if task == "detection" else items.is_scene
        assert (sheet.unanswered(task, items) == asked).all()


def test_a_lane_change_where_keeping_the_speed_is_safe_does_not_fit():
    case = Case(paths=1, per_path=1)
    scene, twin = case.episodes
    verdict = Verdict(
        id=twin.id,
        scene_id=twin.scene_id,
        model="m",
        action="change_lane_left",
        action_is_safe=True,
    )
    margin = twin.actions["keep_speed"].model_copy(update={"margin_m": 5.0})
    spacious = twin.model_copy(update={"actions": {**twin.actions, "keep_speed": margin}})
    assert answer_values(verdict, spacious)["fitting"] == 0.0
    assert answer_values(verdict, scene)["fitting"] == 1.0


def test_a_ratio_leaves_missing_answers_out_of_both_sums():
    values = np.array([1.0, 0.0, np.nan, 1.0])
    ratio = Ratio(values, np.array([True, True, True, False]), most=np.array([2.0, 2.0, 2.0, 2.0]))
    assert (ratio.above.sum(), ratio.below.sum()) == (1.0, 4.0)
