import math

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


@pytest.mark.parametrize("name", ["acceleration", "steering"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_control_that_is_no_number_is_refused(name: str, value: float) -> None:
    with FlatSimulator() as simulator:
        simulator.reset(example_scene(), 0)
        with pytest.raises(UsageError, match=name):
            simulator.step(Control(**{name: value}))
