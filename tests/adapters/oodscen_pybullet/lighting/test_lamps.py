import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from oodscen_pybullet._lighting.lamps import camera_row, ground_light
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._weather import Weather
from oodscen.protocols import Camera

VIEW = CameraView.of(Camera(width=160, height=120), (0.0, 0.0, 0.0, 0.0))
DAY = Light.of(Weather(), 0.0, reflects_snow=False)
NIGHT = Light.of(Weather(sun_elevation_deg=-20.0), 0.0, reflects_snow=False)


def test_head_lamps_light_the_ground_that_they_face() -> None:
    oncoming = Lamp((40.0, 3.0, 0.7), (1.0, 1.0, 0.9), (-1.0, 0.0, 0.0), 4.0)
    grid = ground_light(VIEW, [oncoming], NIGHT)
    assert grid is not None
    column = grid.shape[1] // 2 - 6
    before, behind = grid[(2 * 32), column, 0], grid[(2 * 48), column, 0]
    assert before > 0.2
    assert behind == 0.0
    assert grid[64, column, 0] > 2 * grid[64, column + 16, 0]
    assert ground_light(VIEW, [oncoming], DAY) is None


@given(st.floats(5, 40), st.floats(-15, 15), st.floats(-30, 90), st.floats(-40, 40))
def test_street_lamps_light_what_is_below_them_most_however_a_camera_is_tilted(
    ahead: float, aside: float, pitch_deg: float, roll_deg: float
) -> None:
    camera = Camera(width=160, height=120, x=0.0, pitch_deg=pitch_deg)
    view = CameraView.of(camera, (0.0, 0.0, 0.0, 0.0), roll_deg)
    lamp = Lamp((ahead, -aside, 8.0), (1.0, 0.8, 0.5), (0.0, 0.0, 0.0), 2.0, is_street=True)
    grid = ground_light(view, [lamp], NIGHT)
    assert grid is not None
    row, column = np.unravel_index(grid[..., 0].argmax(), grid.shape[:2])
    assert abs((row - camera_row(view)) * 0.5 - ahead) < 0.6
    assert abs((column - 80) * 0.5 - aside) < 0.6
    assert (grid[..., 0] >= grid[..., 2]).all()


@pytest.mark.parametrize(("start", "step", "facing"), [(100.0, 0.25, -1.0), (-20.0, -0.25, 1.0)])
def test_a_headlamp_outside_the_grid_fades_in(start: float, step: float, facing: float) -> None:
    brightest = []
    for index in range(200):
        place = (start + step * index, 0.0, 0.7)
        grid = ground_light(VIEW, [Lamp(place, (1.0, 1.0, 1.0), (facing, 0.0, 0.0), 4.0)], NIGHT)
        brightest.append(0.0 if grid is None else float(grid.max()))
    assert brightest[0] > 0.1
    assert brightest[-1] == 0.0
    assert np.abs(np.diff(brightest)).max() < 0.02


@given(st.floats(-20.0, 45.0), st.floats(0.0, 80.0), st.floats(0.0, 360.0))
def test_neither_the_tilt_of_a_lamp_nor_that_of_a_camera_dims_it(
    pitch_deg: float, tilt_deg: float, turn_deg: float
) -> None:
    place, (tilt, turn) = (30.0, 0.0, 1.3), np.radians((tilt_deg, turn_deg))
    level = (float(np.cos(turn)), float(np.sin(turn)), 0.0)
    tilted = (level[0] * float(np.cos(tilt)), level[1] * float(np.cos(tilt)), -float(np.sin(tilt)))
    pitched = CameraView.of(
        Camera(width=160, height=120, z=1.3, pitch_deg=pitch_deg), (0.0, 0.0, 0.0, 0.0)
    )
    brightest = []
    for view, facing in ((VIEW, level), (VIEW, tilted), (pitched, tilted)):
        grid = ground_light(view, [Lamp(place, (1.0, 1.0, 1.0), facing, 4.0)], NIGHT)
        assert grid is not None
        brightest.append(float(grid.max()))
    assert brightest[1:] == pytest.approx([brightest[0]] * 2, rel=1e-4)


@pytest.mark.parametrize("pitch_deg", [0.0, 0.001, 2.0, 30.0])
@pytest.mark.parametrize("facing", [(0.0, 0.0, -1.0), (0.0, 0.0, 1.0), (1e-17, 0.01, -1.0)])
def test_a_lamp_straight_up_or_down_shines_all_round(pitch_deg, facing) -> None:
    view = CameraView.of(Camera(width=160, height=120, pitch_deg=pitch_deg), (0.0, 0.0, 0.0, 0.0))
    white, place = (1.0, 1.0, 1.0), (20.0, 0.0, 0.7)
    grid = ground_light(view, [Lamp(place, white, facing, 4.0)], NIGHT)
    bare = ground_light(view, [Lamp(place, white, (0.0, 0.0, 0.0), 4.0)], NIGHT)
    assert grid is not None
    assert (grid == bare).all()


def test_a_camera_that_looks_straight_down_sees_light_behind_itself_too() -> None:
    view = CameraView.of(Camera(x=0.0, z=40.0, pitch_deg=90.0), (0.0, 0.0, 0.0, 0.0))
    lamp = Lamp((-30.0, 0.0, 8.0), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), 2.0, is_street=True)
    grid = ground_light(view, [lamp], NIGHT)
    assert grid is not None
    row = int(grid[:, 80, 0].argmax())
    assert abs((row - camera_row(view)) * 0.5 + 30.0) < 0.6


def test_lamps_that_light_nothing_in_front_of_the_camera_give_no_grid() -> None:
    behind = Lamp((-3.0, 0.0, 0.7), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), 1.0)
    assert ground_light(VIEW, [behind], NIGHT) is None
    assert ground_light(VIEW, [], NIGHT) is None


@given(st.floats(0.0, 6.0, exclude_min=True), st.floats(5.0, 40.0), st.floats(-15.0, 15.0))
@example(1e-300, 20.3, 0.1)
def test_the_weakest_lamp_adds_some_light_or_none(power: float, ahead: float, left: float) -> None:
    lamp = Lamp((ahead, left, 0.7), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), power)
    grid = ground_light(VIEW, [lamp], NIGHT)
    assert grid is None or (np.isfinite(grid).all() and grid.min() >= 0.0)
