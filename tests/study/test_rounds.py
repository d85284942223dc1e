"""Failed rounds count where they can still be played again."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.stages._redteam.rounds import Round
from oodscen.study._rounds import failed_at_end


@given(st.lists(st.booleans()), st.integers(0, 5))
def test_only_rounds_that_no_other_follows_count_as_failed(is_ok, trailing):
    statuses = ["ok" if ok else "failed" for ok in is_ok]
    while statuses and statuses[-1] == "failed":
        statuses.pop()
    statuses += ["failed"] * trailing
    rounds = [Round(round=number, status=one) for number, one in enumerate(statuses, start=1)]
    assert failed_at_end(rounds) == rounds[len(rounds) - trailing :]
