"""The line on the weather says what its reader needs: the catalogue's limits, as numbers."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._catalogue import WeatherRange
from oodscen.data._weather import CLEAR_AIR_M, DUSK_DEG, WEATHER_KINDS
from oodscen.prompts._weather_line import WeatherLimits, weather_line
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE


def limits(**fields) -> WeatherLimits:
    weather = WeatherRange(**fields)
    return WeatherLimits.of(weather_line(FLAT_CATALOGUE.model_copy(update={"weather": weather})))


@given(
    st.floats(-90.0, 90.0),
    st.floats(0.0, CLEAR_AIR_M),
    st.floats(0.0, 1e9),
    st.floats(0.0, 1.0),
    st.lists(st.sampled_from(("rain", "snow")), unique=True),
    st.booleans(),
    st.lists(st.sampled_from(("dust", "wind", "northern lights")), unique=True),
)
def test_every_limit_is_read_back(sun, fog, intensity, friction, kinds, is_drawn, others):
    read = limits(
        min_sun_elevation_deg=sun,
        min_fog_visual_range_m=fog,
        max_precipitation_mm_h=intensity,
        min_friction=friction,
        precipitation=("none", *kinds),
        sun_is_drawn=is_drawn,
        others=tuple(others),
    )
    assert read == WeatherLimits(
        fog_m=fog if fog < 5_000.0 else CLEAR_AIR_M,
        rain="rain" in kinds,
        snow="snow" in kinds,
        intensity=intensity if kinds else 0.0,
        friction=friction,
        sun_deg=sun,
        sun_is_drawn=is_drawn,
        others=tuple(others),
    )


def test_a_need_is_offered_if_a_limit_or_a_name_has_it():
    bare = limits(min_sun_elevation_deg=5.0)
    assert not any(map(bare.offers, (*WEATHER_KINDS, "dust")))
    every = limits(
        min_sun_elevation_deg=-90.0,
        min_fog_visual_range_m=30.0,
        precipitation=("rain", "snow"),
        min_friction=0.1,
        others=("dust",),
    )
    assert all(map(every.offers, (*WEATHER_KINDS, "dust")))
    assert not every.offers("wind")


def test_clear_air_and_dusk_end_at_their_borders():
    assert limits(min_fog_visual_range_m=4_999.0).fog_m == 4_999.0
    assert limits(min_fog_visual_range_m=5_000.0).fog_m == CLEAR_AIR_M
    assert not limits(min_sun_elevation_deg=DUSK_DEG).offers("night")
    assert WeatherLimits.of("no night; no fog; no precipitation").friction == 1.0
