import numpy as np
from oodscen_pybullet._lighting.glows import add_glare, add_glows
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._scene import Weather
from oodscen.protocols import Camera

VIEW = CameraView.of(Camera(width=160, height=120), (0.0, 0.0, 0.0, 0.0))
NIGHT = Light.of(Weather(sun_elevation_deg=-20.0), 0.0, reflects_snow=False)


def test_a_lamp_glows_where_it_is_and_only_when_nothing_hides_it() -> None:
    lamp = Lamp((20.0, 0.0, 1.0), (1.0, 0.1, 0.1), (-1.0, 0.0, 0.0), 1.0)
    spot = VIEW.pixel(lamp.position)
    assert spot is not None
    row, column = int(spot[1]), int(spot[0])
    for depth, shines in ((30.0, True), (10.0, False)):
        image = np.zeros((120, 160, 3), np.uint8)
        add_glows(image, VIEW, np.full((120, 160), depth, np.float32), NIGHT, [lamp], 0.0)
        assert bool(image[row, column, 0] > 60) == shines
    image = np.zeros((120, 160, 3), np.uint8)
    away = Lamp(lamp.position, lamp.colour, (1.0, 0.0, 0.0), 1.0)
    add_glows(image, VIEW, np.full((120, 160), 30.0, np.float32), NIGHT, [away], 0.0)
    assert not image.any()


def test_only_a_low_sun_ahead_dazzles() -> None:
    far = np.full((120, 160), np.inf, np.float32)
    for elevation, dazzles in ((5.0, True), (50.0, False)):
        light = Light.of(Weather(sun_elevation_deg=elevation), 0.0, reflects_snow=False)
        image = np.full((120, 160, 3), 90, np.uint8)
        add_glare(image, VIEW, far, light)
        assert bool((image > 200).any()) == dazzles
