"""Faults of an answer, in an order that no hash decides: a repair quotes them, and a recording finds it again."""

import json

import pytest
from pydantic import create_model

from oodscen.llm._reading import read_answer
from oodscen.prompts._tree.judge_branch import BranchJudgements

NAMES = [f"{letter}{number}" for letter in "zyxw" for number in range(9)]
Figures = create_model("Figures", **dict.fromkeys(NAMES, (float, ...)))


def test_truths_in_place_of_numbers_are_told_in_the_order_of_the_text() -> None:
    answer, issues = read_answer(json.dumps(dict.fromkeys(NAMES, True)), Figures)
    assert answer is None
    assert [issue.path for issue in issues] == NAMES


def test_repeated_members_are_told_in_the_order_of_the_text() -> None:
    twice = ", ".join(f'"{name}": 1, "{name}": 2' for name in NAMES)
    answer, issues = read_answer(f"{{{twice}}}", Figures)
    assert answer is None
    assert [issue.path for issue in issues] == NAMES


@pytest.mark.parametrize("name", ["Label", "LABEL", " label", "`label`"])
def test_a_member_whose_name_is_written_in_another_way_is_asked_for_again(name: str) -> None:
    judgement = {"number": 1, "simulatable": True, "assets": ["deer"], name: "Deer by day"}
    answer, (issue,) = read_answer(json.dumps({"judgements": [judgement]}), BranchJudgements)
    assert answer is None
    assert str(issue) == f"judgements[0].{name}: is not known: write 'label'"


def test_a_member_may_have_the_name_of_a_method_of_mappings() -> None:
    lists = create_model("Lists", keys=(list[float], ...), items=(list[float], []))
    answer, issues = read_answer('{"keys": [1, 2]}', lists)
    assert not issues
    assert vars(answer) == {"keys": [1.0, 2.0], "items": []}
