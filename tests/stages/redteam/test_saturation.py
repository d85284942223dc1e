"""The estimates agree with published examples and with their definitions."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import DataError
from oodscen.stages._redteam.rounds import Round
from oodscen.stages._redteam.saturation import chao1, saturation
from oodscen.tree._scenario_tree import TreeEdit


def log(*kinds):
    """Return rounds that name these kinds; capitals stand for kinds that are new at first sight."""
    met = set()
    rounds = []
    for number, kind in enumerate(kinds, start=1):
        is_new = kind is not None and kind.isupper() and kind not in met
        met.add(kind)
        decision = "not-ood" if kind is None else "add" if is_new else "covered"
        rounds.append(Round(round=number, decision=decision, kind=kind, calls=2))
    return rounds


SPIDERS = {
    # Girdled and logged plots of Ellison et al. 2010; estimates as published with iNEXT.
    "girdled": ((168, 26, 12, 4), 43.893, 30.511, 96.971),
    "logged": ((252, 37, 14, 4), 61.403, 43.502, 128.583),
}


@pytest.mark.parametrize("plot", SPIDERS)
def test_chao1_agrees_with_published_estimates(plot):
    counts, total, low, high = SPIDERS[plot]
    found = [counts[1] + value for value in chao1(*counts)]
    assert found == pytest.approx([total, low, high], abs=2e-3)


def test_coverage_is_one_minus_the_share_of_kinds_met_once():
    found = saturation(log("A", "B", "A", "old", "C", "old"))
    assert (found.observations, found.kinds, found.once, found.twice) == (6, 3, 2, 1)
    assert found.coverage == pytest.approx(1 - 2 / 6, abs=1e-6)


def test_rounds_that_name_no_kind_are_no_observations():
    found = saturation(log("A", None, None))
    assert (found.rounds, found.calls, found.observations) == (3, 6, 1)


def test_a_dry_spell_begins_behind_the_last_new_kind():
    rounds = log("A", "B", *["A"] * 5, "C", *["A"] * 9)
    assert saturation(rounds, patience=5).dry_from == 3
    assert saturation(rounds, patience=6).dry_from == 9
    assert saturation(rounds, patience=10).dry_from is None
    assert saturation(rounds).last_new == 8


def test_rounds_without_an_answer_are_neither_recent_nor_dry():
    failed = [Round(round=number, status="failed", error="no answer") for number in range(4, 9)]
    found = saturation([*log("A", "B", "A"), *failed, *log(*"x" * 9)[8:]], patience=3)
    assert (found.rounds, found.recent_rounds, found.dry_from) == (9, 3, None)
    assert found.recent == pytest.approx(1 / 3, abs=1e-6)


def test_a_kind_that_was_split_keeps_its_sightings():
    edits = (
        TreeEdit(op="broaden", node="A", label="wide"),
        TreeEdit(op="add", node="A-2", parent="A", label="old"),
        TreeEdit(op="add", node="B", parent="A", label="new"),
    )
    rounds = [*log("A", "A"), Round(round=3, decision="split", kind="B", edits=edits)]
    rounds.append(Round(round=4, decision="covered", kind="A-2"))
    found = saturation(rounds)
    assert (found.kinds, found.once, found.twice) == (2, 1, 0)


@given(st.lists(st.sampled_from(["A", "B", "C", "D", "old", None]), max_size=40))
def test_estimates_lie_where_they_can(kinds):
    found = saturation(log(*kinds))
    assert 0.0 <= found.coverage_low <= found.coverage <= found.coverage_high <= 1.0
    assert 0.0 <= found.unseen_low <= found.unseen <= found.unseen_high
    assert 0.0 <= found.recent_low <= found.recent <= found.recent_high <= 1.0
    assert found.once + found.twice <= found.kinds <= found.observations <= found.rounds
    assert len(found.curve) == found.rounds
    assert [point.kinds for point in found.curve] == sorted(point.kinds for point in found.curve)
    if found.curve:
        last = found.curve[-1]
        assert (last.kinds, last.coverage, last.unseen) == (
            found.kinds,
            found.coverage,
            found.unseen,
        )
    assert type(found).parse(found.to_json()) == found


@given(st.lists(st.sampled_from("ABCDE"), min_size=1, max_size=30), st.integers(0, 30))
def test_the_curve_of_a_prefix_is_a_prefix_of_the_curve(kinds, cut):
    rounds = log(*kinds)
    assert saturation(rounds[:cut]).curve == saturation(rounds).curve[:cut]


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"decision": "split", "kind": "B"}, "edits"),
        ({"decision": "split", "kind": "B", "edits": [{"op": "keep", "node": "A"}]}, "edits"),
        ({"round": 0}, "round"),
        ({"once_in_km": 0}, "once_in_km"),
        ({"similarity": 1.5}, "similarity"),
        ({"calls": -1}, "calls"),
        ({"nodes": -1}, "nodes"),
        ({"seen": -1}, "seen"),
    ],
)
def test_a_round_that_cannot_have_been_played_is_refused(change, path):
    with pytest.raises(DataError) as refused:
        Round.parse({"round": 1, **change})
    assert [issue.path for issue in refused.value.issues] == [path]
