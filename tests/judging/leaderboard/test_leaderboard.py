import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._episode import ActionOutcome, Episode
from oodscen.data._verdict import Verdict
from oodscen.errors import UsageError
from oodscen.judging._leaderboard.leaderboard import Leaderboard, _rank, leaderboard
from oodscen.judging._leaderboard.rows import (
    ActionScore,
    Estimate,
    LeaderboardRow,
    PairedScores,
    Rate,
)
from oodscen.judging._leaderboard.sentences import sentences
from tests.judging.cases import Case


def knows(index: int, twin: bool) -> dict[str, Any]:
    return {
        "is_ood": not twin,
        "confidence": 0.9,
        "aspect_is_right": None if twin else True,
        "choice": "none" if twin else "x",
        "choice_is_right": True,
        "action": "keep_speed" if twin else "stop",
    }


def stubborn(index: int, twin: bool) -> dict[str, Any]:
    return {
        "is_ood": True,
        "aspect_is_right": None if twin else False,
        "choice": "leaf-9",
        "choice_is_right": False,
        "action": "emergency_brake",
    }


def careless(index: int, twin: bool) -> dict[str, Any]:
    return {**knows(index, twin), "action": "keep_speed", "is_ood": index % 2 == 0 and not twin}


def board(case: Case, *verdicts: list[Verdict]) -> Leaderboard:
    return leaderboard([v for found in verdicts for v in found], case.episodes, case.scenarios)


def test_who_knows_scores_all_and_a_constant_what_it_must() -> None:
    case = Case()
    found = board(
        case,
        case.verdicts("m", knows),
        case.verdicts("constant:emergency_brake", stubborn, "reference"),
    )
    model, constant = found.standings
    assert (model.detection.balanced_accuracy.value, model.detection.auroc.value) == (1, 1)
    assert (model.identification.open.hits, model.identification.closed.hits) == (24, 24)
    assert (model.control.safe.value, model.control.above_chance.value) == (1, 1)
    assert model.control.needless.value == 0
    assert constant.detection.balanced_accuracy.value == 0.5
    assert constant.detection.d_prime.value == pytest.approx(0)
    assert constant.detection.auroc.value == 0.5
    assert constant.control.safe.value == 1
    assert constant.control.needless.value == 1
    assert constant.confusions[0].count == 4
    assert (found.scenes, found.ordinary, found.paths, found.decidable) == (24, 24, 6, 24)
    assert found.chance == pytest.approx(2 / 7)
    assert {(a.action, a.safe, a.unavailable) for a in found.actions} >= {
        ("stop", 24, 0),
        ("pull_over", 0, 24),
    }


def test_scenes_without_a_choice_are_counted_apart() -> None:
    case = Case()
    for place, outcome in ((0, SAFE), (2, UNSAFE), (4, UNSAFE)):
        old = case.episodes[place]
        case.episodes[place] = old.model_copy(
            update={"actions": dict.fromkeys(old.actions, outcome)}
        )
    found = board(case, case.verdicts("m", careless))
    assert (found.scenes, found.all_safe, found.none_safe, found.decidable) == (24, 1, 2, 21)


SAFE, UNSAFE = ActionOutcome(safe=True), ActionOutcome(safe=False)


def test_the_last_verdict_and_episode_of_an_item_count() -> None:
    case = Case()
    wrong, right = case.verdicts("m", careless), case.verdicts("m", knows)
    found = leaderboard(wrong + right, case.episodes * 2, case.scenarios)
    assert found == leaderboard(right, case.episodes, case.scenarios)


def test_what_was_not_answered_is_missing_and_never_wrong() -> None:
    case = Case()

    def shy(index: int, twin: bool) -> dict[str, Any]:
        if index % 3 == 0:
            return {"status": "failed", "outcome": "refused", "error": "I cannot help with that."}
        return knows(index, twin)

    row = board(case, case.verdicts("m", shy)).standings[0]
    assert row.outcomes == {"answered": 32, "refused": 16}
    assert (row.control.safe.n, row.control.safe.missing, row.control.safe.value) == (16, 8, 1)
    assert (row.detection.specificity.n, row.detection.specificity.missing) == (16, 8)
    for group in row.groups:
        for rate in (group.detected, group.open, group.closed, group.safe):
            assert rate.with_missing_wrong == pytest.approx(rate.hits / group.scenes, abs=1e-6)


def test_a_model_that_answers_only_what_is_easy_is_ranked_by_its_worst_case() -> None:
    case = Case(paths=12)

    def picky(index: int, twin: bool) -> dict[str, Any]:
        if index % 2 == 0:
            return {"status": "failed", "outcome": "refused", "error": "no"}
        return knows(index, twin)

    def fair(index: int, twin: bool) -> dict[str, Any]:
        return {**knows(index, twin), **({"action": "keep_speed"} if index % 4 == 0 else {})}

    found = board(case, case.verdicts("picky", picky), case.verdicts("fair", fair))
    assert found.standings[0].model == "fair"
    row = found.standings[1]
    assert (row.control.safe.value, row.control.safe.with_missing_wrong) == (1, 0.5)
    assert (row.paired.act.value, row.paired.act.with_missing_wrong, row.paired.act.missing) == (
        1,
        0.5,
        24,
    )
    assert "counted as wrong: 50" in " ".join(sentences(found))


@given(st.integers(0, 2**16 - 1), st.integers(0, 2**16 - 1))
@settings(max_examples=5, deadline=None)
def test_the_worst_case_is_that_of_a_model_that_answered_wrongly(silent: int, wrong: int) -> None:
    case = Case(paths=16, per_path=1)

    def says(is_silent_wrong: bool):
        def fields(index: int, twin: bool) -> dict[str, Any]:
            if silent >> index & 1:
                if not is_silent_wrong:
                    return {"status": "failed", "outcome": "refused", "error": "no"}
                return {**stubborn(index, twin), "action": "keep_speed", "is_ood": twin}
            return knows(index, twin) if wrong >> index & 1 else careless(index, twin)

        return fields

    shy, sure = (board(case, case.verdicts("m", says(one))).standings[0] for one in (False, True))
    assert (
        shy.control.safe.with_missing_wrong
        == sure.control.safe.value
        == sure.control.safe.with_missing_wrong
    )
    assert shy.identification.closed.with_missing_wrong == sure.identification.closed.value
    assert (
        shy.detection.with_missing_wrong
        == sure.detection.with_missing_wrong
        == sure.detection.balanced_accuracy
    )
    assert shy.control.needless.with_missing_wrong == pytest.approx(
        (shy.control.needless.hits + shy.control.needless.missing) / 16
    )


def test_rows_are_ranked_by_pairs_then_by_safe_actions_and_what_is_unknown_is_zero() -> None:
    def row(model: str, act: float | None, safe: float | None, **fields: Any) -> LeaderboardRow:
        return LeaderboardRow(
            model=model,
            paired=PairedScores(act=Rate(with_missing_wrong=act)),
            control=ActionScore(safe=Rate(with_missing_wrong=safe)),
            **fields,
        )

    ranked = [
        row("h", 0.25, 0.5),
        row("g", 0.25, None),
        row("f", 0.0, 0.75),
        row("c", 0.0, 0.0),
        row("d", None, None),
        row("e", 0.0, None),
        row("b", 1.0, 1.0, protocol="paper"),
        row("a", 1.0, 1.0, kind="reference"),
    ]
    assert sorted(random.Random(1).sample(ranked, len(ranked)), key=_rank) == ranked


def test_models_are_compared_pairwise_and_with_the_best_reference() -> None:
    case = Case(paths=12)
    found = board(
        case,
        case.verdicts("good", knows),
        case.verdicts("careless", careless),
        case.verdicts("constant:stop", stubborn, "reference"),
        case.verdicts("oracle", knows, "reference"),
    )
    control = {(c.first, c.second): c for c in found.comparisons if c.task == "control"}
    assert set(control) == {
        ("good", "careless"),
        ("good", "constant:stop"),
        ("careless", "constant:stop"),
    }
    assert control["good", "careless"].test.difference == 1
    assert control["good", "careless"].p_clustered_holm == pytest.approx(2 / 2**12)
    assert control["good", "constant:stop"].p_clustered_holm == 1
    detection = [c for c in found.comparisons if c.task == "detection" and c.against == "model"]
    assert detection[0].test.n == 96
    floor = found.floor("control")
    assert floor is not None
    assert floor.model == "constant:stop"


def test_groups_cover_the_tree_and_say_what_chance_scores() -> None:
    case = Case()
    groups = board(case, case.verdicts("m", careless)).standings[0].groups
    by_level = {
        level: [g for g in groups if g.level == level] for level in ("class", "family", "path")
    }
    assert [len(found) for found in by_level.values()] == [2, 3, 6]
    for found in by_level.values():
        assert sum(group.scenes for group in found) == 24
        assert sum(group.safe.n for group in found) == 24
    assert by_level["path"][0].parent == "Family 0"
    assert all(group.chance == pytest.approx(2 / 7) for group in groups)


def test_likeness_within_paths_is_measured() -> None:
    case = Case()

    def by_path(index: int, twin: bool) -> dict[str, Any]:
        return {"action": "stop" if index // 4 % 2 else "keep_speed"}

    found = board(case, case.verdicts("m", by_path), case.verdicts("other", careless))
    assert found.icc == pytest.approx(1)
    (row,) = (standing for standing in found.standings if standing.model == "m")
    interval = row.control.safe.interval
    assert interval is not None
    assert interval.method == "cluster bootstrap"


def test_the_greatest_likeness_of_a_model_counts_and_that_of_references_only_without_models() -> (
    None
):
    case = Case()

    def by_path(index: int, twin: bool) -> dict[str, Any]:
        return {"action": "stop" if index // 4 % 2 else "keep_speed"}

    def by_scene(index: int, twin: bool) -> dict[str, Any]:
        return {"action": "stop" if index % 2 else "keep_speed"}

    mixed = case.verdicts("mixed", by_scene)
    alike = case.verdicts("alike", by_path)
    random = case.verdicts("random", by_path, "reference")
    assert board(case, mixed).icc == board(case, mixed, random).icc == 0
    assert board(case, random).icc == pytest.approx(1)
    for models in ((mixed, alike), (alike, mixed)):
        assert board(case, *models).icc == pytest.approx(1)


def test_protocols_are_rows_of_their_own() -> None:
    case = Case()
    papers = [v.model_copy(update={"protocol": "paper"}) for v in case.verdicts("m", careless)]
    found = board(case, case.verdicts("m", knows), papers)
    assert [(row.model, row.protocol) for row in found.standings] == [("m", "ours"), ("m", "paper")]
    assert not any(comparison.against == "model" for comparison in found.comparisons)


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 2**32))
def test_any_verdicts_make_a_board_that_does_not_depend_on_their_order(seed: int) -> None:
    rng = random.Random(seed)
    case = Case(paths=5, per_path=2)

    def anything(index: int, twin: bool) -> dict[str, Any]:
        full = {**stubborn(index, twin), "action": rng.choice(["stop", "keep_speed", "pull_over"])}
        return {key: value for key, value in full.items() if rng.random() < 0.7}

    verdicts = [*case.verdicts("a", anything), *case.verdicts("b", anything)]
    shuffled = rng.sample(verdicts, len(verdicts))
    one = leaderboard(verdicts, case.episodes, case.scenarios)
    two = leaderboard(shuffled, case.episodes, case.scenarios)
    assert one.standings == two.standings
    assert {
        c.model_copy(update={"first": "", "second": ""}).to_json() for c in one.comparisons
    } == {c.model_copy(update={"first": "", "second": ""}).to_json() for c in two.comparisons}
    assert Leaderboard.parse(one.to_json()) == one


def test_nothing_at_all_is_an_empty_board() -> None:
    assert leaderboard([], [], []) == Leaderboard()
    case = Case()
    failed = [Episode(id="x", scene_id="x", status="failed")]
    assert board(case, []).standings == ()
    alone = leaderboard(case.verdicts("m", knows), failed, [])
    assert alone.standings[0].control.safe.n == 0


def test_the_answer_says_what_was_not_answered_and_not_asked() -> None:
    case = Case()
    verdicts = case.verdicts("m", knows)
    mute = [
        v.model_copy(
            update={
                "status": "failed",
                "outcome": "refused",
                "action": None,
                "action_is_safe": None,
            }
        )
        for v in verdicts[:3]
    ]
    found = board(case, [*mute, *verdicts[3:-1], *case.verdicts("n", knows)])
    words = " ".join(sentences(found))
    assert "n was asked" not in words, "it was asked all that anybody was"
    assert f"m was asked about {len(verdicts) - 1} of the {len(verdicts)}" in words
    assert f"left a question unanswered in 3 of {len(verdicts) - 1}" in words


def test_both_halves_must_be_right() -> None:
    case = Case(paths=12)
    found = board(
        case,
        case.verdicts("good", knows),
        case.verdicts("careless", careless),
        case.verdicts("constant:emergency_brake", stubborn, "reference"),
        case.verdicts("oracle", knows, "reference"),
        case.verdicts("good without pictures", stubborn),
    )
    good, careless_row = (found.standing(name) for name in ("good", "careless"))
    oracle, constant = (found.standing(name) for name in ("oracle", "constant:emergency_brake"))
    for row in (good, oracle):
        assert (row.paired.notice.value, row.paired.act.value, row.paired.drop.value) == (1, 1, 0)
    assert (constant.paired.notice.value, constant.paired.act.value) == (0, 0)
    assert constant.detection.alarms.value == constant.control.needless.value == 1
    assert (careless_row.paired.notice.value, careless_row.paired.act.value) == (0.5, 0)
    assert careless_row.paired.drop.value == 1
    for gains in (good.paired.over_blind, good.paired.over_withheld):
        assert [(gain.figure, gain.difference.value) for gain in gains] == [
            ("notice", 1),
            ("act", 1),
        ]
    assert good.paired.over_blind[0].against == "constant:emergency_brake"
    assert set(good.detection.alarms_by_kind) == {"twin"}


def test_a_pair_with_one_wrong_half_is_wrong_whatever_a_marginal_action_would_score() -> None:
    case = Case()
    verdicts = [
        verdict
        if verdict.is_ordinary
        else verdict.model_copy(update={"action_is_safe": None, "action_is_marginal": True})
        for verdict in case.verdicts("m", stubborn)
    ]
    episodes = [
        episode
        if episode.is_ordinary
        else episode.model_copy(update={"actions": dict.fromkeys(episode.actions, MARGINAL)})
        for episode in case.episodes
    ]
    paired = leaderboard(verdicts, episodes, case.scenarios).standings[0].paired
    assert (paired.act.value, paired.act.missing) == (0.0, 0)
    assert paired.act_by_kind["twin"] == paired.act


MARGINAL = ActionOutcome(safe=False, marginal=True)


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from(["twin", "demand"]))
def test_a_half_is_at_least_as_often_right_as_both(seed: int, kind: str) -> None:
    rng = random.Random(seed)
    case = Case(paths=5, per_path=3)
    case.episodes += [
        episode.model_copy(update={"id": f"{episode.scene_id[:-5]}~{kind}", "scene_id": f"{episode.scene_id[:-5]}~{kind}"})
        for episode in case.episodes
        if episode.is_twin and kind != "twin"
    ]  # fmt: skip
    verdicts = []
    for episode in case.episodes:
        action = rng.choice(["stop", "keep_speed", "slow_down"])
        safe = episode.actions[action].safe if rng.random() < 0.9 else None
        verdicts.append(
            Verdict(
                id=f"{episode.id}@m", scene_id=episode.scene_id, model="m", is_ordinary=episode.is_ordinary,
                is_ood=rng.random() < 0.5, action=action, action_is_safe=safe,
            )
        )  # fmt: skip
    found = leaderboard(verdicts, case.episodes, case.scenarios)
    row = found.standings[0]
    paired = row.paired
    assert 0 <= (paired.notice.value or 0) <= (row.detection.sensitivity.value or 0)
    assert (paired.act.with_missing_wrong or 0) <= 1
    assert paired.act.missing == 0  # an action that scores neither way is not a missing answer
    assert paired.drop.value is None or -1 <= paired.drop.value <= 1
    assert set(row.control.needless_by_kind) == {"twin", kind}
    assert found.ordinary == len(case.episodes) - found.scenes


def test_figures_of_detection_lie_in_their_intervals() -> None:
    case = Case(paths=24)

    def sometimes(index: int, twin: bool) -> dict[str, Any]:
        return {**knows(index, twin), "is_ood": index % 5 < 2 if twin else index % 3 < 2}

    detection = board(case, case.verdicts("m", sometimes)).standings[0].detection
    for found in (detection.balanced_accuracy, detection.auroc):
        assert 0 <= found.interval.low <= found.value <= found.interval.high <= 1
    found = detection.d_prime
    assert found.interval.low <= found.value <= found.interval.high


def test_a_board_tells_its_seed() -> None:
    assert leaderboard([], [], [], seed=7).seed == 7


@pytest.mark.parametrize("seed", [-1, 1.5, "one"])
def test_a_seed_is_a_whole_number_though_nothing_is_resampled(seed: Any) -> None:
    with pytest.raises(UsageError):
        leaderboard([], [], [], seed=seed)


def test_models_under_the_papers_protocol_alone_are_models() -> None:
    case = Case()
    verdicts = [
        v.model_copy(update={"protocol": "paper"})
        for v in case.verdicts("m", knows)
        if not v.is_ordinary
    ]
    words = " ".join(sentences(board(case, verdicts)))
    assert "paper's protocol only" in words
    assert "No vision-language model" not in words


def test_the_worst_case_of_a_figure_stands_beside_it() -> None:
    case = Case()
    silent = [
        v.model_copy(update={"action": None, "action_is_safe": None})
        for v in case.verdicts("m", knows)
    ]
    words = " ".join(sentences(board(case, silent)))
    assert "acts rightly" not in words
    assert "counted as wrong" not in words


def test_a_model_without_ordinary_drives_is_not_praised_for_noticing() -> None:
    case = Case()
    verdicts = [v for v in case.verdicts("m", knows) if not v.is_ordinary]
    words = " ".join(sentences(board(case, verdicts)))
    assert "whoever always says so" in words


@pytest.mark.parametrize("is_ordinary", [False, True])
def test_scenes_alone_or_ordinary_drives_alone_tell_nothing_of_detection(is_ordinary: bool) -> None:
    case = Case()
    verdicts = [v for v in case.verdicts("m", knows) if v.is_ordinary is is_ordinary]
    found = board(case, verdicts).standings[0].detection
    for figure in (found.d_prime, found.auroc, found.balanced_accuracy, found.with_missing_wrong):
        assert figure == Estimate()


def test_pairs_hold_the_ordinary_drives_that_were_asked_about() -> None:
    case = Case()
    verdicts = case.verdicts("m", knows)
    case.episodes += [
        episode.model_copy(
            update={"id": f"{episode.id}~demand", "scene_id": f"{episode.scene_id}~demand"}
        )
        for episode in case.episodes
        if not episode.is_ordinary
    ]
    paired = board(case, verdicts).standings[0].paired
    for rate in (paired.notice, paired.act):
        assert (rate.value, rate.n, rate.missing) == (1, 24, 0)
    shortcut = board(case, verdicts).shortcut
    assert shortcut is None or shortcut.asked <= len(verdicts)
