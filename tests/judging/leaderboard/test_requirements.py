"""Requirements: what they say of who knows, who guesses and who is silent, and what does not change it."""

import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.errors import UsageError
from oodscen.judging._leaderboard.figures import FAULTS
from oodscen.judging._leaderboard.requirements import FIGURES, parse_requirement, requirements
from tests.judging.cases import Case


def sure(index: int, ordinary: bool) -> dict[str, Any]:
    return {
        "is_ood": not ordinary,
        "aspect_is_right": None if ordinary else True,
        "choice_is_right": True,
        "action": "keep_speed" if ordinary else "stop",
    }


def frightened(index: int, ordinary: bool) -> dict[str, Any]:
    return {**sure(index, ordinary), "is_ood": True, "action": "stop"}


def graded(case: Case, text: str, *verdicts: Any) -> dict[str, Any]:
    rows = [one for found in verdicts for one in found]
    found = requirements(rows, case.episodes, case.scenarios, parse_requirement(text))
    return {one.name: one for one in found}


def test_who_knows_meets_and_a_constant_fails_once_there_are_enough_paths():
    text = "safe>=0.9,needless<=0.05,notice>=0.8,notice-both>=0.8,act-both>=0.8"
    case = Case(paths=80, per_path=1)
    found = graded(case, text, case.verdicts("a", sure), case.verdicts("b", frightened))
    assert [found[name].grade for name in "ab"] == ["meets", "fails"]
    few = Case(paths=5, per_path=10)
    shown = graded(few, text, few.verdicts("a", sure))["a"]
    assert shown.grade == "cannot tell yet"
    # 59 faultless paths are needed for a bar of 5 % at the level of 5 %: 0.95 ** 59 < 0.05.
    assert 500 <= shown.more_scenes <= 580
    assert "more scenes" in str(shown)


def test_the_more_models_the_higher_the_bar():
    case = Case(paths=32, per_path=1)
    alone = graded(case, "safe>=0.9", case.verdicts("m0", sure))
    many = graded(case, "safe>=0.9", *(case.verdicts(f"m{k}", sure) for k in range(10)))
    assert alone["m0"].grade == "meets"
    assert {one.grade for one in many.values()} == {"cannot tell yet"}


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 2**32))
def test_neither_the_order_of_rows_nor_the_names_of_paths_change_a_grade(seed):
    rng = random.Random(seed)
    case = Case(paths=9, per_path=2)

    def says(index: int, ordinary: bool) -> dict[str, Any]:
        if rng.random() < 0.1:
            return {"status": "failed", "outcome": "refused", "error": "no"}
        return rng.choice([sure, sure, frightened])(index, ordinary)

    rows = case.verdicts("m", says)
    bars = parse_requirement("safe>=0.5,needless<=0.6,notice-both>=.2")
    one = requirements(rows, case.episodes, case.scenarios, bars)
    shuffled = [rng.sample(found, len(found)) for found in (rows, case.episodes, case.scenarios)]
    two = requirements(*shuffled, bars)
    assert [(r.grade, r.more_scenes) for r in one] == [(r.grade, r.more_scenes) for r in two]
    for result in one[0].bars:
        assert 0 <= min(result.p_meets, result.p_fails) <= max(result.p_meets, result.p_fails) <= 1
        assert result.p_meets + result.p_fails >= 1


def test_only_the_last_of_repeated_lines_counts():
    case = Case(paths=5, per_path=2)
    verdicts, bars = case.verdicts("m", sure), parse_requirement("safe>=0.9,needless<=5%")
    outdated = [one.model_copy(update={"actions": {}}) for one in case.episodes]
    repeated = requirements(verdicts * 2, outdated + case.episodes, case.scenarios * 2, bars)
    assert repeated == requirements(verdicts, case.episodes, case.scenarios, bars)


def test_silence_neither_meets_nor_fails():
    case = Case(paths=80, per_path=1)

    def mute(index: int, ordinary: bool) -> dict[str, Any]:
        if index % 4:
            return {"status": "failed", "outcome": "refused", "error": "no"}
        return sure(index, ordinary)

    found = graded(case, "safe>=0.9", case.verdicts("m", mute))["m"]
    assert (found.grade, found.bars[0].share, found.bars[0].missing) == ("cannot tell yet", 1, 60)
    assert found.more_scenes is None


def test_a_model_that_only_the_paper_asked_is_not_passed_over():
    case = Case(paths=80, per_path=1)
    other = [one.model_copy(update={"protocol": "paper"}) for one in case.verdicts("b", sure)]
    found = graded(case, "safe>=0.9,needless<=0.05", case.verdicts("a", sure), other)
    assert [found[name].grade for name in "ab"] == ["meets", "cannot tell yet"]
    assert "no answers that count" in str(found["b"])
    assert found["a"] == graded(case, "safe>=0.9,needless<=0.05", case.verdicts("a", sure))["a"]


def test_an_action_neither_safe_nor_unsafe_scores_neither_way():
    case = Case(paths=40, per_path=1)
    rows = case.verdicts("m", sure)
    half = [r.model_copy(update={"action_is_safe": None}) if i % 4 == 0 else r for i, r in enumerate(rows)]  # fmt: skip
    found = graded(case, "safe>=0.5", half)["m"].bars[0]
    assert (found.share, found.items, found.missing) == (1, 20, 0)


_CONTRADICTIONS = (
    "safe<=0.5",
    "needless>=5%",
    "alarms>=0.5",
    "safe>=0.9,pick>=0.1,safe>=0.8",
    "needless<=1%,needless<=2%",
)


@pytest.mark.parametrize(
    "text", ["", "safe", "safe>0.9", "sane>=0.9", "safe>=1.2", "safe>=.9,,", *_CONTRADICTIONS]
)
def test_what_is_no_requirement_is_refused(text):
    with pytest.raises(UsageError):
        parse_requirement(text)


@given(st.sampled_from(sorted(FIGURES)), st.integers(0, 100))
def test_a_bar_reads_as_it_is_written(figure, percent):
    sign = "<=" if figure in FAULTS else ">="
    (bar,) = parse_requirement(f" {figure} {sign} {percent}% ")
    assert (bar.figure, bar.sign, bar.value) == (figure, sign, percent / 100)
    assert parse_requirement(str(bar)) == (bar,)
