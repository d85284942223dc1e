"""Weather comes back unchanged from CARLA's parameters as 32-bit floats, and any parameters are some weather."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from oodscen_carla._weather import WeatherParameters, from_carla, to_carla

from oodscen.data import Weather

PRESETS = {
    "ClearNoon": (5, 0, 0, 10, -1, 45, 2, 0.75, 0.1, 0),
    "CloudyNoon": (60, 0, 0, 10, -1, 45, 3, 0.75, 0.1, 0),
    "WetNoon": (5, 0, 50, 10, -1, 45, 3, 0.75, 0.1, 0),
    "MidRainyNoon": (60, 60, 60, 60, -1, 45, 3, 0.75, 0.1, 0),
    "HardRainNoon": (100, 100, 90, 100, -1, 45, 7, 0.75, 0.1, 0),
    "WetCloudySunset": (60, 0, 50, 10, -1, 15, 2, 0.75, 0.1, 0),
    "HardRainSunset": (100, 100, 90, 100, -1, 15, 7, 0.75, 0.1, 0),
    "ClearNight": (5, 0, 0, 10, -1, -90, 60, 75, 1, 0),
    "WetCloudyNight": (60, 0, 50, 10, -1, -90, 60, 0.75, 0.1, 60),
    "HardRainNight": (100, 100, 90, 100, -1, -90, 100, 0.75, 0.1, 100),
}
"""Presets of CARLA 0.9.16, one of each kind of air."""


def numbers(least: int, most: int, scale: float) -> st.SearchStrategy[float]:
    """Return multiples of a scale."""
    return st.integers(least, most).map(lambda whole: round(whole * scale, 6))


def on_the_wire(parameters: WeatherParameters) -> WeatherParameters:
    """Return parameters as 32-bit floats."""
    return WeatherParameters(*(float(np.float32(value)) for value in parameters))


@given(
    sun=numbers(-900_000, 900_000, 1e-4),
    clouds=numbers(0, 1_000_000, 1e-6),
    fog=numbers(2_000, 999_999, 0.01) | st.integers(10_000, 10_000).map(float),
    kind=st.sampled_from(["none", "rain", "snow"]),
    fall=numbers(1, 500_000, 1e-4),
    friction=numbers(50_000, 1_000_000, 1e-6),
)
@example(sun=0.00001, clouds=0.0, fog=20.0, kind="rain", fall=1e-7, friction=0.05)
def test_weather_comes_back(sun, clouds, fog, kind, fall, friction):
    weather = Weather(
        sun_elevation_deg=sun,
        cloud_cover=clouds,
        fog_visual_range_m=fog,
        precipitation=kind,
        precipitation_mm_h=fall if kind != "none" else 0.0,
        friction=friction,
    )
    assert from_carla(on_the_wire(to_carla(weather))) == weather


@pytest.mark.parametrize(
    ("given", "held"),
    [
        ({"fog_visual_range_m": 15.0}, {"fog_visual_range_m": 20.0}),
        ({"fog_visual_range_m": 20_000.0}, {"fog_visual_range_m": 10_000.0}),
        (
            {"precipitation": "snow", "precipitation_mm_h": 80.0},
            {"precipitation": "snow", "precipitation_mm_h": 50.0},
        ),
        ({"friction": 1.3}, {"friction": 1.0}),
        ({"friction": 0.02}, {"friction": 0.05}),
    ],
)
def test_what_carla_cannot_hold_is_cut_off_at_its_limits(given, held):
    assert from_carla(on_the_wire(to_carla(Weather(**given)))) == Weather(**held)


@given(st.lists(st.floats(-1e6, 1e6), min_size=14, max_size=14))
def test_any_parameters_are_some_weather(values):
    assert from_carla(WeatherParameters(*values))


def test_carlas_default_air_is_clear():
    assert from_carla(WeatherParameters()).fog_visual_range_m == 10_000.0


@pytest.mark.parametrize("name", PRESETS)
def test_no_preset_of_carla_is_foggy(name):
    shown = from_carla(on_the_wire(WeatherParameters(*PRESETS[name])))
    assert shown.fog_visual_range_m == 10_000.0
    assert (shown.precipitation == "rain") == ("Rain" in name)


def test_every_preset_is_one_of_the_known_airs():
    carla = pytest.importorskip("carla")
    kind = carla.WeatherParameters
    found = {name: getattr(kind, name) for name in dir(kind)}
    airs = {}
    for name, preset in found.items():
        if isinstance(preset, kind) and name != "Default":
            given = WeatherParameters(*(getattr(preset, it) for it in WeatherParameters._fields))
            assert from_carla(given).fog_visual_range_m == 10_000.0, name
            airs[name] = given[:10]
    assert len(airs) == 22
    for name, expected in PRESETS.items():
        assert airs[name] == pytest.approx(expected), name


@pytest.mark.parametrize(
    ("density", "visual_range"), [(7.0, 10_000.0), (10.0, 200.0), (50.0, 40.0)]
)
def test_fog_denser_than_that_of_carlas_presets_is_fog(density, visual_range):
    given = WeatherParameters(fog_density=density)
    assert from_carla(given).fog_visual_range_m == visual_range
    assert from_carla(given._replace(fog_distance=0.0)).fog_visual_range_m == pytest.approx(
        2_000.0 / density, rel=1e-5
    )


def test_night_fog_that_is_no_preset_is_fog():
    night = WeatherParameters(*PRESETS["ClearNight"])
    for other in ({"fog_density": 59.0}, {"fog_distance": 10.0}, {"sun_altitude_angle": -30.0}):
        assert from_carla(night._replace(**other)).fog_visual_range_m < 35.0


def test_rain_in_dense_air_is_no_snow():
    rain = WeatherParameters(precipitation=50.0, fog_falloff=8.0)
    assert from_carla(rain).precipitation == "rain"


def test_only_wetness_makes_the_road_slippery():
    wet = WeatherParameters(precipitation_deposits=100.0)
    assert from_carla(wet).friction == 1.0
    assert from_carla(wet._replace(wetness=30.0)).friction == 0.7
