"""Clouds: where the sheet of them lies in a picture."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._rendering.clouds import cloud_columns, cloud_rows, cloud_sheet
from oodscen_pybullet._rendering.view import CameraView

from oodscen.protocols import Camera

VIEW = CameraView.of(Camera(width=160, height=120), (0.0, 0.0, 0.0, 0.0))


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
