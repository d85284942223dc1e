"""A judge's opinions: one scorer for all, failures counted, the matcher only where the judge fails."""

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._verdict import Verdict
from oodscen.errors import LLMError
from oodscen.judging._aspects.matching import names_aspect
from oodscen.judging._aspects.opinions import (
    ask_opinion,
    is_open,
    judge_label,
    opinion_id,
    rescore_verdict,
)
from oodscen.judging._leaderboard.leaderboard import leaderboard
from oodscen.testing import ScriptedLLM
from tests.judging.cases import Case

PATH = ("OOD", "Environmental", "Overturned vehicle ahead")
ASPECTS = st.sampled_from(["", " ", "a flipped van", "a deer", "Overturned vehicle ahead"])


def verdict(aspect: str, is_ood: bool | None = True, **more: Any) -> Verdict:
    fields = {"id": "a@m", "scene_id": "a", "model": "m", "aspect": aspect, "is_ood": is_ood}
    return Verdict.parse(fields | more)


@given(ASPECTS, st.sampled_from([True, False, None]), st.booleans(), st.booleans())
def test_judge_then_matcher_is_the_matcher_and_a_judge_is_asked_once(aspect, is_ood, twin, same):
    judge = ScriptedLLM({"judge-aspect": {"is_same_thing": True, "is_same_fault": same}})
    given = verdict(aspect, is_ood, is_ordinary=twin, aspect_is_right=False)
    found = {one.id: one for one in [ask_opinion(judge, aspect, PATH)]}
    label = judge_label(judge)
    judged = rescore_verdict(given, PATH, found, label)
    if not is_open(given):
        assert judged == given
        return
    is_label = aspect == PATH[-1]
    assert len(judge.requests) == (not is_label)
    assert (judged.aspect_is_right, judged.judge) == (same or is_label, label)
    assert rescore_verdict(judged, PATH, found, label) is judged
    again = rescore_verdict(judged, PATH, {}, "")
    assert (again.aspect_is_right, again.judge) == (names_aspect(aspect, PATH), "")
    other = rescore_verdict(judged, PATH, {}, label)
    assert other.judge_error
    assert other.aspect_is_right is names_aspect(aspect, PATH)


def test_a_judge_that_fails_is_data_and_says_so():
    def fails(request):
        raise LLMError("no credit")

    judge = ScriptedLLM(fails)
    found = ask_opinion(judge, "a flipped van", PATH)
    assert (found.status, found.is_same, found.error_type) == ("failed", None, "LLMError")
    scored = rescore_verdict(verdict("a flipped van"), PATH, {found.id: found}, judge_label(judge))
    assert (scored.judge, scored.aspect_is_right) == ("", True)
    assert "no credit" in scored.judge_error


@given(ASPECTS, ASPECTS)
def test_opinions_are_told_apart_by_judge_aspect_and_path(one, other):
    assert (opinion_id("j", one, PATH) == opinion_id("j", other, PATH)) is (one == other)
    assert opinion_id("j", one, PATH) != opinion_id("k", one, PATH)
    assert opinion_id("j", one, PATH) != opinion_id("j", one, PATH[1:])


def test_open_aspects_scored_by_different_judges_are_not_compared():
    case = Case()

    def says(judge: str, error: str = ""):
        def fields(index: int, twin: bool) -> dict[str, Any]:
            right = None if twin else True
            named = {"is_ood": not twin, "aspect": "x", "aspect_is_right": right, "action": "stop"}
            return named if twin else {**named, "judge": judge, "judge_error": error}

        return fields

    def compared(*names: str) -> int:
        rows = [v for n, name in enumerate(names) for v in case.verdicts(f"m{n}", says(name))]
        board = leaderboard(rows, case.episodes, case.scenarios)
        return sum(
            comparison.test.n for comparison in board.comparisons if comparison.task == "open"
        )

    assert compared("j@1", "j@1") == compared("", "") == 24
    assert compared("j@1", "") == 0
    failing = leaderboard(
        case.verdicts("m", says("", "no credit")), case.episodes, case.scenarios
    ).standings[0]
    assert (failing.identification.judged, failing.identification.unjudged) == (0, 24)
