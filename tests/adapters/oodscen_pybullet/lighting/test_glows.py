import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._lighting.glows import add_glare, add_glows
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._rendering.view import CameraView

from oodscen.data._weather import Weather
from oodscen.protocols import Camera

WIDTH, HEIGHT = 160, 120
VIEW = CameraView.of(Camera(width=WIDTH, height=HEIGHT), (0.0, 0.0, 0.0, 0.0))
NIGHT = Light.of(Weather(sun_elevation_deg=-20.0), 0.0, reflects_snow=False)
DAY = Light.of(Weather(sun_elevation_deg=50.0), 0.0, reflects_snow=False)
LOW_SUN = Light.of(Weather(sun_elevation_deg=5.0), 0.0, reflects_snow=False)
LAMP = Lamp((20.0, 0.0, 1.0), (1.0, 0.1, 0.1), (-1.0, 0.0, 0.0))
FOG = 0.02
"""Extinction in fog, 1/m."""


def glow(lamp: Lamp, light: Light = NIGHT, *, depth: float = 30.0, extinction: float = 0.0):
    """Return the light that a lamp adds to a black picture, [height, width, 3]."""
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    surfaces = np.full((HEIGHT, WIDTH), depth, np.float32)
    add_glows(image, VIEW, surfaces, light, [lamp], extinction)
    return image.astype(int)


def centre(lamp: Lamp) -> tuple[int, int]:
    """Return the row and column of a lamp."""
    spot = VIEW.pixel(lamp.position)
    assert spot is not None
    return int(spot[1]), int(spot[0])


def spread(image: np.ndarray) -> int:
    """Return how many columns are lit."""
    return int(image.any(axis=(0, 2)).sum())


def ahead(depth: float, *, share: float = 0.5) -> Lamp:
    """Return a strong lamp that shines all round, at a depth and a share of the picture's width."""
    x, _, z = VIEW.eye
    y = (0.5 - share) * WIDTH * depth / VIEW.focal
    return replace(LAMP, position=(x + depth, y, z), facing=(0.0, 0.0, 0.0), power=9.0)


def test_a_lamp_glows_where_it_is_and_only_when_nothing_hides_it() -> None:
    assert glow(LAMP)[(*centre(LAMP), 0)] > 60
    assert not glow(LAMP, depth=10.0).any()
    assert not glow(replace(LAMP, facing=(1.0, 0.0, 0.0))).any()


def test_its_own_glass_does_not_hide_a_lamp() -> None:
    assert (glow(LAMP, depth=19.9 - VIEW.eye[0]) == glow(LAMP)).all()


def test_a_lamp_is_fainter_by_day() -> None:
    assert glow(LAMP, DAY).sum() < 0.5 * glow(replace(LAMP, by_day=1.0), DAY).sum()


def test_a_street_lamp_is_off_by_day() -> None:
    street = replace(LAMP, is_street=True)
    assert glow(street).any()
    assert not glow(street, DAY).any()
    assert glow(LAMP, DAY).any()


def test_the_core_of_a_lamp_is_whitish_and_that_of_a_signal_coloured() -> None:
    for by_day, is_whitish in ((0.22, True), (0.9, False)):
        red, green, _ = glow(replace(LAMP, by_day=by_day), DAY)[centre(LAMP)]
        assert bool(green > 0.3 * red) == is_whitish


@given(st.floats(0.0, 40.0))
def test_a_lamp_seen_somewhat_from_the_side_shines_fully(degrees: float) -> None:
    x, y, z = (VIEW.eye[axis] - LAMP.position[axis] for axis in range(3))
    off = math.radians(degrees)
    turned = (x * math.cos(off) - y * math.sin(off), x * math.sin(off) + y * math.cos(off), z)
    length = math.hypot(*turned)
    lamp = replace(LAMP, facing=tuple(value / length for value in turned))
    assert (glow(lamp) == glow(replace(LAMP, facing=(0.0, 0.0, 0.0)))).all()


def test_a_halo_is_wider_in_the_dark_and_in_fog_and_fog_dims_it() -> None:
    for light in (NIGHT, DAY):
        clear, foggy = (glow(replace(LAMP, by_day=1.0), light, extinction=e) for e in (0.0, FOG))
        assert spread(foggy) > spread(clear)
        assert foggy[centre(LAMP)].sum() < clear[centre(LAMP)].sum()
    by_night, by_day = (glow(replace(LAMP, by_day=1.0), light) for light in (NIGHT, DAY))
    assert spread(by_night) > spread(by_day)


def test_a_near_halo_has_a_greatest_width() -> None:
    near = replace(ahead(1.0), power=4.0)
    assert 0.5 * WIDTH < spread(glow(near, extinction=FOG)) <= 4 * 0.16 * WIDTH + 2


def test_a_lamp_beyond_300_metres_has_no_halo() -> None:
    for depth, shines in ((290.0, True), (310.0, False)):
        assert bool(glow(ahead(depth), depth=1_000.0).any()) == shines


@pytest.mark.parametrize(("share", "shines"), [(-0.03, True), (1.03, True), (-0.2, False)])
def test_a_lamp_just_outside_the_picture_reaches_into_it(share: float, shines: bool) -> None:
    assert bool(glow(ahead(10.0, share=share), extinction=FOG).any()) == shines


def test_only_a_low_sun_ahead_dazzles() -> None:
    far = np.full((HEIGHT, WIDTH), np.inf, np.float32)
    for light, dazzles in ((LOW_SUN, True), (DAY, False)):
        image = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)
        add_glare(image, VIEW, far, light)
        assert bool((image > 200).any()) == dazzles


def glare(depth: float) -> np.ndarray:
    """Return the light that a low sun adds to a black picture behind surfaces at some depth."""
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    add_glare(image, VIEW, np.full((HEIGHT, WIDTH), depth, np.float32), LOW_SUN)
    return image.astype(int)


def test_a_tunnel_has_glare_only_where_the_sun_is_seen() -> None:
    for depth, is_seen in ((400.0, True), (390.0, False)):
        image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
        far = np.full((HEIGHT, WIDTH), depth, np.float32)
        add_glare(image, VIEW, far, LOW_SUN, is_inside=True)
        assert (image == (glare(depth) if is_seen else 0)).all()


@pytest.mark.parametrize("is_inside", [True, False])
def test_a_sun_beside_the_picture_dazzles_in_the_open_only(is_inside: bool) -> None:
    aside = CameraView.of(Camera(width=WIDTH, height=HEIGHT, yaw_deg=-30.0), (0.0, 0.0, 0.0, 0.0))
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    sky = np.full((HEIGHT, WIDTH), np.inf, np.float32)
    add_glare(image, aside, sky, LOW_SUN, is_inside=is_inside)
    assert image.any() != is_inside


def test_a_hidden_sun_leaves_a_part_of_its_veil() -> None:
    seen, hidden = glare(400.0), glare(390.0)
    assert seen.max() == 255
    assert 20 < hidden.max() < 40
    is_veiled = (hidden > 0).any(axis=2)
    assert is_veiled.mean() > 0.5
    assert (seen[is_veiled] >= hidden[is_veiled]).all()
