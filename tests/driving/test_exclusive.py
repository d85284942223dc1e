"""A simulator runs one scene at a time."""

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from oodscen import drive, simulate
from oodscen.driving._exclusive import exclusive
from oodscen.errors import UsageError
from oodscen.protocols import Control
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator


class Waits:
    """Stays in its first act until it is released."""

    entered, released = threading.Event(), threading.Event()

    def act(self, observation):
        self.entered.set()
        self.released.wait(60)
        return Control()


@pytest.fixture
def driven():
    """Yield a simulator in which another thread drives."""
    simulator, scene = FlatSimulator(), example_scene()
    Waits.entered.clear()
    Waits.released.clear()
    with ThreadPoolExecutor(1) as pool:
        drives = pool.submit(drive, [scene], Waits, simulator, twins=False)
        assert Waits.entered.wait(60)
        yield simulator
        Waits.released.set()
        assert [one.status for one in drives.result()] == ["ok"]


def test_a_second_thread_is_refused_and_the_first_goes_on(driven, tmp_path):
    scene = example_scene()
    for use in (
        lambda: simulate(scene, driven, render=False),
        lambda: drive([scene], Waits, driven),
        lambda: scene.record(driven, tmp_path / "a.mp4"),
    ):
        with pytest.raises(UsageError, match="another thread"):
            use()
    assert simulate(scene, FlatSimulator(), render=False).episode.status == "ok"


def test_a_thread_may_use_its_simulator_again_and_others_may_afterwards():
    simulator = FlatSimulator()
    with ThreadPoolExecutor(1) as pool:

        def others_use():
            with exclusive(simulator):
                return True

        with exclusive(simulator):
            with exclusive(simulator):
                pass
            with pytest.raises(UsageError):
                pool.submit(others_use).result()
        assert pool.submit(others_use).result()
