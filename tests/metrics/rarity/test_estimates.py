"""The offline estimate of rarity: figures in order, faults flagged, and never a silent figure."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Metrics, Scenario
from oodscen.errors import DataError
from oodscen.metrics._rarity.estimates import UNTOLD, Rarity, TextRarity, estimated_km
from oodscen.metrics._rarity.rates import PublishedRate
from oodscen.testing._encoder import HashEncoder

METRICS = Metrics(HashEncoder(64), ["A car waits at the light.", "A van drives ahead."])


def one(text):
    return METRICS.rarity([text]).per_text[0]


@settings(max_examples=25, deadline=None)
@given(st.lists(st.text(min_size=1).filter(str.strip).filter(lambda t: "\0" not in t), min_size=1))
def test_every_text_has_a_figure_in_order_or_a_reason(texts):
    try:
        found = METRICS.rarity(texts)
    except DataError:  # half of a surrogate pair
        return
    assert len(found.per_text) == len(texts)
    for rarity in found.per_text:
        if rarity.best is None:
            assert UNTOLD & set(rarity.flags)
        else:
            assert not UNTOLD & set(rarity.flags)
            assert rarity.low <= rarity.best <= rarity.high
    assert Rarity.parse(found.to_json()) == found


@pytest.mark.parametrize(
    ("text", "flag"),
    [
        ("12345 67890", "no driving"),
        ("5 km", "no driving"),
        ("three thousand two hundred", "no driving"),
        ("I like to bake bread with rye flour.", "no driving"),
        ("Ein Reh springt auf die Straße und das Auto bremst.", "language"),
        ("鹿が道路に飛び出した。", "language"),
        ("A unicorn stands in the lane of the road.", "impossible"),
    ],
)
def test_what_cannot_be_told_has_no_figure(text, flag):
    found = one(text)
    assert flag in found.flags
    assert found.best is found.low is found.high is found.log10_km is None
    assert estimated_km(None, text) is None


@pytest.mark.parametrize(
    "text",
    ["The moon orbits the earth in four weeks.", "She plays the piano every single morning."],
)
def test_without_a_baseline_a_text_must_name_a_road_to_get_a_figure(text):
    assert estimated_km(None, text) is None
    assert estimated_km(None, f"{text[:-1]} beside the road.") is not None


def test_long_texts_and_several_events_keep_their_figure_and_are_flagged():
    assert "long" in one("The ego car follows a van in the lane. " * 260).flags
    sequel = "A bridge collapses. Then a tanker explodes on the road."
    assert "several events" in one(sequel).flags
    joined = "A sofa lies in the lane, and then a plane lands on the motorway."
    assert "several events" in one(joined).flags
    twice = "A truck burns on the motorway. A bridge has collapsed onto the road."
    assert "several events" in one(twice).flags
    assert one(twice).best is not None


def test_a_text_does_not_depend_on_the_texts_beside_it():
    texts = ["A deer stands in the lane.", "A red light.", "A sofa lies on the motorway."]
    together = METRICS.rarity(texts).per_text
    for text, found in zip(texts, together, strict=True):
        assert one(text).best == pytest.approx(found.best, abs=0.011)


def test_rare_is_rarer_than_ordinary():
    texts = ["The car ahead waits at the red light.", "The bridge ahead has collapsed."]
    calm, odd = METRICS.rarity(texts).per_text
    assert calm.best < odd.best


def test_a_band_of_rarity_leaves_out_what_cannot_be_told():
    texts = ["The bridge ahead has collapsed.", "12345", "The car ahead waits at the red light."]
    found = METRICS.band(texts, 4.0, 9.0, definition="rarity")
    assert found.indices == (0,)
    assert found.scores[1] is None
    assert found.below == 1


@pytest.mark.parametrize(
    "figures",
    [
        {"low": 5.0, "best": 4.0, "high": 6.0},
        {"log10_km": 5.0},
        {"low": 1.0, "best": 2.0, "high": 3.0, "log10_km": 9.0},
    ],
)
def test_figures_that_contradict_each_other_are_refused(figures):
    with pytest.raises(DataError):
        TextRarity.parse(figures)


@pytest.mark.parametrize(
    ("usd", "shown"), [(0.0, "0.00"), (0.004, "0.004"), (0.012, "0.01"), (3.456, "3.46")]
)
def test_a_cost_below_a_cent_is_shown(usd, shown):
    told = METRICS.rarity(["A red light."]).model_copy(update={"input_tokens": 1, "cost_usd": usd})
    assert str(told).endswith(f" {shown} USD")


@pytest.mark.parametrize("texts", [None, 3.0, "one string", b"bytes", [None], [3.0], [], [" "]])
def test_what_is_no_set_of_texts_is_refused(texts):
    with pytest.raises(DataError):
        METRICS.rarity(texts)


@pytest.mark.parametrize(
    "wording", ["12345", "A unicorn stands in the lane of the road.", "ein Reh"]
)
def test_rates_of_what_cannot_be_estimated_are_refused(wording):
    rate = PublishedRate(
        event="x", km=(1.0, 2.0, 3.0), source="fleet", texts=("A red light.", wording)
    )
    with pytest.raises(DataError):
        METRICS.rarity(["A red light."], anchors=[rate])


def test_a_file_of_rates_that_are_of_no_use_is_named(tmp_path):
    events = ("A red light.", "A bus stops.", "A tyre bursts.", "A deer runs onto the road.")
    events += ("A tree lies across the road.", "The bridge ahead has collapsed.")
    file, texts = tmp_path / "flat.toml", tmp_path / "texts.txt"
    row = "[[rate]]\nevent='x'\nkm=[1e4,1e4,1e4]\nsource='fleet'\ntexts=[{!r}]\n"
    texts.write_text("A car waits at the light.")
    for found, said in ((events, "slope is 0,"), ((*events, "12345"), "'12345'")):
        file.write_text("".join(row.format(event) for event in found))
        for score in (
            METRICS.rarity,
            lambda given, anchors: METRICS.score_file(texts, anchors=anchors),
        ):
            with pytest.raises(DataError, match=rf"rates in .*flat\.toml:\n.*{said}"):
                score(["A car waits at the light."], anchors=file)


def test_published_rates_can_be_estimated():
    assert METRICS.rarity(["A red light."], anchors="published").calibration.anchors == 53


SET = [
    "A car waits at a red light.",
    "A deer stands in the lane.",
    "The bridge ahead has collapsed.",
    "A sofa lies on the motorway.",
    "12345",
    "A cyclist rides ahead in the lane.",
]


def test_a_set_has_an_interval_of_its_median_over_the_texts_with_a_figure():
    found = METRICS.rarity(SET)
    assert found.interval.low <= found.median <= found.interval.high
    assert (found.interval.method, found.interval.units) == ("bootstrap", 5)
    assert f"[10^{found.interval.low:.1f}, 10^{found.interval.high:.1f}]" in str(found)
    assert found == METRICS.report(SET).rarity
    assert METRICS.rarity(SET[:1]).interval is None
    assert METRICS.rarity(SET[4:5]).interval is None


def test_the_interval_counts_paths():
    scenarios = [
        Scenario(id=f"s-{index}", text=text, path=("OOD", f"Kind {min(index, 4)}"))
        for index, text in enumerate(SET)
    ]
    found = METRICS.rarity(scenarios)
    assert (found.interval.method, found.interval.units) == ("cluster bootstrap", 5)
    assert METRICS.rarity(SET, groups=[0, 1, 2, 3, 4, 4]).interval == found.interval
    with pytest.raises(DataError, match="has 2 labels for 6 texts"):
        METRICS.rarity(SET, groups=[0, 1])
