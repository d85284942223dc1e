"""Exposure: the light and the weather in which a raw picture is developed."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shelter import Portal
from oodscen_pybullet._rendering.exposure import expose
from oodscen_pybullet._rendering.plate import Plate
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.triangles import GROUND
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._weather import Weather
from oodscen.driving._sight.weather import extinction
from oodscen.protocols import Camera
from tests.adapters.oodscen_pybullet.shots import plain_shot

VIEW = CameraView.of(Camera(width=16, height=12, pitch_deg=0.0), (0.0, 0.0, 0.0, 0.0))
SHOT = plain_shot(VIEW, 12.0)
DAY, DUSK, NIGHT = 50.0, 3.0, -20.0
"""Elevations of the sun, degrees."""
COVERS = st.floats(0.0, 1.0)


def exposed(sun: float = DAY, *, sky: Mapping[str, Any] | None = None, **changes: Any) -> Plate:
    """Return the plate of a plain surface, with `sky` for weather and changes of the raw picture."""
    weather = Weather(sun_elevation_deg=sun, **sky or {})
    light = Light.of(weather, 0.0, reflects_snow=False)
    picture = RawPicture(SHOT, VIEW, weather, light, (), time=0.5, seed=1, road_height=0.0)
    return expose(replace(picture, **changes), extinction(weather), (90.0, 90.0, 90.0))


def test_the_darker_the_brighter_are_the_ego_s_beams() -> None:
    day, dusk, night = (float(exposed(sun).beam) for sun in (DAY, DUSK, NIGHT))
    assert 0.0 == day < dusk < night
    assert exposed(NIGHT, view=replace(VIEW, is_lit=False)).beam == 0.0


@pytest.mark.parametrize(
    ("sun", "fog_m", "is_lit", "glows"),
    [
        (NIGHT, 60.0, True, True),
        (NIGHT, 60.0, False, False),
        (NIGHT, 1e5, True, False),
        (DAY, 60.0, True, False),
    ],
)
def test_fog_glows_in_the_ego_s_beams_by_night(
    sun: float, fog_m: float, is_lit: bool, glows: bool
) -> None:
    plate = exposed(sun, view=replace(VIEW, is_lit=is_lit), sky={"fog_visual_range_m": fog_m})
    assert bool(plate.air.halo > 1.0) == glows


def test_the_glow_of_fog_fades_upwards_and_beams_reach_wider_in_the_air() -> None:
    plate = exposed(NIGHT)
    assert (np.diff(plate.halo) >= 0.0).all()
    on_surfaces, in_the_air = plate.beam_spread
    assert (on_surfaces <= in_the_air).all()
    assert (on_surfaces < in_the_air).any()


def test_grain_is_of_the_night_and_another_one_in_every_picture() -> None:
    assert not exposed(DAY).has_grain
    starts = {
        int(exposed(NIGHT, time=time, seed=seed).noise) for time in (0.5, 0.55) for seed in (1, 2)
    }
    assert len(starts) == 4
    assert exposed(NIGHT).has_grain


@given(COVERS, COVERS)
def test_more_cover_is_more_clouds(one: float, two: float) -> None:
    less, more = (exposed(sky={"cloud_cover": cover}).clouds for cover in sorted((one, two)))
    assert less.edge >= more.edge
    assert less.floor <= more.floor
    assert less.shade >= more.shade


def test_a_clear_sky_has_no_clouds_and_an_overcast_one_nothing_else() -> None:
    clear, overcast = (exposed(sky={"cloud_cover": cover}).clouds for cover in (0.0, 1.0))
    assert clear.edge > clear.sheet.max()
    assert clear.floor == 0.0
    assert overcast.floor == 1.0
    assert exposed(NIGHT).clouds.bright < clear.bright


def test_only_rain_wets_the_ground() -> None:
    rain, snow = (
        exposed(sky={"precipitation": fall, "precipitation_mm_h": 5.0}).wet
        for fall in ("rain", "snow")
    )
    assert exposed().wet == snow == 0.0 < rain < 1.0


@given(st.floats(-20.0, 60.0))
def test_a_picture_without_shadows_has_the_sun_s_light_in_the_shade_too(sun: float) -> None:
    plate = exposed(sun)
    assert not plate.shadow.is_cast
    np.testing.assert_allclose(plate.daylight.shade, plate.daylight.direct, rtol=1e-6)


def test_day_is_at_its_brightest_before_the_sun_is_high() -> None:
    light = Light.of(Weather(sun_elevation_deg=DAY), 0.0, reflects_snow=False)
    nearly = exposed(DAY, light=replace(light, daylight=0.995))
    assert (nearly.daylight.direct == exposed(DAY).daylight.direct).all()


def tunnel(*, is_inside: bool = False, adaptation: float = 0.0) -> Portal:
    return Portal(is_inside=is_inside, adaptation=adaptation, distance=6.0, normal=(0.0, 0.0, 1.0))


@pytest.mark.parametrize("sun", [DAY, NIGHT])
def test_a_camera_sees_the_more_of_a_tunnel_the_more_it_has_adapted(sun: float) -> None:
    lamps = [
        exposed(sun, portal=tunnel(adaptation=share)).portal.lamps for share in (0.0, 0.5, 1.0)
    ]
    assert (np.diff(lamps, axis=0) > 0.0).all()


def test_a_tunnel_is_dull_to_who_comes_from_the_day_and_its_air_is_dark_by_day_alone() -> None:
    day, night = (exposed(sun, portal=tunnel(is_inside=True)).portal for sun in (DAY, NIGHT))
    assert (day.lamps < night.lamps).all()
    assert day.air < night.air == 1.0
    assert day.is_ahead
    assert day.is_inside
    assert not exposed(DAY).portal.is_ahead


def test_where_surfaces_are_unknown_the_low_ones_that_are_no_actor_s_are_ground() -> None:
    rows = SHOT.rows.copy()
    rows[:, 8:] = 0
    kinds = exposed(shot=replace(SHOT, kinds=None, rows=rows)).kinds
    assert (kinds[-1, :8] == GROUND).all()
    assert not kinds[:6].any()
    assert not kinds[:, 8:].any()
