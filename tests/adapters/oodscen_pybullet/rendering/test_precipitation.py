import numpy as np
import pytest
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shelter import Portal
from oodscen_pybullet._rendering.precipitation import add_rain, add_snow
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.triangles import SHELTERED
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._weather import Weather
from oodscen.protocols import Camera
from tests.adapters.oodscen_pybullet.shots import plain_shot

VIEW = CameraView.of(Camera(width=160, height=120), (0.0, 0.0, 0.0, 0.0))
SNOW = Weather(precipitation="snow", precipitation_mm_h=9.0)
RAIN = Weather(precipitation="rain", precipitation_mm_h=20.0)
DAY = Light.of(Weather(), 0.0, reflects_snow=False)
NIGHT = Light.of(Weather(sun_elevation_deg=-20.0), 0.0, reflects_snow=False)


def falling(
    weather: Weather,
    image: np.ndarray,
    *,
    light: Light = DAY,
    depth: float = 50.0,
    kinds: int | np.ndarray = 0,
    portal: Portal | None = None,
    seed: int = 1,
    time: float = 0.5,
) -> np.ndarray:
    """Return a picture into which rain or snow falls."""
    shot = plain_shot(VIEW, depth, kinds=kinds)
    picture = RawPicture(shot, VIEW, weather, light, (), time, seed, 0.0, portal=portal)
    add = add_rain if weather.precipitation == "rain" else add_snow
    assert shot.kinds is not None
    add(image, picture, shot.kinds)
    return image


def grey(value: int) -> np.ndarray:
    return np.full((120, 160, 3), value, np.uint8)


@pytest.mark.parametrize("weather", [RAIN, SNOW])
def test_what_falls_depends_on_seed_and_time_alone(weather: Weather) -> None:
    def draw(seed: int, time: float) -> bytes:
        image = falling(weather, grey(40), seed=seed, time=time)
        assert image.max() > 60
        assert image.min() >= 40
        return image.tobytes()

    assert draw(1, 0.5) == draw(1, 0.5)
    assert len({draw(1, 0.5), draw(1, 0.55), draw(2, 0.5)}) == 3


def test_flakes_fall_behind_what_is_near() -> None:
    assert not falling(SNOW, grey(0), depth=0.5, time=0.0).any()


@pytest.mark.parametrize("weather", [RAIN, SNOW])
def test_nothing_falls_into_tunnels(weather: Weather) -> None:
    kinds = np.zeros((120, 160), np.uint8)
    kinds[:, 80:] = SHELTERED

    def draw(portal: Portal | None) -> np.ndarray:
        image = falling(weather, grey(0), kinds=kinds, portal=portal)
        return np.count_nonzero(image.any(axis=2), axis=0)

    open_air, ahead = (0.0, 0.0, 1.0), draw(None)
    into = draw(Portal(is_inside=False, adaptation=0.0, distance=6.0, normal=open_air))
    out = draw(Portal(is_inside=True, adaptation=1.0, distance=6.0, normal=open_air))
    assert (into[:80] == ahead[:80]).all()
    assert 0 < into[80:].sum() < 0.8 * ahead[80:].sum()
    assert 0 < out.sum() < ahead.sum() - into.sum() + ahead.sum()
    beyond = draw(Portal(is_inside=True, adaptation=1.0, distance=60.0, normal=open_air))
    assert not beyond.any()


def test_flakes_in_the_beams_are_brighter_than_the_road_and_darken_nothing() -> None:
    image = falling(SNOW, grey(190), light=NIGHT)
    assert image.min() >= 190
    middle = image[60:, 50:110]
    assert (middle > 215).any(axis=2).mean() > 0.02
