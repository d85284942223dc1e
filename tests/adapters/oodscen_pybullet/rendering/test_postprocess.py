"""The postprocessing kernel: against the law of fog, against its own shadows, against plain NumPy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shelter import Portal
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._rendering import picture
from oodscen_pybullet._rendering.optics import fade, grain
from oodscen_pybullet._rendering.picture import develop
from oodscen_pybullet._rendering.stage import RawPicture, Shot
from oodscen_pybullet._rendering.triangles import GROUND, PLAIN, SHELTERED, SHINING, SOFT
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._weather import Weather
from oodscen.protocols import Camera
from tests.adapters.oodscen_pybullet.shots import plain_shot

VIEW = CameraView.of(Camera(width=80, height=60, pitch_deg=0.0), (0.0, 0.0, 0.0, 0.0))


def shot(depth: float, *, kind: int = 0, colour: int = 0) -> Shot:
    """A wall of which the right half is white."""
    raw = plain_shot(VIEW, depth, kinds=kind, colour=colour)
    raw.rgb[:, 40:] = 255
    return raw


def show(raw: Shot, *lamps: Lamp, **weather: object) -> np.ndarray:
    conditions = Weather.model_validate(weather)
    light = Light.of(conditions, 0.0, reflects_snow=False)
    return develop(
        RawPicture(raw, VIEW, conditions, light, lamps, time=0.5, seed=1, road_height=0.0)
    )


@pytest.mark.parametrize("threads", [2, 3, 7, 60])
def test_any_number_of_threads_gives_the_same_picture(threads: int) -> None:
    night = Weather(sun_elevation_deg=-8.0, fog_visual_range_m=80.0)
    light = Light.of(night, 0.0, reflects_snow=False)
    raw = RawPicture(shot(12.0, colour=90), VIEW, night, light, (), 0.5, 1, road_height=-1.4)
    assert np.ptp(one := develop(raw)) > 0
    assert np.array_equal(one, develop(replace(raw, threads=threads)))


@given(st.floats(0, 12))
def test_fading_is_exponential(depth: float) -> None:
    assert float(fade(np.float32(depth))) == pytest.approx(math.exp(-depth), rel=0.004, abs=1e-5)


def test_grain_is_even_and_different_everywhere() -> None:
    noise = grain(np.arange(10_000, dtype=np.uint32))
    assert abs(noise.mean()) < 0.1
    assert set(noise.tolist()) == set(range(-4, 5))


@pytest.mark.parametrize("visual_range", [50.0, 120.0, 400.0, 2000.0])
def test_contrast_falls_to_five_per_cent_at_the_visual_range(visual_range: float) -> None:
    shares = (0.25, 0.5, 0.75, 1.0)
    across, upwards = VIEW.slopes()
    stretch = math.sqrt(1 + float(across[41]) ** 2 + float(upwards[30]) ** 2)
    contrasts = []
    for share in shares:
        image = show(shot(share * visual_range / stretch), fog_visual_range_m=visual_range)
        contrasts.append((int(image[30, 41, 0]) - int(image[30, 38, 0])) / 255)
    measured = -math.log(20.0) / np.polyfit(np.array(shares[:3]), np.log(contrasts[:3]), 1)[0]
    assert measured == pytest.approx(1.0, rel=0.1)
    assert contrasts[3] == pytest.approx(0.05, abs=0.006)


def test_what_shines_is_as_bright_by_night_as_by_day() -> None:
    plain = show(shot(60.0), sun_elevation_deg=-30.0)[10, 60]
    lamp = show(shot(60.0, kind=SHINING), sun_elevation_deg=-30.0)[10, 60]
    assert lamp.min() > 240
    assert plain.max() < 120


def test_the_beams_light_near_things_more_than_far_ones_and_the_middle_most() -> None:
    near, far = (show(shot(d, colour=255), sun_elevation_deg=-30.0) for d in (8.0, 90.0))
    assert near[45, 40, 0] > 2 * far[45, 40, 0]
    assert near[45, 40, 0] > 1.3 * near[45, 1, 0]


def test_a_lamp_lights_what_is_below_it() -> None:
    lamp = Lamp((70.0, 0.0, 8.0), (1.0, 0.8, 0.5), (0.0, 0.0, 0.0), 2.0, is_street=True)
    dark, bright = (
        show(shot(70.0, colour=200), *lamps, sun_elevation_deg=-30.0) for lamps in ((), (lamp,))
    )
    assert bright[28, 40].astype(int).sum() > dark[28, 40].astype(int).sum() + 30


@pytest.mark.parametrize(
    ("pitch_deg", "roll_deg"), [(15.0, 0.0), (40.0, 25.0), (60.0, -15.0), (90.0, 0.0)]
)
def test_the_light_of_a_street_lamp_lies_below_it_in_pictures_of_tilted_cameras(
    pitch_deg: float, roll_deg: float
) -> None:
    camera = Camera(width=120, height=90, fov_deg=80.0, x=0.0, z=12.0, pitch_deg=pitch_deg)
    view = replace(CameraView.of(camera, (0.0, 0.0, 0.0, 0.0), roll_deg), is_lit=False)
    across, upwards = view.slopes()
    rise = view.forward[2] + upwards[:, None] * view.up[2] + across * view.right[2]
    depth = np.where(rise < -0.05, -12.0 / np.minimum(rise, -0.05), np.inf).astype(np.float32)
    raw = plain_shot(view, 0.0, kinds=GROUND, colour=120)
    raw.depth[:], raw.reach[:] = depth, depth
    foot = (12.0, 3.0, 0.0) if pitch_deg < 90.0 else (-4.0, 3.0, 0.0)
    lamp = Lamp((*foot[:2], 8.0), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), 2.0, is_street=True)
    night = Weather(sun_elevation_deg=-20.0)
    light = Light.of(night, 0.0, reflects_snow=False)
    dark, lit = (
        develop(RawPicture(raw, view, night, light, lamps, 0.5, 1, road_height=0.0)).astype(int)
        for lamps in ((), (lamp,))
    )
    # The lamp's own glow in the picture is white as well.
    spot, glow = view.pixel(foot), view.pixel(lamp.position)
    assert spot is not None
    gain = (lit - dark)[..., 0].astype(float)
    rows, columns = np.mgrid[:90, :120] + 0.5
    if glow is not None:
        gain[(columns - glow[0]) ** 2 + (rows - glow[1]) ** 2 < 15.0**2] = 0.0
    share = np.where(gain > 0.8 * gain.max(), gain, 0.0)
    assert gain.max() > 20
    x, y = (float((share * grid).sum() / share.sum()) for grid in (columns, rows))
    assert math.dist((x, y), spot[:2]) < 12.0


def test_ground_gets_wet_wherever_it_is_and_grass_and_tunnels_do_not() -> None:
    rain = {"precipitation": "rain", "precipitation_mm_h": 1.0}
    looks = {
        kind: int(show(shot(6.0, kind=kind, colour=120), **rain)[5:20, :38].mean(axis=(0, 1))[1])
        for kind in (PLAIN, GROUND, GROUND + SOFT, GROUND + SHELTERED)
    }
    assert looks[GROUND] < 0.75 * looks[PLAIN]
    assert looks[GROUND + SOFT] == looks[GROUND + SHELTERED] == looks[PLAIN]


def test_headlamps_light_ground_that_rises_above_their_cut_off() -> None:
    wall, slope = (
        show(shot(30.0, kind=kind, colour=160), sun_elevation_deg=-30.0)[10:20, 30:38].mean()
        for kind in (PLAIN, GROUND)
    )
    assert slope > 1.2 * wall


def test_tunnels_are_lit_by_their_own_lamps_and_hazy_only_outside() -> None:
    portal = Portal(is_inside=True, adaptation=1.0, distance=100.0, normal=(0.0, 0.0, 1.0))
    raw = shot(30.0, kind=SHELTERED, colour=120)

    def inside(**weather: object) -> float:
        conditions = Weather.model_validate(weather)
        light = Light.of(conditions, 0.0, reflects_snow=False)
        one = RawPicture(raw, VIEW, conditions, light, (), 0.5, 1, road_height=0.0, portal=portal)
        return float(develop(one)[40:, :38].mean())

    day, night = inside(), inside(sun_elevation_deg=-30.0)
    assert night > 0.6 * day
    assert inside(cloud_cover=1.0) == pytest.approx(day, abs=1.0)
    snow = inside(precipitation="snow", precipitation_mm_h=9.0)
    assert snow == pytest.approx(inside(cloud_cover=1.0), abs=1.0)


@pytest.mark.parametrize(
    "weather",
    [
        {},
        {"cloud_cover": 0.6},
        {"fog_visual_range_m": 80.0},
        {"sun_elevation_deg": -20.0, "fog_visual_range_m": 80.0},
        {"sun_elevation_deg": 4.0},
    ],
)
def test_without_numba_pictures_are_the_same(
    weather: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    for depth in (14.0, math.inf):
        compiled = show(shot(depth, colour=90), **weather)
        with monkeypatch.context() as patch:
            patch.setattr(picture, "is_compiled", lambda: False)
            plain = show(shot(depth, colour=90), **weather)
        assert np.array_equal(compiled, plain)
