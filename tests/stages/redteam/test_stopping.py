"""The stopping rules, and that a round begun early is one that is played."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import DataError
from oodscen.stages._options import RedTeamOptions
from oodscen.stages._redteam.rounds import Round
from oodscen.stages._redteam.stopping import Stopping

limits = st.builds(
    RedTeamOptions,
    iterations=st.integers(0, 30),
    budget=st.none() | st.integers(0, 80),
    patience=st.none() | st.integers(1, 10),
    coverage=st.none() | st.floats(0.05, 0.95),
)
decisions = st.sampled_from(["add", "covered", "duplicate", "malformed", None])


def test_each_rule_names_itself():
    def stop(**rules):
        progress = Stopping(RedTeamOptions(**{"iterations": 100, **rules}))
        for number in range(1, 21):
            progress.add(Round(round=number, decision="covered", kind="x", calls=2))
        return progress.stop

    assert stop() is None
    assert stop(iterations=20) == "rounds"
    assert stop(budget=41) == "budget"
    assert stop(budget=42) is None
    assert stop(patience=20) == "patience"
    assert stop(patience=21) is None
    assert stop(coverage=0.9) == "coverage"
    assert stop(coverage=0.99) is None


def test_malformed_rules_are_refused():
    with pytest.raises(DataError):
        RedTeamOptions.parse({"iterations": -1})


@given(limits, st.lists(decisions, max_size=40), st.data())
def test_a_round_that_is_certain_is_played_whatever_comes_before(rules, course, data):
    progress = Stopping(rules)
    certain = 0
    for number, decision in enumerate(course, start=1):
        if progress.stop is not None:
            break
        for ahead in range(number + 1, number + 6):
            if progress.is_certain(ahead):
                certain = max(certain, ahead)
                assert rules.budget is None or progress.attempts() == 3
        calls = data.draw(st.integers(1, 6))
        if rules.budget is not None:
            calls = min(calls, rules.budget - progress.calls)
        kind = f"kind-{number}" if decision == "add" else None if decision is None else "old"
        progress.add(Round(round=number, decision=decision, kind=kind, calls=calls))
    if progress.stop is not None:
        assert certain <= progress.round
    assert rules.budget is None or progress.calls <= rules.budget


@given(st.integers(2, 40), st.integers(0, 38))
def test_the_attempts_keep_one_call_for_placing(budget, spent):
    progress = Stopping(RedTeamOptions(iterations=10, budget=budget))
    if spent:
        progress.add(Round(round=1, calls=min(spent, budget)))
    if progress.stop is None:
        first = progress.attempts()
        assert 1 <= first <= 3
        assert progress.calls + first + progress.attempts(first) <= budget
        assert progress.attempts(first) >= 1


def test_a_later_round_is_certain_only_if_all_calls_before_it_may_be_spent():
    assert Stopping(RedTeamOptions(budget=12)).is_certain(2)
    assert not Stopping(RedTeamOptions(budget=11)).is_certain(2)


def test_a_later_round_is_uncertain_if_the_new_kinds_may_be_met_again_before_it():
    progress = Stopping(RedTeamOptions(coverage=0.55))
    for number, kind in enumerate("ab", start=1):
        progress.add(Round(round=number, decision="add", kind=kind, calls=2))
    assert progress.is_certain(3)
    assert progress.is_certain(4)
    assert not progress.is_certain(5)
