import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.episode import ActionOutcome, Episode
from oodscen.report.leaderboard import (
    action_counts,
    chance,
    choice,
    floor,
    names_nothing,
    papers_table,
    standings,
    wilson,
)
from oodscen.verdict import Verdict

SAFE, HIT = ActionOutcome(safe=True), ActionOutcome(safe=False)
GONE = ActionOutcome(safe=False, unavailable=True)


def episode(**actions: ActionOutcome) -> Episode:
    return Episode(id="x", scene_id="x", status="ok", actions=actions)


@given(st.integers(0, 500), st.integers(1, 500))
def test_wilson_holds_the_share_and_mirrors(hits: int, more: int) -> None:
    n = hits + more
    low, high = wilson(hits, n)
    assert 0 <= low <= hits / n <= high <= 1
    mirrored = wilson(n - hits, n)
    assert (1 - high, 1 - low) == pytest.approx(mirrored)
    wide = high - low
    narrow = wilson(4 * hits, 4 * n)
    assert narrow[1] - narrow[0] < wide


def test_wilson_of_the_papers_best_row() -> None:
    assert wilson(110, 130) == pytest.approx((0.7746, 0.8981), abs=5e-4)
    assert wilson(0, 0) == (0, 1)


def test_papers_table() -> None:
    assert [(row.aspect.hits, row.action.hits) for row in papers_table()] == [
        (110, 86),
        (100, 66),
        (105, 67),
    ]


@pytest.mark.parametrize(
    ("outcomes", "expected"),
    [((SAFE, HIT), "mixed"), ((SAFE, GONE), "all"), ((HIT, GONE), "none"), ((GONE,), ""), ((), "")],
)
def test_choice_looks_at_available_actions_only(
    outcomes: tuple[ActionOutcome, ...], expected: str
) -> None:
    assert choice(episode(**{f"a{i}": item for i, item in enumerate(outcomes)})) == expected


def test_counts_and_chance() -> None:
    episodes = [episode(stop=SAFE, keep_speed=HIT), episode(stop=SAFE, keep_speed=GONE, own=SAFE)]
    rows = {row.action: (row.safe, row.unsafe, row.unavailable) for row in action_counts(episodes)}
    assert rows["stop"] == (2, 0, 0)
    assert rows["keep_speed"] == (0, 1, 1)
    assert rows["own"] == (1, 0, 0)
    assert chance(episodes) == pytest.approx((1 / 2 + 2 / 3) / 2)
    assert chance([]) is None


def test_failures_are_counted_apart_and_never_as_wrong() -> None:
    verdicts = [
        Verdict(
            id="a@m",
            scene_id="a",
            model="m",
            is_ood=True,
            aspect_is_right=True,
            action_is_safe=False,
        ),
        Verdict(id="b@m", scene_id="b", model="m", status="failed", error="x"),
        Verdict(id="a@r", scene_id="a", model="r", kind="reference", action_is_safe=True),
    ]
    model, reference = standings(verdicts)
    assert (model.answered, model.failed, model.aspect.n, model.action.value) == (1, 1, 1, 0.0)
    assert reference.is_reference
    assert reference.aspect.n == 0


def test_the_floor_is_the_best_reference_and_never_a_model() -> None:
    verdicts = [
        Verdict(id="a@m", scene_id="a", model="m", aspect_is_right=True, action_is_safe=True),
        Verdict(
            id="a@r",
            scene_id="a",
            model="r",
            kind="reference",
            aspect_is_right=False,
            action_is_safe=True,
        ),
        Verdict(id="a@s", scene_id="a", model="s", kind="reference", action_is_safe=False),
    ]
    rows = standings(verdicts)
    best = floor(rows)
    assert best is not None
    assert best.model == "r"
    assert names_nothing(rows)
    assert floor(standings(verdicts[:1])) is None
    assert not names_nothing(standings(verdicts[:1]))
