"""The figure that ranks a task, and the reference to beat."""

from typing import get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._base import Data
from oodscen.judging._leaderboard import rows
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.rows import (
    TASKS,
    ActionScore,
    Detection,
    Estimate,
    Identification,
    LeaderboardRow,
    Rate,
    best_floor,
    score,
)

SHARES = st.none() | st.integers(0, 8).map(lambda eighths: eighths / 8)
FIGURES = st.builds(Estimate, value=SHARES)
RATES = st.builds(
    Rate, n=st.integers(0, 9), missing=st.integers(0, 9), value=SHARES, with_missing_wrong=SHARES
)
ROWS = st.builds(
    LeaderboardRow,
    model=st.sampled_from(["oracle", "oracle-2", "random", "constant:stop", "mine"]),
    kind=st.sampled_from(["model", "reference"]),
    protocol=st.sampled_from(["ours", "paper"]),
    detection=st.builds(
        Detection,
        sensitivity=RATES,
        specificity=RATES,
        balanced_accuracy=FIGURES,
        with_missing_wrong=FIGURES,
    ),
    identification=st.builds(Identification, open=RATES, closed=RATES, open_shown=RATES),
    control=st.builds(ActionScore, safe=RATES, decidable=RATES, collision_free=RATES),
)

REFERENCES = ROWS.map(lambda row: row.model_copy(update={"kind": "reference", "protocol": "ours"}))


def counted(row: LeaderboardRow) -> dict[str, list[Rate]]:
    return {
        "detection": [row.detection.sensitivity, row.detection.specificity],
        "open": [row.identification.open],
        "closed": [row.identification.closed],
        "control": [row.control.safe],
    }


@settings(max_examples=40)
@given(ROWS)
def test_a_task_is_ranked_by_its_share_and_detection_by_its_balanced_accuracy(row):
    assert score(row, "detection") == row.detection.balanced_accuracy.value
    for task in ("open", "closed", "control"):
        (rate,) = counted(row)[task]
        assert score(row, task) == rate.value


@settings(max_examples=40)
@given(st.lists(ROWS | REFERENCES, max_size=6), st.sampled_from(TASKS))
def test_the_floor_is_the_best_reference_of_ours_that_does_not_know_the_truth(rows, task):
    able = [
        row
        for row in rows
        if row.kind == "reference"
        and row.protocol == "ours"
        and row.model not in ("oracle", "oracle-2")
        and score(row, task) is not None
    ]
    floor = best_floor(rows, task)
    assert (floor in able) if able else floor is None
    assert all(score(floor, task) >= score(row, task) for row in able)
    whole = Leaderboard(standings=tuple(rows))
    assert whole.floor(task) == floor
    for row in rows:
        assert whole.standing(row.model) == next(r for r in rows if r.model == row.model)
    assert whole.standing("nobody") is None


@pytest.mark.parametrize("kind", ["model", "reference"])
@pytest.mark.parametrize("protocol", ["ours", "paper"])
@pytest.mark.parametrize("model", ["blind", "oracle"])
def test_only_the_blind_reference_of_our_protocol_is_a_blind_row(kind, protocol, model):
    row = rows.LeaderboardRow(model=model, kind=kind, protocol=protocol)
    assert row.is_blind is ((kind, protocol, model) == ("reference", "ours", "blind"))


ROWS_OF_THE_BOARD = sorted(
    {kind for kind in vars(rows).values() if isinstance(kind, type) and issubclass(kind, Data)}
    - {Data, rows.Interval, rows.PairedTest}
    | {Leaderboard},
    key=lambda kind: kind.__name__,
)


@pytest.mark.parametrize("kind", ROWS_OF_THE_BOARD)
def test_a_new_row_has_counted_and_measured_nothing(kind):
    fixed = {"schema_version": 1, "level": 0.95}
    for name, field in kind.model_fields.items():
        if field.is_required():
            continue
        if field.annotation is int or name in fixed:
            assert field.default == fixed.get(name, 0)
        elif type(None) in get_args(field.annotation):
            assert field.default is None
        elif isinstance(field.annotation, type) and issubclass(field.annotation, Data):
            assert field.default == field.annotation()


def test_tasks_are_those_that_are_ranked():
    assert get_args(rows.Task) == TASKS
    assert len(ROWS_OF_THE_BOARD) == 13
