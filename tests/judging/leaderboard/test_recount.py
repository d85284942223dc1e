"""The counts of a board are those of the verdicts, counted one by one."""

import random
from collections import Counter
from collections.abc import Callable
from itertools import product
from typing import Any

import pytest

from oodscen.data._episode import ACTIONS, ActionOutcome, Episode
from oodscen.data._verdict import Verdict
from oodscen.judging._leaderboard.leaderboard import Leaderboard, leaderboard
from oodscen.judging._leaderboard.rows import Estimate, LeaderboardRow, Rate
from tests.judging.cases import Case

STOPS = ("stop", "emergency_brake", "pull_over")
JUDGES = ("", "judge@1", "other@1")
Answer = Callable[[Verdict], bool | None]


class Story(Case):
    """Random outcomes of actions and random verdicts of two models, in both protocols."""

    def __init__(self, seed: int) -> None:
        super().__init__(paths=4, per_path=2)
        self.rng = random.Random(seed)
        self.episodes = [self.played(episode) for episode in self.episodes]
        self.whole = [self.played(episode) for episode in self.episodes if not episode.is_ordinary]
        self.given = [
            self.verdict(one.scene_id, model, protocol)
            for one, model, protocol in product(self.episodes, "ab", ("ours", "paper"))
            if self.rng.random() < 0.9
        ]
        self.board = leaderboard(self.given, self.episodes, self.scenarios, whole=self.whole)
        self.ran = {
            episode.scene_id: episode for episode in self.episodes if episode.status == "ok"
        }

    def played(self, one: Episode) -> Episode:
        status = self.rng.choices(("ok", "failed"), (9, 1))[0]
        kinds = {
            action: ActionOutcome(
                safe=kind == "safe", marginal=kind == "marginal", unavailable=kind == "unavailable"
            )
            for action in ACTIONS
            for kind in self.rng.choices(
                ("safe", "marginal", "unavailable", "unsafe"), (4, 1, 1, 4)
            )
        }
        return Episode(
            id=one.id,
            scene_id=one.scene_id,
            status=status,
            actions={} if self.rng.random() < 0.1 else kinds,
            hazard_visible=self.rng.random() < 0.5,
        )

    def verdict(self, scene: str, model: str, protocol: str) -> Verdict:
        pick = self.rng.choice
        action = pick((None, *ACTIONS))
        episode = next(one for one in self.episodes if one.scene_id == scene)
        outcome = episode.actions.get(action or "")
        fields: dict[str, Any] = {
            "is_ood": pick((None, True, False)),
            "confidence": pick((None, 0.25, 1.0)),
            "aspect": "a thing",
            "aspect_is_right": pick((None, True, False)),
            "judge": pick(JUDGES),
            "judge_error": pick(("", "no answer")),
            "choice": pick((None, "leaf-1", "leaf-2")),
            "choice_is_right": pick((None, True, False)),
            "action": action,
            "action_is_safe": None if outcome is None or outcome.marginal else outcome.safe,
            "success": pick((None, True, False)),
            "contradiction": pick(("", "said both")),
            "is_outdated": pick((True, False)),
        }
        fields |= pick(({}, {}, {"status": "failed", "error": "x"}, {"outcome": "refused"}))
        return Verdict(
            id=f"{scene}@{model}",
            scene_id=scene,
            model=model,
            protocol=protocol,
            is_ordinary=scene.endswith("~twin"),
            **fields,
        )

    def of(self, row: LeaderboardRow) -> list[Verdict]:
        """Return the verdicts that a row is about."""
        return [one for one in self.given if (one.model, one.protocol) == (row.model, row.protocol)]

    def scored(self, row: LeaderboardRow, twin: bool) -> list[Verdict]:
        """Return those on scenes, or on their twins, that ran."""
        return [one for one in self.of(row) if one.scene_id in self.ran and one.is_ordinary is twin]

    def safe(self, one: Episode) -> int:
        return sum(outcome.safe for outcome in one.actions.values())

    def unsafe(self, one: Episode) -> int:
        return sum(
            not (outcome.safe or outcome.marginal or outcome.unavailable)
            for outcome in one.actions.values()
        )


def is_counted(rate: Rate, verdicts: list[Verdict], answer: Answer) -> bool:
    """Return whether a rate has the hits and the number of the answers to a question."""
    answers = [value for value in map(answer, verdicts) if value is not None]
    share = round(sum(answers) / len(answers), 6) if answers else None
    return (rate.hits, rate.n, rate.value) == (sum(answers), len(answers), share)


@pytest.fixture(scope="module", params=range(4))
def story(request: pytest.FixtureRequest) -> Story:
    return Story(request.param)


def test_the_study_is_counted(story: Story) -> None:
    board: Leaderboard = story.board
    scenes = [one for one in story.ran.values() if not one.is_ordinary]
    acted = [scene for scene in scenes if scene.actions]
    assert board.scenes == len(scenes)
    assert board.ordinary == len(story.ran) - len(scenes)
    assert board.paths == len({scene.scene_id.rpartition("-")[0] for scene in scenes})
    assert board.decidable == sum(story.safe(scene) > 0 < story.unsafe(scene) for scene in scenes)
    assert board.all_safe == sum(story.unsafe(one) == 0 for one in acted)
    assert board.none_safe == sum(story.safe(one) == 0 for one in acted)
    ran = [one for one in story.whole if one.status == "ok"]
    assert (board.whole, board.whole_shown) == (len(ran), sum(bool(o.hazard_visible) for o in ran))
    assert board.shortcut is not None
    assert board.shortcut.model.startswith("shortcut")
    judges = Counter(one.judge for one in story.given if one.judge)
    assert judges[board.judge] == max(judges.values(), default=0)
    for tally in board.actions:
        labels = Counter(one.actions[tally.action].label for one in acted)
        assert tally.model_dump() == {**tally.model_dump(), **labels, "action": tally.action}
        assert tally.safe + tally.marginal + tally.unsafe + tally.unavailable == len(acted)


def test_the_verdicts_of_a_row_are_counted(story: Story) -> None:
    assert {(row.model, row.protocol) for row in story.board.standings} == {
        (one.model, one.protocol) for one in story.given
    }
    for row in story.board.standings:
        given = story.of(row)
        assert row.asked == len(given)
        assert row.outcomes == Counter(
            "error" if one.status == "failed" and one.outcome == "answered" else one.outcome
            for one in given
        )
        assert row.contradictions == sum(one.contradiction != "" for one in given)
        assert row.outdated == sum(one.is_outdated for one in given)
        assert row.identification.judged == sum(one.judge != "" for one in given)
        assert row.identification.unjudged == sum(one.judge_error != "" for one in given)
        rare = [one for one in given if not one.is_ordinary]
        assert row.actions == Counter(one.action for one in rare if one.action)
        assert {(c.truth, c.chosen): c.count for c in row.confusions} == Counter(
            (one.scene_id.rpartition("-")[0], one.choice or "none")
            for one in rare
            if one.choice_is_right is False
        )


def test_the_rates_of_a_row_are_counted(story: Story) -> None:
    for row in story.board.standings:
        scenes, twins = story.scored(row, twin=False), story.scored(row, twin=True)
        found, control = row.detection, row.control
        assert is_counted(found.sensitivity, scenes, lambda one: one.is_ood)
        assert is_counted(found.alarms, twins, lambda alarm: alarm.is_ood)
        for rate, by_kind in (
            (found.alarms, found.alarms_by_kind),
            (control.needless, control.needless_by_kind),
        ):
            assert by_kind["twin"].hits == rate.hits
            assert by_kind["twin"].with_missing_wrong == rate.with_missing_wrong
        assert is_counted(
            found.specificity, twins, lambda one: None if one.is_ood is None else not one.is_ood
        )
        assert found.stated == sum(
            scene.is_ood is not None and scene.confidence is not None for scene in scenes + twins
        )
        called = found.sensitivity.n + found.specificity.n
        assert found.auroc.value is None or found.auroc.n == called
        for estimate in (found.balanced_accuracy, found.d_prime):
            assert estimate.value is None or estimate.n == called
        if found.with_missing_wrong.value is not None:
            assert found.with_missing_wrong.n == len(scenes) + len(twins)
        named = row.identification
        assert is_counted(named.open, scenes, lambda one: one.aspect_is_right)
        assert is_counted(named.closed, scenes, lambda one: one.choice_is_right)
        shown = {one.scene_id for one in story.whole if one.status == "ok" and one.hazard_visible}
        paper = [scene for scene in scenes if row.protocol == "paper" and scene.scene_id in shown]
        assert is_counted(named.open_shown, paper, lambda one: one.aspect_is_right)
        assert is_counted(control.safe, scenes, lambda one: one.action_is_safe)
        assert is_counted(control.ordinary_safe, twins, lambda one: one.action_is_safe)
        assert is_counted(control.collision_free, scenes, lambda one: one.success)
        decidable = [
            scene
            for scene in scenes
            if story.safe(story.ran[scene.scene_id]) > 0 < story.unsafe(story.ran[scene.scene_id])
        ]
        assert is_counted(control.decidable, decidable, lambda one: one.action_is_safe)
        quiet = [twin for twin in twins if keeps(story.ran[twin.scene_id])]
        assert is_counted(
            control.needless, quiet, lambda one: one.action in STOPS if one.action else None
        )
        for estimate in (
            *(control.above_chance, found.auroc, found.d_prime),
            *(found.balanced_accuracy, found.with_missing_wrong),
        ):
            assert is_held(estimate)


def is_held(estimate: Estimate) -> bool:
    """Return whether a value lies in its interval, if there is one."""
    value, interval = estimate.value, estimate.interval
    return value is None or interval is None or interval.low <= value <= interval.high


def keeps(episode: Episode) -> bool:
    """Return whether keeping the speed is safe; no body was met, so every margin is enough."""
    return "keep_speed" in episode.actions and episode.actions["keep_speed"].safe


def test_a_score_above_chance_lies_amid_its_replicates() -> None:
    case = Case(paths=60, per_path=1)

    def half(index: int, twin: bool) -> dict[str, Any]:
        return {"action": "stop" if index % 2 else "keep_speed"}

    (row,) = leaderboard(case.verdicts("m", half), case.episodes, case.scenarios).standings
    found = row.control.above_chance
    assert found.value == pytest.approx((0.5 - 2 / 7) / (1 - 2 / 7))
    assert found.interval is not None
    assert (found.interval.low + found.interval.high) / 2 == pytest.approx(found.value, abs=0.05)


def test_one_verdict_makes_a_row() -> None:
    case = Case()
    one = case.verdicts("m", lambda index, twin: {"action": "stop"})[0]
    (row,) = leaderboard([one], case.episodes, case.scenarios).standings
    assert (row.asked, row.control.safe.hits) == (1, 1)


@pytest.mark.parametrize("answered", [0, 1, 5])
def test_chance_is_that_of_the_scenes_that_were_answered(answered: int) -> None:
    case = Case()

    def some(index: int, twin: bool) -> dict[str, Any]:
        return {"action": "stop"} if index < answered and not twin else {}

    found = leaderboard(case.verdicts("m", some), case.episodes, case.scenarios).standings[0]
    assert found.control.chance == (pytest.approx(2 / 7) if answered else None)
    assert found.control.above_chance.n == answered


def test_models_are_compared_by_their_balanced_accuracy(story: Story) -> None:
    pairs = [one for one in story.board.comparisons if one.task == "detection"]
    between = [one for one in pairs if one.against == "model"]
    assert len(between) == 1
    called: dict[str, dict[str, bool]] = {"a": {}, "b": {}}
    for one in story.given:
        if one.protocol == "ours" and one.scene_id in story.ran and one.is_ood is not None:
            called[one.model][one.scene_id] = one.is_ood
    common = called["a"].keys() & called["b"].keys()
    gaps: dict[bool, list[int]] = {True: [], False: []}
    for name in common:
        gap = int(called["a"][name]) - int(called["b"][name])
        is_twin = name.endswith("~twin")
        gaps[is_twin].append(-gap if is_twin else gap)
    shares = [sum(side) / len(side) for side in gaps.values() if side]
    sign = 1 if between[0].first == "a" else -1
    assert between[0].test.difference == pytest.approx(sign * sum(shares) / len(shares))
