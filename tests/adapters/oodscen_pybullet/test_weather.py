import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet.light import Caster, Glow, Light, add_glows, illumination, shadow_mask
from oodscen_pybullet.view import View
from oodscen_pybullet.weather import extinction, rain_streaks, sky, snow_flakes, veil

from oodscen.protocols import Camera
from oodscen.scene import Weather

VIEW = View.of(Camera(width=160, height=120), (0.0, 0.0, 0.0, 0.0))
DAY = Light.of(Weather(), 0.0, is_snowy=False)
NIGHT = Light.of(Weather(sun_elevation_deg=-20.0), 0.0, is_snowy=False)


def contrast(weather: Weather, distance: float) -> float:
    image = np.zeros((1, 2, 3), np.float32)
    image[0, 1] = 255.0
    far = np.full((1, 2), distance, np.float32)
    faded = veil(image, far, extinction(weather), (190.0, 195.0, 200.0))
    return float(faded[0, 1, 0] - faded[0, 0, 0]) / 255.0


@given(st.floats(15, 9_000))
def test_contrast_at_the_visual_range_is_five_per_cent(visual_range: float) -> None:
    weather = Weather(fog_visual_range_m=visual_range)
    assert contrast(weather, visual_range) == pytest.approx(0.05, abs=2e-3)


@given(st.floats(15, 2_000), st.floats(1, 300), st.floats(1, 300))
def test_contrast_falls_with_distance(visual_range: float, one: float, two: float) -> None:
    weather = Weather(fog_visual_range_m=visual_range)
    near, far = sorted((one, two))
    assert contrast(weather, far) <= contrast(weather, near) + 1e-6


@given(st.floats(1, 5_000))
def test_clear_air_changes_nothing(distance: float) -> None:
    image = np.full((2, 2, 3), 77.0, np.float32)
    assert (
        veil(image, np.full((2, 2), distance, np.float32), extinction(Weather()), (1, 2, 3))
        is image
    )


def test_rain_and_snow_dim_the_view_the_more_the_harder_they_fall() -> None:
    for kind in ("rain", "snow"):
        rates = [
            extinction(Weather.model_validate({"precipitation": kind, "precipitation_mm_h": mm}))
            for mm in (1.0, 5.0, 20.0, 50.0)
        ]
        assert rates == sorted(rates)
        assert rates[0] > 0.0


@given(st.floats(-90, 90), st.floats(-90, 90))
def test_daylight_rises_with_the_sun(one: float, two: float) -> None:
    low, high = sorted((one, two))
    lights = [Light.of(Weather(sun_elevation_deg=e), 0.0, is_snowy=False) for e in (low, high)]
    assert lights[0].daylight <= lights[1].daylight
    assert all(math.isclose(sum(v * v for v in light.sun), 1.0) for light in lights)


def test_head_lamps_light_near_ground_more_than_far() -> None:
    near = illumination(VIEW, np.full((120, 160), 8.0, np.float32), NIGHT, [], 0.0)
    far = illumination(VIEW, np.full((120, 160), 80.0, np.float32), NIGHT, [], 0.0)
    assert near[80, 80, 0] > 3 * far[80, 80, 0]
    assert near[80, 80, 0] > 2 * near[80, 2, 0]


def test_a_lamp_glows_where_it_is_and_only_when_nothing_hides_it() -> None:
    lamp = Glow((20.0, 0.0, 1.0), (1.0, 0.1, 0.1), (-1.0, 0.0, 0.0), 1.0)
    spot = VIEW.pixel(lamp.position)
    assert spot is not None
    row, column = int(spot[1]), int(spot[0])
    for depth, shines in ((30.0, True), (10.0, False)):
        image = np.zeros((120, 160, 3), np.float32)
        add_glows(image, VIEW, np.full((120, 160), depth, np.float32), [lamp], NIGHT, 0.0)
        assert bool(image[row, column, 0] > 60.0) == shines
    image = np.zeros((120, 160, 3), np.float32)
    away = Glow(lamp.position, lamp.colour, (1.0, 0.0, 0.0), 1.0)
    add_glows(image, VIEW, np.full((120, 160), 30.0, np.float32), [away], NIGHT, 0.0)
    assert not image.any()


def test_a_shadow_lies_at_the_foot_of_what_throws_it() -> None:
    caster = Caster((12.0, 0.0, 0.0, 0.3), (((0.0, 0.0, 0.5), (0.5, 0.5, 0.5)),))
    mask = shadow_mask(VIEW, [caster], DAY.sun, 0.0)
    foot = VIEW.pixel((12.0, 0.0, 0.0))
    assert foot is not None
    assert mask[int(foot[1]), int(foot[0])] > 0.9
    assert mask[:40].max() == 0.0


@pytest.mark.parametrize("cover", [0.0, 0.3, 1.0])
def test_skies_are_bright_by_day_and_dark_by_night(cover: float) -> None:
    weather = Weather(cloud_cover=cover)
    day = sky(VIEW, weather, DAY, 1, rows=60)
    night = sky(VIEW, weather.model_copy(update={"sun_elevation_deg": -20.0}), NIGHT, 1, rows=60)
    assert day.shape == (60, 160, 3)
    assert day.min() > 60.0 > night.max()


def test_what_falls_depends_on_seed_and_time_alone() -> None:
    rain = Weather(precipitation="rain", precipitation_mm_h=20.0)
    snow = Weather(precipitation="snow", precipitation_mm_h=5.0)
    depth = np.full((120, 160), 50.0, np.float32)
    for draw in (
        lambda seed, time: rain_streaks(VIEW, rain, seed, time),
        lambda seed, time: snow_flakes(VIEW, snow, depth, seed, time),
    ):
        assert np.array_equal(draw(1, 0.5), draw(1, 0.5))
        assert not np.array_equal(draw(1, 0.5), draw(1, 0.55))
        assert not np.array_equal(draw(1, 0.5), draw(2, 0.5))
        assert draw(1, 0.5).max() > 0.0
