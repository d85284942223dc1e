"""Common kinds are asked for first; a band refuses what lies outside."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import RedTeamer
from oodscen.errors import UsageError
from oodscen.stages._redteam.rarity import BARREN, COMMON_KM, RAREST_KM, WantedRarity
from oodscen.stages._redteam.rounds import Round
from oodscen.testing import ScriptedLLM
from oodscen.tree._scenario_tree import TreeEdit
from tests.stages.redteam.test_red_teamer import ADDED, PIANO, TREE, model

decisions = st.sampled_from(["add", "split", "broaden", "covered", "duplicate", None])
SPLIT = (
    TreeEdit(op="broaden", node="a", label="wide"),
    TreeEdit(op="add", node="a-2", parent="a", label="old"),
)


@given(st.lists(decisions, max_size=60))
def test_rarer_kinds_are_asked_for_only_when_nothing_new_comes(found):
    rarity, before = WantedRarity(), COMMON_KM
    for number, decision in enumerate(found, start=1):
        edits = SPLIT if decision == "split" else ()
        rarity.add(Round(round=number, decision=decision, edits=edits))
        most = rarity.wanted[1]
        assert before <= most <= RAREST_KM
        if decision in ("add", "split", None):
            assert most == before
        before = most
    if len(found) < BARREN:
        assert before == COMMON_KM


@given(st.floats(1.0, 1e12))
def test_a_band_refuses_what_lies_outside_and_nothing_else(km):
    assert bool(WantedRarity((1e4, 1e6)).fault(km)) == (not 1e4 <= km <= 1e6)
    assert WantedRarity((1e4, 1e6)).fault(None) == WantedRarity().fault(km) == ""


def test_a_proposal_outside_the_band_costs_one_call_and_changes_nothing():
    def answer(request):
        if request.prompt.purpose != "imagine-scenario":
            return ADDED
        assert "1e+04 to 1e+06" in request.messages[-1].text
        return {"reasoning": "", "text": PIANO, "once_in_km": 10.0 ** (9 + request.sample)}

    teamer = RedTeamer(ScriptedLLM(answer), iterations=2, rarity=(1e4, 1e6))
    rounds = list(teamer.rounds(TREE))
    assert [item.once_in_km for item in rounds] == [1e10, 1e11]
    for item in rounds:
        assert (item.decision, item.calls, item.edits) == ("implausible", 1, ())
    assert list(teamer.rounds(TREE, rounds[:1])) == rounds[1:]


@pytest.mark.parametrize("band", [(0.0, 1.0), (2.0, 1.0)])
def test_a_band_that_is_none_is_refused_at_once(band):
    with pytest.raises(UsageError):
        RedTeamer(model(ADDED), rarity=band)


def test_the_offline_head_estimates_where_the_model_gives_no_figure():
    def answer(request):
        is_proposal = request.prompt.purpose == "imagine-scenario"
        return {"text": "The car ahead waits at the red light."} if is_proposal else ADDED

    (item,) = RedTeamer(ScriptedLLM(answer), iterations=1, rarity=(1e6, 1e9)).rounds(TREE)
    assert (item.decision, item.once_in_km_by) == ("implausible", "head")
    assert 1.0 < item.once_in_km < 1e6
