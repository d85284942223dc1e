import math
import warnings
from dataclasses import asdict, replace

import numpy as np
import pytest

from oodscen.errors import UsageError
from oodscen.protocols import MAX_SIZE, Camera, Control
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene


@pytest.mark.parametrize(
    "wrong",
    [
        {"width": 0},
        {"height": -5},
        {"width": 3.5},
        {"width": True},
        {"height": MAX_SIZE + 1},
        {"fov_deg": 0.0},
        {"fov_deg": 180.0},
        {"fov_deg": math.nan},
        {"pitch_deg": math.nan},
        {"x": math.inf},
    ],
    ids=str,
)
def test_cameras_that_cannot_be_are_refused_by_name(wrong) -> None:
    with pytest.raises(UsageError, match=next(iter(wrong))):
        Camera(**wrong)


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.int8])
def test_a_camera_holds_numbers_of_python(kind) -> None:
    given = dict.fromkeys(("fov_deg", "x", "y", "z", "pitch_deg", "yaw_deg"), kind(60))
    with warnings.catch_warnings(action="error"):
        camera = Camera(**given)
    assert asdict(camera).items() >= dict.fromkeys(given, 60.0).items()
    assert {type(getattr(camera, name)) for name in given} == {float}


@pytest.mark.parametrize("off_road", [False, True])
def test_the_fingerprint_of_a_state_takes_a_truth_value_of_numpy(off_road) -> None:
    with FlatSimulator() as simulator:
        state = replace(simulator.reset(example_scene(), 0), off_road=off_road)
    assert replace(state, off_road=np.bool_(off_road)).fingerprint() == state.fingerprint()
    assert replace(state, off_road=not off_road).fingerprint() != state.fingerprint()


@pytest.mark.parametrize("name", ["acceleration", "steering"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_control_that_is_no_number_is_refused(name: str, value: float) -> None:
    with FlatSimulator() as simulator:
        simulator.reset(example_scene(), 0)
        with pytest.raises(UsageError, match=name):
            simulator.step(Control(**{name: value}))
