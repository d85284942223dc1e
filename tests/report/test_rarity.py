"""Rarity of sets of texts: their figures, their ends, and families of the simulatable tree."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scenario import Scenario
from oodscen.metrics._measurements import Measurements
from oodscen.metrics._rarity.estimates import Rarity, TextRarity
from oodscen.report._rarity import rarity_variables
from oodscen.statistics._intervals import Interval
from tests.report.conftest import measurements_of

NONE = {
    "rarity_rows": [],
    "rarity_chart": None,
    "rarity_ends": [],
    "rarity_families": [],
    "rarity_against": None,
    "rarity_model": None,
}
LABELS = {"simulatable": "Simulatable tree"}
FIGURES = st.lists(st.none() | st.floats(0, 12, width=16), min_size=2, max_size=20)


def measured(values: list[float | None]) -> Measurements:
    estimates = tuple(
        TextRarity() if value is None else TextRarity(low=value - 1, best=value, high=value + 1)
        for value in values
    )
    rarity = Rarity(by="words", per_text=estimates, median=None, unknown=values.count(None))
    metrics = measurements_of({"simulatable": len(values)})
    report = metrics.sets["simulatable"].model_copy(update={"rarity": rarity})
    return metrics.model_copy(update={"sets": {"simulatable": report}})


def texts(count: int) -> dict[str, list[Scenario]]:
    return {
        "simulatable": [
            Scenario(id=f"x-{n:03d}", text=f"Text {n}", path=("OOD", "Class", f"Family {n % 2}"))
            for n in range(count)
        ]
    }


def test_a_set_has_the_interval_of_its_median_and_an_older_study_none() -> None:
    metrics = measured([3.0, 5.0])
    (row,) = rarity_variables(metrics, LABELS, texts(2))["rarity_rows"]
    assert row.interval == ""
    report = metrics.sets["simulatable"]
    interval = Interval(low=3.04, high=4.96, method="cluster bootstrap", units=2)
    rarity = report.rarity.model_copy(update={"interval": interval})
    sets = {"simulatable": report.model_copy(update={"rarity": rarity})}
    variables = rarity_variables(metrics.model_copy(update={"sets": sets}), LABELS, texts(2))
    assert variables["rarity_rows"][0].interval == "10^3.0 km to 10^5.0 km"


def test_a_study_without_rarity_has_none_on_its_page() -> None:
    assert rarity_variables(None, {}, {}) == NONE
    assert rarity_variables(measurements_of({"simulatable": 3}), LABELS, texts(3)) == NONE
    assert rarity_variables(measured([None, None]), LABELS, texts(2)) == NONE


@given(FIGURES.filter(lambda values: any(value is not None for value in values)))
def test_the_ends_of_a_set_are_its_rarest_and_its_commonest_texts(values) -> None:
    variables = rarity_variables(measured(values), LABELS, texts(len(values)))
    (row,), (ends,) = variables["rarity_rows"], variables["rarity_ends"]
    assert (row.n, row.unknown) == (len(values), values.count(None))
    ranked = sorted(
        (index for index, value in enumerate(values) if value is not None),
        key=lambda index: (-values[index], index),
    )
    shown = ranked if len(ranked) < 8 else [*ranked[:4], *ranked[-4:]]
    assert [text for _, text in (*ends.rarest, *ends.commonest)] == [f"Text {n}" for n in shown]
    assert 0 <= len(ends.rarest) - len(ends.commonest) <= 1
    families = variables["rarity_families"]
    assert sum(family.n for family in families) == len(ranked)


def test_rarities_are_not_told_of_other_texts() -> None:
    variables = rarity_variables(measured([3.0, 5.0]), LABELS, texts(3))
    assert len(variables["rarity_rows"]) == 1
    assert (variables["rarity_ends"], variables["rarity_families"]) == ([], [])
