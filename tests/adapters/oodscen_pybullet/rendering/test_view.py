import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._rendering.view import FAR_M, NEAR_M, CameraView, metres

from oodscen.protocols import Camera

reals = st.floats(-40, 40)


@given(x=reals, y=reals, yaw=st.floats(-3, 3), pitch=st.floats(-20, 20), turn=st.floats(-180, 180))
def test_the_axes_are_orthonormal_and_look_along_the_yaw(
    x: float, y: float, yaw: float, pitch: float, turn: float
) -> None:
    view = CameraView.of(Camera(pitch_deg=pitch, yaw_deg=turn), (x, y, 0.0, yaw))
    axes = np.array([view.right, view.up, view.forward])
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(np.array([view.right, view.up, -axes[2]])) == pytest.approx(1.0)
    heading = math.atan2(view.forward[1], view.forward[0])
    assert math.cos(heading - yaw - math.radians(turn)) == pytest.approx(1.0)


@given(across=st.floats(-0.5, 0.5), upwards=st.floats(-0.4, 0.4), ahead=st.floats(1, 200))
def test_pixels_and_slopes_agree(across: float, upwards: float, ahead: float) -> None:
    view = CameraView.of(Camera(width=160, height=120), (3.0, -2.0, 0.5, 0.7))
    point = tuple(
        view.eye[i] + ahead * (view.forward[i] + across * view.right[i] + upwards * view.up[i])
        for i in range(3)
    )
    spot = view.pixel((point[0], point[1], point[2]))
    assert spot is not None
    column, row, depth = spot
    assert depth == pytest.approx(ahead)
    x, y = view.slopes()
    assert np.interp(column - 0.5, np.arange(160), x) == pytest.approx(across, abs=0.02)
    assert np.interp(row - 0.5, np.arange(120), y) == pytest.approx(upwards, abs=0.02)


def test_what_is_behind_has_no_pixel() -> None:
    view = CameraView.of(Camera(), (0.0, 0.0, 0.0, 0.0))
    assert view.pixel((-5.0, 0.0, 1.0)) is None
    back = CameraView.of(Camera().behind(), (0.0, 0.0, 0.0, 0.0))
    assert back.pixel((5.0, 0.0, 1.0)) is None
    spot = back.pixel((-12.0, 1.0, 1.0))
    assert spot is not None
    assert spot[0] > back.width / 2
    assert spot[2] == pytest.approx(10.0, abs=0.1)


@given(st.floats(NEAR_M * 1.01, FAR_M * 0.6))
def test_depth_is_linear_again(depth: float) -> None:
    stored = np.float32((FAR_M - FAR_M * NEAR_M / depth) / (FAR_M - NEAR_M))
    assert metres(np.array([stored]))[0] == pytest.approx(depth, rel=2e-2)


def test_the_sky_is_infinitely_far() -> None:
    assert np.isinf(metres(np.array([1.0], np.float32)))[0]


@given(st.floats(-180.0, 180.0), st.floats(-89.0, 89.0), st.floats(-3.0, 3.0))
def test_a_rolled_camera_keeps_its_axes_at_right_angles(roll, pitch, yaw):
    view = CameraView.of(Camera(pitch_deg=pitch), (1.0, 2.0, 3.0, yaw), roll)
    axes = np.array([view.right, view.up, view.forward])
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    assert np.allclose(np.cross(view.right, view.up), -np.array(view.forward), atol=1e-9)
    level = CameraView.of(Camera(pitch_deg=pitch), (1.0, 2.0, 3.0, yaw))
    # Clockwise: the right side of the camera goes down.
    assert np.isclose(np.dot(view.right, level.up), -np.sin(np.radians(roll)), atol=1e-9)
