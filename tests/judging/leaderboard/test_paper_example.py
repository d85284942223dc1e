import pytest

from oodscen.judging._leaderboard.paper_example import paper_example
from oodscen.statistics._significance import mcnemar


def test_the_table_with_its_intervals() -> None:
    rows = {(row.model, row.task): row for row in paper_example().rows}
    assert [
        rows[name, "aspect"].hits for name in ("GPT-4o", "Claude 3.5 Sonnet", "Gemini 1.5 Pro")
    ] == [110, 100, 105]
    best = rows["GPT-4o", "control"]
    assert (best.hits, best.n) == (86, 130)
    assert (best.low, best.high) == pytest.approx((0.5766, 0.7372), abs=5e-4)
    assert best.clustered_low < best.low < best.value < best.high < best.clustered_high


def test_the_lead_hangs_on_the_likeness_of_paths() -> None:
    alike = paper_example(icc=0.2)
    lead = [c for c in alike.comparisons if c.task == "control" and c.first == "GPT-4o"]
    assert all(c.p_holm < 0.05 < c.p_clustered_holm for c in lead)
    assert any("no longer" in sentence for sentence in alike.shows_not)
    apart = paper_example(icc=0.0)
    assert apart.design_effect == 1
    assert not any("no longer" in sentence for sentence in apart.shows_not)
    assert len(apart.shows) == 2


def test_the_paired_p_is_bracketed_by_what_the_totals_allow() -> None:
    found = next(
        c
        for c in paper_example().comparisons
        if (c.task, c.first, c.second) == ("control", "GPT-4o", "Gemini 1.5 Pro")
    )
    assert found.p_paired_least == pytest.approx(mcnemar(19, 0)[1])
    assert found.p_paired_most == pytest.approx(mcnemar(63, 44)[1])
    for c in paper_example().comparisons:
        assert c.p_paired_least <= c.p_paired_most


def test_always_ood_is_right_without_twins_and_a_coin_with_them() -> None:
    found = paper_example()
    assert (found.always_ood_accuracy, found.always_ood_balanced) == (1.0, 0.5)
    assert found.always_ood_d_prime == pytest.approx(0)
