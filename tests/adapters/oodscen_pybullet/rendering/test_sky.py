import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._rendering.sky import clear_sky, cloud_columns, cloud_rows, cloud_sheet
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._scene import Weather
from oodscen.driving._sight.visibility import extinction
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


def test_rows_of_clouds_rise_with_the_view_and_stay_on_the_sheet() -> None:
    places = cloud_rows(VIEW)
    assert places.shape == (120, 2)
    assert (np.diff(places.sum(axis=1)) <= 0.0).all()
    assert places[:, 0].min() >= 0.0
    assert places[:, 0].max() + 1 < cloud_sheet(4).shape[0]
    assert ((places[:, 1] >= 0.0) & (places[:, 1] < 1.0)).all()


@given(st.floats(-10, 10))
def test_clouds_stay_where_they_are_when_the_camera_turns(yaw: float) -> None:
    columns = cloud_columns(CameraView.of(Camera(width=160, height=120), (0.0, 0.0, 0.0, yaw)))
    assert columns.min() >= 0.0
    assert columns.max() < 1024.0
    middle = float(columns[79] + columns[80]) / 2 if abs(columns[79] - columns[80]) < 9 else None
    if middle is not None:
        apart = (middle / 1024 - yaw / math.tau) % 1.0
        assert min(apart, 1.0 - apart) < 1e-3


def test_the_sheet_of_clouds_closes_around_the_horizon() -> None:
    sheet = cloud_sheet(4)
    assert np.array_equal(sheet[:, 0], sheet[:, -1])
    assert 0.0 <= sheet.min() < 0.2 < 0.8 < sheet.max() <= 1.0
    assert abs(np.diff(sheet, axis=1)).max() < 0.2
