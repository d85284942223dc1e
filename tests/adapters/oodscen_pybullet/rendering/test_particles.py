import numpy as np
import pytest
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.mesh import Puff
from oodscen_pybullet._rendering.particles import add_puffs, covered_pixels
from oodscen_pybullet._rendering.stage import PlacedPuff, RawPicture
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._weather import Weather
from oodscen.protocols import Camera
from tests.adapters.oodscen_pybullet.shots import plain_shot

VIEW = CameraView.of(Camera(width=160, height=120, pitch_deg=0.0), (0.0, 0.0, 0.0, 0.0))
DAY = Light.of(Weather(), 0.0, reflects_snow=False)
NIGHT = Light.of(Weather(sun_elevation_deg=-20.0), 0.0, reflects_snow=False)


def blend(
    puff: Puff, depth: float, light: Light = DAY, rate: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    image = np.full((120, 160, 3), 100, np.uint8)
    shot = plain_shot(VIEW, depth)
    raw = RawPicture(shot, VIEW, Weather(), light, (), 0.0, 0, 0.0, balls=[placed(puff, 3)])
    add_puffs(image, raw, rate, (200.0, 200.0, 200.0))
    return image, shot.rows


def placed(puff: Puff, row: int, ahead: float = 20.0) -> PlacedPuff:
    return PlacedPuff(puff.placed((ahead, 0.0, 0.0), (1.0, 0.0)), row)


def smoke(density: float = 0.9, *, is_bright: bool = False) -> Puff:
    return Puff((0.0, 0.0, 1.4), 2.0, (0.1, 0.1, 0.1), density, is_bright)


def test_dense_smoke_hides_what_is_behind_it_and_not_what_is_before_it() -> None:
    image, rows = blend(smoke(), 40.0)
    assert image[60, 80].max() < 45
    assert rows[60, 80] == 3
    assert rows[5, 5] == -1
    assert image[5, 5].tolist() == [100, 100, 100]
    untouched, nobody = blend(smoke(), 10.0)
    assert (untouched == 100).all()
    assert (nobody == -1).all()


def test_thin_smoke_is_seen_but_is_nobody() -> None:
    image, rows = blend(smoke(0.3), 40.0)
    assert 60 < image[60, 80, 0] < 95
    assert (rows == -1).all()


def test_what_stands_inside_is_half_hidden() -> None:
    whole, half = blend(smoke(), 40.0)[0][60, 80, 0], blend(smoke(), 20.0 - 0.6)[0][60, 80, 0]
    assert whole < half < 100


def test_fire_shines_at_night_and_smoke_does_not() -> None:
    fire = Puff((0.0, 0.0, 1.4), 2.0, (1.0, 0.6, 0.1), 0.9, is_bright=True)
    assert blend(fire, 40.0, NIGHT)[0][60, 80, 0] > 200
    white = Puff((0.0, 0.0, 1.4), 2.0, (1.0, 1.0, 1.0), 0.9)
    assert blend(white, 40.0, NIGHT)[0][60, 80, 0] < 60


def test_fog_takes_smoke_as_it_takes_everything() -> None:
    clear, foggy = (blend(smoke(), 40.0, rate=rate)[0][60, 80, 0] for rate in (0.0, 0.1))
    assert foggy > clear + 60


@pytest.mark.parametrize("near", [3, 5])
def test_of_two_clouds_in_line_the_nearer_is_seen(near: int) -> None:
    shot = plain_shot(VIEW, 60.0)
    balls = [placed(smoke(), near, 10.0), placed(smoke(), 8 - near, 30.0)]
    raw = RawPicture(shot, VIEW, Weather(), DAY, (), 0.0, 0, 0.0, balls=balls)
    add_puffs(np.full((120, 160, 3), 100, np.uint8), raw, 0.0, (200.0, 200.0, 200.0))
    assert shot.rows[60, 80] == near
    assert shot.depth[60, 80] == pytest.approx(10.0, abs=1.0)


def test_what_a_body_would_fill_alone() -> None:
    area = covered_pixels(VIEW, [placed(smoke(), 2)])
    assert 0 < area.sum() == pytest.approx(blend(smoke(), 40.0)[1].__eq__(3).sum(), abs=30)
    assert not covered_pixels(VIEW, []).any()
