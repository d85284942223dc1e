"""The labelled answers of a real model: the matcher agrees with them, and a judge is measured by them."""

from typing import Any

import pytest

from oodscen.judging._aspects.labelled import agreement, labelled_answers
from oodscen.judging._aspects.matching import score_naming
from oodscen.judging._aspects.opinions import ask_opinion, judge_label
from oodscen.testing import ScriptedLLM


def test_the_matcher_counts_right_answers_and_hardly_a_wrong_one():
    found = [
        (labelled_answer.is_right, score_naming(labelled_answer.answer, labelled_answer.path).right)
        for labelled_answer in labelled_answers()
    ]
    right = [counted for is_right, counted in found if is_right]
    wrong = [counted for is_right, counted in found if not is_right]
    assert sum(right) >= 0.9 * len(right)
    assert sum(wrong) <= 0.02 * len(wrong)


@pytest.mark.parametrize("is_contrary", [False, True])
def test_a_judge_s_agreement_is_the_share_on_which_it_sees_what_the_person_saw(is_contrary):
    truth = {
        (labelled_answer.answer, labelled_answer.path[1:]): labelled_answer.is_right
        for labelled_answer in labelled_answers()
    }

    def judges(request: Any) -> dict[str, bool]:
        seen = truth[request.prompt.aspect, request.prompt.path] is not is_contrary
        return {"is_same_thing": True, "is_same_fault": seen}

    judge = ScriptedLLM(judges)
    opinions = [
        ask_opinion(judge, labelled_answer.answer, labelled_answer.path)
        for labelled_answer in labelled_answers()
    ]
    agrees, of = agreement(opinions, judge_label(judge))
    assert of == len(labelled_answers()) == 40
    assert agrees == (0 if is_contrary else of)
    assert agreement(opinions, "another") == (0, 0)
