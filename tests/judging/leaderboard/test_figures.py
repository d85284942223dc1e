"""A pair is wrong if one half is, else missing if one half is, else neutral if one half is."""

import itertools

import pytest

from oodscen.data._episode import ActionOutcome
from oodscen.data._pairing import demand_id
from oodscen.judging._items import AnswerColumns, Items
from oodscen.judging._leaderboard.figures import PairColumns, figures
from tests.judging.cases import Case

STATES = ("right", "wrong", "neutral", "missing")
MARGINAL = ActionOutcome(safe=False, marginal=True)


def expected(halves: tuple[str, str]) -> str:
    return next(state for state in ("wrong", "missing", "neutral", "right") if state in halves)


def columns(scene: str, twin: str) -> tuple[Items, AnswerColumns]:
    case = Case(paths=1, per_path=1)

    def say(index: int, is_twin: bool) -> dict[str, object]:
        state = twin if is_twin else scene
        if state == "missing":
            return {"outcome": "refused", "is_ood": None}
        fields: dict[str, object] = {"is_ood": (state == "right") is not is_twin}
        if state == "neutral":
            return fields | {"action": "slow_down", "action_is_safe": None}
        return fields | {"action": "keep_speed" if (state == "right") is is_twin else "stop"}

    verdicts = case.verdicts("m", say)
    episodes = [
        episode.model_copy(update={"actions": {**episode.actions, "slow_down": MARGINAL}})
        for episode in case.episodes
    ]
    items = Items.of(episodes, {scenario.id: scenario for scenario in case.scenarios})
    return items, AnswerColumns.of(items, verdicts)


@pytest.mark.parametrize("halves", list(itertools.product(STATES, STATES)), ids="-".join)
def test_a_pair_is_as_good_as_its_worse_half(halves: tuple[str, str]) -> None:
    items, sheet = columns(*halves)
    act = figures(items, sheet)["act-both"]
    state = expected(halves)
    assert act.is_there.any() == (state in ("right", "wrong"))
    assert act.missing(sheet).any() == (state == "missing")
    assert act.above.sum() == (state == "right")


@pytest.mark.parametrize(
    "halves", list(itertools.product(("right", "wrong", "missing"), repeat=2)), ids="-".join
)
def test_noticing_too(halves: tuple[str, str]) -> None:
    items, sheet = columns(*halves)
    notice = figures(items, sheet)["notice-both"]
    state = expected(halves)
    assert notice.is_there.any() == (state != "missing")
    assert notice.missing(sheet).any() == (state == "missing")
    assert notice.above.sum() == (state == "right")


def test_a_pair_whose_scene_was_not_asked_about_is_not_there() -> None:
    items, _ = columns("right", "wrong")
    case = Case(paths=1, per_path=1)
    alone = [v for v in case.verdicts("m", lambda index, twin: {"is_ood": True}) if v.is_ordinary]
    found = figures(items, AnswerColumns.of(items, alone))
    for name in ("notice-both", "act-both"):
        assert not found[name].is_there.any()
        assert not found[name].missing(AnswerColumns.of(items, alone)).any()


def test_each_kind_of_ordinary_drive_is_judged_apart() -> None:
    case = Case(paths=1, per_path=1)
    scene, twin = case.episodes
    name = demand_id(scene.scene_id)
    demand = twin.model_copy(update={"id": name, "scene_id": name})
    items = Items.of([scene, twin, demand], {scenario.id: scenario for scenario in case.scenarios})
    about_scene, about_twin = (
        verdict.model_copy(update={"action": "keep_speed", "action_is_safe": True})
        for verdict in case.verdicts("m", lambda index, is_twin: {})
    )
    asked = {"id": f"{name}@m", "scene_id": name}
    stops = {"action": "stop", "action_is_safe": False}
    sheet = AnswerColumns.of(
        items, [about_scene, about_twin, about_twin.model_copy(update=asked | stops)]
    )
    found = {kind: PairColumns.of(items, sheet, kind).act[0] for kind in ("", "twin", "demand")}
    assert found == {"": 0.0, "twin": 1.0, "demand": 0.0}
