"""Weather comes back unchanged from CARLA's parameters as 32-bit floats, and any parameters are some weather."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oodscen_carla._weather import WeatherParameters, from_carla, to_carla

from oodscen.data import Weather


def numbers(least: int, most: int, scale: float) -> st.SearchStrategy[float]:
    """Return multiples of a scale."""
    return st.integers(least, most).map(lambda whole: round(whole * scale, 6))


@given(
    sun=numbers(-900, 900, 0.1),
    clouds=numbers(0, 100, 0.01),
    fog=st.integers(20, 10_000),
    kind=st.sampled_from(["none", "rain", "snow"]),
    fall=numbers(1, 500, 0.1),
    friction=numbers(10, 100, 0.01),
)
def test_weather_comes_back(sun, clouds, fog, kind, fall, friction):
    weather = Weather(
        sun_elevation_deg=sun,
        cloud_cover=clouds,
        fog_visual_range_m=float(fog),
        precipitation=kind,
        precipitation_mm_h=fall if kind != "none" else 0.0,
        friction=friction,
    )
    wire = WeatherParameters(*(float(np.float32(value)) for value in to_carla(weather)))
    assert from_carla(wire) == weather


@given(st.lists(st.floats(-1e6, 1e6), min_size=14, max_size=14))
def test_any_parameters_are_some_weather(values):
    assert from_carla(WeatherParameters(*values))


def test_carlas_default_air_is_clear():
    assert from_carla(WeatherParameters()).fog_visual_range_m == 10_000.0
