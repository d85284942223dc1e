"""Measuring a hazard in a frame: by its pixels, or by geometry where a simulator has no segmentation."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scene import Hazard
from oodscen.data._sighting import apparent_size
from oodscen.data._weather import Weather
from oodscen.protocols import Camera, Frame
from oodscen.stages._pictures.visibility import sighting
from oodscen.stages._simulate import approach
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

SMALL = Camera(width=160, height=120)
SCENE = example_scene()
DARK = SCENE.model_copy(update={"weather": Weather(sun_elevation_deg=-20.0)})


@pytest.fixture(scope="module")
def view():
    with FlatSimulator() as simulator:
        state = approach(SCENE, simulator, 0)[0][-1]
        yield simulator.catalogue(), state, simulator.render(SMALL), simulator.render(Camera())


def test_size_does_not_depend_on_the_picture(view):
    catalogue, state, small, large = view
    one = sighting(SCENE, state, small, catalogue, SMALL)
    two = sighting(SCENE, state, large, catalogue, Camera())
    assert one.height_px == pytest.approx(two.height_px, abs=480 / 120)
    assert one.actor == two.actor == "box"


def test_geometry_stands_in_for_a_segmentation(view):
    catalogue, state, _, frame = view
    bare = dataclasses.replace(frame, ids=np.zeros_like(frame.ids))
    drawn, seen = (sighting(SCENE, state, one, catalogue, Camera()) for one in (bare, frame))
    assert drawn.height_px == pytest.approx(seen.height_px, abs=2.0)
    assert (drawn.contrast, drawn.distance_m) == (None, seen.distance_m)


@given(st.integers(1, 40), st.integers(1, 40), st.integers(0, 255), st.integers(0, 255))
def test_contrast_is_the_difference_from_the_surroundings(view, height, width, inside, around):
    catalogue, state, _, _ = view
    ids = np.zeros((120, 160), np.int32)
    ids[30 : 30 + height, 50 : 50 + width] = 2
    grey = np.where(ids == 2, inside, around).astype(np.uint8)
    frame = Frame(np.repeat(grey[..., None], 3, axis=2), np.ones((120, 160), np.float32), ids)
    found = sighting(DARK, state, frame, catalogue, SMALL)
    assert found.height_px == 4.0 * height
    assert found.contrast == pytest.approx(abs(inside - around) / 255, abs=1e-4)
    assert found.brightness == pytest.approx(inside / 255, abs=1e-4)
    assert found.area_px == 16.0 * height * width
    signal = found.contrast * found.area_px**0.5
    assert ("faint" in found.faults) == (found.contrast < 0.04 or signal < 1.2)


@given(st.integers(1, 38))
def test_what_is_hidden_takes_from_the_size(view, hidden):
    catalogue, state, _, _ = view
    ids = np.zeros((120, 160), np.int32)
    ids[30:70, 50:54] = 2
    # A post before it hides rows of its middle, and leaves its outline.
    ids[31 : 31 + hidden, 50:54] = 0
    rgb = np.zeros((120, 160, 3), np.uint8)
    unhidden = np.array([0, 160], np.int32)
    frame = Frame(rgb, np.ones((120, 160), np.float32), ids, unhidden)
    found = sighting(SCENE, state, frame, catalogue, SMALL)
    assert found.height_px == 160.0
    assert found.hidden == pytest.approx(hidden / 40, abs=1e-3)
    left = 40 - hidden
    assert found.size_px == pytest.approx(apparent_size(4.0 * left, 64.0 * left), abs=0.1)


def test_weather_that_is_the_hazard_may_fade_what_is_in_it(view):
    catalogue, state, frame, _ = view
    foggy = DARK.model_copy(
        update={"hazard": Hazard(actors={"box": None}, weather=Weather(cloud_cover=0.9))}
    )
    found = sighting(foggy, state, frame, catalogue, SMALL)
    assert (found.contrast, found.brightness) == (None, None)


def test_twins_and_weather_alone_have_nothing_to_measure(view):
    catalogue, state, frame, _ = view
    assert sighting(SCENE.twin(1.0), state, frame, catalogue, SMALL) is None
