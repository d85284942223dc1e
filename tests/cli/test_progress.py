"""Long work shows its progress: a line per stage in a log, and one every half minute."""

import gc
import io
import re
from itertools import islice
from unittest import mock

from hypothesis import given
from hypothesis import strategies as st

from oodscen._cli.progress import bars, tracked


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 9)), max_size=6))
def test_a_log_has_a_line_per_stage_with_what_was_done(stages):
    with mock.patch("oodscen._cli.progress.say") as said, mock.patch("sys.stderr", io.StringIO()):
        with bars() as progress:
            for place, (before, more) in enumerate(stages):
                for done in [*range(before, before + more + 1), before + more]:
                    progress(f"stage{place}", done, before + more)
        lines = [call.args[0] for call in said.call_args_list]
    totals = [(place, before + more) for place, (before, more) in enumerate(stages)]
    expected = [rf"stage{place}: {total} in \d+\.\d s" for place, total in totals if total]
    assert len(lines) == len(expected)
    assert all(map(re.fullmatch, expected, lines))


def test_a_stage_that_ends_early_is_a_line_too():
    with mock.patch("oodscen._cli.progress.say") as said, mock.patch("sys.stderr", io.StringIO()):
        assert [*islice(tracked(range(9), "redteam", 9), 4)] == [0, 1, 2, 3]
        gc.collect()
    ((line,), _) = said.call_args
    assert re.fullmatch(r"redteam: 3 of 9 in \d+\.\d s", line)


def test_a_long_stage_has_a_line_every_half_minute():
    with (
        mock.patch("oodscen._cli.progress.say") as said,
        mock.patch("sys.stderr", io.StringIO()),
        mock.patch("oodscen._cli.progress.time.monotonic", side_effect=range(0, 1000, 7)),
    ):
        assert len([*tracked(range(20), "vary", 20)]) == 20
    *between, end = (call.args[0] for call in said.call_args_list)
    assert re.fullmatch(r"vary: 20 in \d+\.\d s", end)
    assert 3 <= len(between) <= 5
    assert all(re.fullmatch(r"vary: \d+ of 20 so far", line) for line in between)


def test_a_closed_standard_error_costs_the_progress_only(monkeypatch):
    monkeypatch.setattr("sys.stderr", None)
    assert [*tracked(range(3), "redteam", 3)] == [0, 1, 2]
