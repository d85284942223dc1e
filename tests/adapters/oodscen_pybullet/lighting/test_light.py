import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._lighting.light import Light

from oodscen.data._weather import Weather


@given(st.floats(-90, 90), st.floats(-90, 90))
def test_daylight_rises_with_the_sun(one: float, two: float) -> None:
    low, high = sorted((one, two))
    lights = [Light.of(Weather(sun_elevation_deg=e), 0.0, reflects_snow=False) for e in (low, high)]
    assert lights[0].daylight <= lights[1].daylight
    for light in lights:
        for way in (light.sun, light.towards_caster):
            assert math.isclose(sum(v * v for v in way), 1.0, rel_tol=0.01)


@given(st.floats(1, 90), st.floats(0, 1))
def test_shadows_darken_the_more_the_sun_lights(elevation: float, cover: float) -> None:
    light = Light.of(
        Weather(sun_elevation_deg=elevation, cloud_cover=cover), 0.3, reflects_snow=False
    )
    dark = light.darkness()
    assert dark.shape == (256,)
    assert dark[0] == 0.0
    assert (np.diff(dark) >= 0.0).all()
    assert dark.max() < 0.75


def test_under_clouds_shadows_fall_straight_down() -> None:
    assert Light.of(Weather(cloud_cover=1.0), 0.0, reflects_snow=False).towards_caster[2] > 0.95
    clear = Light.of(Weather(), 0.0, reflects_snow=False)
    assert clear.towards_caster == clear.sun
