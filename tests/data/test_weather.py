"""Tables keyed by a kind of weather hold every kind."""

import pytest

from oodscen.author._reading.weather_words import WEATHER_WORDS
from oodscen.author._staging import weather as author_weather
from oodscen.claims import _surroundings
from oodscen.data._claim import VALUES
from oodscen.data._weather import PRECIPITATIONS, WEATHER_KINDS, is_weather_kind
from oodscen.interchange import _tags
from oodscen.stages._demands import demanding

FALLING = set(PRECIPITATIONS) - {"none"}


@pytest.mark.parametrize("table", [_tags._PRECIPITATION, demanding._FALLING])
def test_every_precipitation_has_a_row(table):
    assert set(table) == FALLING


@pytest.mark.parametrize(
    ("module", "table", "kinds"),
    [
        ("oodscen_pybullet._rendering.sky", "_GREY", {*FALLING, "none"}),
        ("oodscen_pybullet._rendering.picture", "_ADD_DROPS", FALLING),
    ],
)
def test_every_precipitation_is_drawn(module, table, kinds):
    pytest.importorskip("pybullet")
    assert set(getattr(pytest.importorskip(module), table)) == kinds


def test_what_falls_is_a_kind_of_weather_that_texts_can_claim():
    assert set(WEATHER_KINDS) >= FALLING
    assert set(VALUES["weather"]) >= FALLING
    assert all(
        f"{much}_{kind}" in VALUES["weather"] for kind in FALLING for much in ("light", "heavy")
    )


def test_every_claim_about_weather_and_light_is_checked():
    assert set(_surroundings._WEATHER) == set(VALUES["weather"])
    assert set(_surroundings._TIME) == set(VALUES["time"])


def test_the_author_stages_known_claims_only():
    known = {*VALUES["weather"], *VALUES["time"]}
    assert author_weather._RULES.keys() <= known


def test_the_author_reads_every_kind_of_weather():
    assert {*WEATHER_WORDS, "night"} == set(WEATHER_KINDS)


def test_other_words_are_no_kind():
    assert not is_weather_kind("dust")
    assert all(map(is_weather_kind, WEATHER_KINDS))
