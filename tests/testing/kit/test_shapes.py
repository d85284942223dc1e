"""States, frames and places are refused in words, whatever a simulator returns."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.protocols import Camera, Frame, State
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._kit.shapes import frame_faults, share_inside, state_faults
from tests.driving.staging import actor, scene

SCENE = scene(actor("a", ahead=15.0))
CAMERA = Camera(64, 48)


@pytest.fixture(scope="module")
def run() -> tuple[State, Frame, float]:
    with FlatSimulator() as simulator:
        return simulator.reset(SCENE, 0), simulator.render(CAMERA), simulator.dt


def test_a_sound_state_and_frame_have_no_fault(run) -> None:
    state, frame, dt = run
    assert list(state_faults(SCENE, state, 0, dt)) == []
    assert list(frame_faults(frame, CAMERA, 2)) == []


@pytest.mark.parametrize("name", ["poses", "speeds", "gaps", "accelerations", "places"])
@pytest.mark.parametrize(
    "spoil", [np.ndarray.tolist, np.float32, lambda array: array[:1], lambda array: "x"]
)
def test_an_array_of_a_state_that_is_none_is_named(run, name, spoil) -> None:
    state, _, dt = run
    (fault,) = state_faults(SCENE, replace(state, **{name: spoil(getattr(state, name))}), 0, dt)
    assert fault.startswith(f"{name} is ")
    assert ", not float64 (2" in fault


@pytest.mark.parametrize("name", ["rgb", "depth", "ids"])
@pytest.mark.parametrize(
    "spoil", [np.ndarray.tolist, np.float64, lambda array: array[:1], lambda array: None]
)
def test_an_array_of_a_frame_that_is_none_is_named(run, name, spoil) -> None:
    _, frame, _ = run
    (fault,) = frame_faults(replace(frame, **{name: spoil(getattr(frame, name))}), CAMERA, 2)
    assert fault.startswith(f"{name} is ")


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("poses", np.nan, "not finite"),
        ("gaps", -1.0, "a gap is negative"),
        ("gaps", np.nan, "a gap is negative or not a number"),
        ("gaps", 1.0, "the ego's own gap"),
    ],
)
def test_a_figure_out_of_range_is_found(run, name, value, words) -> None:
    state, _, dt = run
    spoilt = replace(state, **{name: np.full_like(getattr(state, name), value)})
    assert any(words in fault for fault in state_faults(SCENE, spoilt, 0, dt))


@pytest.mark.parametrize(
    "unhidden", [[0, 0], np.zeros(2, np.int32), np.zeros(3, np.int32), [10_000]]
)
def test_counts_of_unhidden_pixels_cover_the_visible_ones(run, unhidden) -> None:
    _, frame, _ = run
    (fault,) = frame_faults(replace(frame, unhidden=unhidden), CAMERA, 2)
    assert fault.startswith("unhidden must count")
    enough = np.full(2, 64 * 48, np.int32)
    assert list(frame_faults(replace(frame, unhidden=enough), CAMERA, 2)) == []


SQUARE = [(2.0, 2.0), (6.0, 2.0), (6.0, 6.0), (2.0, 6.0)]


@given(st.integers(0, 9), st.integers(0, 9))
def test_a_pixel_is_inside_if_it_touches_the_bounds(row, column) -> None:
    mask = np.zeros((10, 10), bool)
    mask[row, column] = True
    assert share_inside(mask, SQUARE, 0.0) == (2 <= row < 6 and 2 <= column < 6)


def test_nothing_is_inside_an_empty_outline() -> None:
    assert share_inside(np.ones((4, 4), bool), [], 3.0) == 0.0
    assert share_inside(np.zeros((4, 4), bool), SQUARE, 3.0) == 0.0
