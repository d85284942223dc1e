import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._lighting.lamps import ground_light
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._scene import Weather
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


@given(st.floats(5, 80), st.floats(-15, 15))
def test_street_lamps_light_what_is_below_them_most(ahead: float, aside: float) -> None:
    lamp = Lamp((ahead, -aside, 8.0), (1.0, 0.8, 0.5), (0.0, 0.0, 0.0), 2.0, is_street=True)
    grid = ground_light(VIEW, [lamp], NIGHT)
    assert grid is not None
    row, column = np.unravel_index(grid[..., 0].argmax(), grid.shape[:2])
    place, _, far = VIEW.to_camera(lamp.position)
    assert abs(row * 0.5 - far) < 0.6
    assert abs((column - 80) * 0.5 - place) < 0.6
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
