"""A fresh process repeats each scene by itself."""

import pytest

from oodscen.testing._flat import FlatSimulator
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.isolation import process_faults
from tests.driving.staging import actor, scene


@pytest.mark.parametrize("distances_m", [(), (20.0, 40.0, 20.0)])
def test_scenes_of_one_id_are_repeated_each_by_itself(distances_m) -> None:
    scenes = [scene(actor("a", ahead=ahead)) for ahead in distances_m]
    assert len({one.id for one in scenes}) <= 1
    with FlatSimulator() as simulator:
        assert process_faults(simulator, "flat", scenes) == []


class Maker:
    """Makes simulators, and cannot be pickled, like an object that holds a connection."""

    class Nested(FlatSimulator):
        pass

    @classmethod
    def made(cls) -> FlatSimulator:
        return cls.Nested()

    def __call__(self) -> FlatSimulator:
        return FlatSimulator()

    def __reduce__(self) -> str:
        raise RuntimeError("no pickling")


def test_a_factory_that_holds_a_connection_cannot_be_sent() -> None:
    with FlatSimulator() as simulator, pytest.raises(NotApplicable, match="cannot import"):
        process_faults(simulator, Maker(), [])


@pytest.mark.parametrize("source", [Maker.Nested, Maker.made])
def test_what_a_class_of_a_module_holds_is_made_in_a_fresh_process(source) -> None:
    with source() as simulator:
        assert process_faults(simulator, source, [scene()]) == []
