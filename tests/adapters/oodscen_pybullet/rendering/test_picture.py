"""A picture is developed in bands by several threads."""

from dataclasses import replace

import numpy as np
import pytest
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shelter import Portal
from oodscen_pybullet._rendering import picture
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._weather import Weather
from oodscen.numerics._kernels import is_compiled
from oodscen.protocols import Camera
from tests.adapters.oodscen_pybullet.shots import plain_shot

pytestmark = pytest.mark.skipif(not is_compiled(), reason="bands need compiled kernels")

VIEW = CameraView.of(Camera(width=80, height=60, pitch_deg=0.0), (0.0, 0.0, 0.0, 0.0))
FOG = Weather(fog_visual_range_m=80.0)
RAW = RawPicture(
    plain_shot(VIEW, 12.0, kinds=0, colour=90),
    VIEW,
    FOG,
    Light.of(FOG, 0.0, reflects_snow=False),
    (),
    0.5,
    1,
    road_height=-1.4,
)


@pytest.mark.parametrize("threads", [2, 3, 60])
def test_the_number_of_threads_changes_no_pixel(threads) -> None:
    np.testing.assert_array_equal(
        picture.develop(replace(RAW, threads=threads)), picture.develop(RAW)
    )


def test_a_band_that_fails_is_no_picture(monkeypatch) -> None:
    def fail(plate, image, first, end):
        if first:
            raise MemoryError("a band")

    monkeypatch.setattr(picture, "postprocess_pixels", fail)
    with pytest.raises(MemoryError, match="a band"):
        picture.develop(replace(RAW, threads=2))


@pytest.mark.parametrize("is_inside", [True, False])
def test_glare_is_told_whether_the_camera_is_in_a_tunnel(is_inside, monkeypatch) -> None:
    told = []
    monkeypatch.setattr(picture, "add_glare", lambda *around, is_inside: told.append(is_inside))
    portal = Portal(is_inside=is_inside, adaptation=0.0, distance=6.0, normal=(0.0, 0.0, 1.0))
    picture.develop(replace(RAW, portal=portal))
    assert told == [is_inside]
