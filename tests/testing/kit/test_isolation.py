"""A fresh process repeats each scene by itself."""

import pytest

from oodscen.testing._flat import FlatSimulator
from oodscen.testing._kit.isolation import process_faults
from tests.driving.staging import actor, scene


@pytest.mark.parametrize("distances_m", [(), (20.0, 40.0, 20.0)])
def test_scenes_of_one_id_are_repeated_each_by_itself(distances_m) -> None:
    scenes = [scene(actor("a", ahead=ahead)) for ahead in distances_m]
    assert len({one.id for one in scenes}) <= 1
    with FlatSimulator() as simulator:
        assert process_faults(simulator, "flat", scenes) == []
