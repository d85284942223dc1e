"""A frame from outside is copied if it is what `Frame` promises, and refused by name otherwise."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays, scalar_dtypes

from oodscen.driving._base_simulator import render_checked
from oodscen.driving._frames import own_frame
from oodscen.errors import SimulatorError, UsageError
from oodscen.protocols import Camera, Frame
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator

CAMERA = Camera(width=4, height=3)
GOOD = Frame(
    rgb=np.arange(36, dtype=np.uint8).reshape(3, 4, 3),
    depth=np.full((3, 4), np.inf, dtype=np.float32),
    ids=np.arange(12, dtype=np.int32).reshape(3, 4) % 3,
    unhidden=np.array([4, 5], dtype=np.int32),
    tags=np.arange(12, dtype=np.uint8).reshape(3, 4),
)


def test_a_good_frame_is_copied() -> None:
    mine = own_frame(GOOD, CAMERA, 2, "engine: draw()")
    for name, value in vars(GOOD).items():
        copy = getattr(mine, name)
        assert copy.dtype == value.dtype
        assert copy.tobytes() == value.tobytes()
        assert not np.shares_memory(copy, value)


def test_wider_types_of_the_same_kind_are_converted() -> None:
    wide = replace(GOOD, depth=GOOD.depth.astype(np.float64), ids=GOOD.ids.astype(np.int64))
    mine = own_frame(wide, CAMERA, 2, "engine: draw()")
    assert (mine.depth.dtype, mine.ids.dtype) == (np.float32, np.int32)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("rgb", GOOD.rgb / 255.0),
        ("rgb", GOOD.rgb[:2]),
        ("rgb", GOOD.rgb.tolist()),
        ("depth", np.full((3, 4), np.nan, dtype=np.float32)),
        ("depth", np.zeros((3, 4), dtype=np.float32)),
        ("depth", None),
        ("ids", GOOD.ids + 1),
        ("ids", GOOD.ids - 1),
        ("ids", GOOD.ids.astype(np.float32)),
        ("ids", GOOD.ids.astype(np.uint64) + 2**32),
        ("ids", GOOD.ids.astype("timedelta64[s]")),
        ("unhidden", np.array([1, 2, 3])),
        ("tags", np.zeros((3, 4))),
    ],
)
def test_another_frame_is_refused_by_the_method_s_name(name: str, value) -> None:
    with pytest.raises(SimulatorError, match=rf"^engine: draw\(\) returned {name}\b"):
        own_frame(replace(GOOD, **{name: value}), CAMERA, 2, "engine: draw()")


@pytest.mark.parametrize("value", [None, GOOD.rgb, {}])
def test_what_is_no_frame_is_refused(value) -> None:
    with pytest.raises(SimulatorError, match="not a Frame"):
        own_frame(value, CAMERA, 2, "engine: draw()")


@given(st.sampled_from(("rgb", "depth", "ids")), st.data())
def test_any_array_is_taken_or_refused(name: str, data) -> None:
    kinds = scalar_dtypes()
    value = data.draw(st.one_of(arrays(kinds, (3, 4)), arrays(kinds, array_shapes(max_side=4))))
    try:
        mine = own_frame(replace(GOOD, **{name: value}), CAMERA, 2, "x: draw()")
    except SimulatorError:
        return
    assert {one.shape[:2] for one in (mine.rgb, mine.depth, mine.ids)} == {(3, 4)}


def test_a_view_that_no_camera_takes_is_refused() -> None:
    with FlatSimulator() as simulator:
        simulator.reset(example_scene(), 0)
        with pytest.raises(UsageError, match="camera must be a Camera, not None"):
            simulator.render(None)


class Lies(FlatSimulator):
    def draw(self, camera):
        return replace(super().draw(camera), rgb=np.zeros((2, 2)))


class Overrides(FlatSimulator):
    def render(self, camera):
        return replace(super().render(camera), rgb=np.zeros((2, 2)))


@pytest.mark.parametrize(("make", "method"), [(Lies, "draw"), (Overrides, "render")])
def test_every_simulator_is_checked(make, method: str) -> None:
    with make() as simulator:
        state = simulator.reset(example_scene(), 0)
        with pytest.raises(SimulatorError, match=rf"flat: {method}\(\) returned rgb"):
            render_checked(simulator, Camera(width=8, height=6), len(state.ids))
