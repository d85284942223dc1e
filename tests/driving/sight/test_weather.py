import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen.data._weather import Weather
from oodscen.driving._sight.weather import is_noticeable, visual_range


@given(st.floats(20, 9000), st.sampled_from(["rain", "snow"]), st.floats(0.5, 60))
def test_rain_and_snow_only_shorten_the_visual_range(fog, kind, intensity):
    dry = Weather(fog_visual_range_m=fog)
    wet = Weather(fog_visual_range_m=fog, precipitation=kind, precipitation_mm_h=intensity)
    assert visual_range(wet) < visual_range(dry) == pytest.approx(fog, rel=1e-3)
    assert visual_range(Weather()) == 10_000.0


@pytest.mark.parametrize(
    ("fields", "differs"),
    [
        ({}, False),
        ({"sun_elevation_deg": 40.0, "cloud_cover": 0.3}, False),
        ({"fog_visual_range_m": 5000.0}, False),
        ({"fog_visual_range_m": 60.0}, True),
        ({"sun_elevation_deg": -20.0}, True),
        ({"precipitation": "rain", "precipitation_mm_h": 5.0}, True),
        ({"friction": 0.2}, True),
    ],
)
def test_weather_is_noticeable_where_a_person_would_say_so(fields, differs):
    assert is_noticeable(Weather(**fields), Weather()) is differs
    assert is_noticeable(Weather(), Weather(**fields)) is differs


@given(st.floats(-90.0, -18.0), st.floats(-90.0, -18.0))
def test_nights_after_twilight_look_alike(one, other):
    assert not is_noticeable(Weather(sun_elevation_deg=one), Weather(sun_elevation_deg=other))


@given(
    st.sampled_from([("friction", 15), ("cloud_cover", 50)]),
    st.integers(5, 50),
)
@example(("friction", 15), 80)
@example(("cloud_cover", 50), 20)
def test_a_difference_at_its_limit_is_noticeable(field, hundredths):
    name, limit = field
    less, more = (Weather(**{name: share / 100}) for share in (hundredths, hundredths + limit))
    assert is_noticeable(less, more)
