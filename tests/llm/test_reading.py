"""Faults of an answer, in an order that no hash decides: a repair quotes them, and a recording finds it again."""

import json

from pydantic import create_model

from oodscen.llm._reading import read_answer

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
