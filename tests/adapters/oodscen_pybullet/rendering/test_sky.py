import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._rendering.sky import clear_sky
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._weather import Weather
from oodscen.driving._sight.weather import extinction
from oodscen.protocols import Camera

VIEW = CameraView.of(Camera(width=160, height=120), (0.0, 0.0, 0.0, 0.0))
DAY = Light.of(Weather(), 0.0, reflects_snow=False)
NIGHT = Light.of(Weather(sun_elevation_deg=-20.0), 0.0, reflects_snow=False)


@given(st.floats(15, 9_000))
def test_contrast_at_the_visual_range_is_five_per_cent(visual_range: float) -> None:
    rate = extinction(Weather(fog_visual_range_m=visual_range))
    assert math.exp(-rate * visual_range) == pytest.approx(0.05, rel=1e-9)


def test_clear_air_takes_nothing_away() -> None:
    assert extinction(Weather()) == 0.0


def test_rain_and_snow_dim_the_view_the_more_the_harder_they_fall() -> None:
    for kind in ("rain", "snow"):
        rates = [
            extinction(Weather.model_validate({"precipitation": kind, "precipitation_mm_h": mm}))
            for mm in (1.0, 5.0, 20.0, 50.0)
        ]
        assert rates == sorted(rates)
        assert rates[0] > 0.0


def test_skies_are_bright_by_day_and_dark_by_night_and_bluest_above() -> None:
    day = clear_sky(VIEW, Weather(), DAY)
    night = clear_sky(VIEW, Weather(sun_elevation_deg=-20.0), NIGHT)
    assert day.shape == (120, 3)
    assert day[:60].min() > 60.0 > night[:60].max()
    assert (np.diff(day[:50, 2] - day[:50, 0]) <= 0.0).all()
