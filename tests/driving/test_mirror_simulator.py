import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from oodscen.data._scene import Trigger
from oodscen.driving import MirrorSimulator
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.boxes import Footprint, gap
from oodscen.errors import SceneError, SimulatorError
from oodscen.protocols import Camera, Control, Frame, Simulator
from oodscen.testing._flat import FlatSimulator
from tests.driving.staging import CATALOGUE, actor, scene

BOX = scene(actor("box", "cardboard_box", ahead=60.0), actor("far", ahead=250.0), speed=12.0)


class Recorder(MirrorSimulator):
    """Shows nothing and remembers what it was asked."""

    name = "recorder"

    def __init__(self) -> None:
        super().__init__()
        self.calls: list[str] = []
        self.asked: list[int] = []

    def catalogue(self):
        return CATALOGUE

    def load(self, corridor, scene, seed) -> None:
        self.calls.append("load")

    def spawn(self, actor_id, asset, state, pose) -> None:
        self.calls.append(f"spawn {actor_id} {asset.id} {state}".strip())

    def place(self, poses, speeds) -> None:
        self.calls.append("place")
        self.poses = poses

    def gaps(self, rows: Sequence[int]) -> list[float]:
        self.asked += rows
        return [0.5 for _ in rows]

    def draw(self, camera: Camera) -> Frame:
        raise NotImplementedError


def test_calls_come_in_the_documented_order() -> None:
    simulator = Recorder()
    assert isinstance(simulator, Simulator)
    simulator.reset(BOX, 0)
    simulator.step(Control())
    assert simulator.calls == [
        "load", "spawn ego ego_car", "spawn box cardboard_box", "spawn far car off",
        "place", "place",
    ]  # fmt: skip


def test_only_near_bodies_that_do_not_touch_are_asked_for() -> None:
    simulator = Recorder()
    state = simulator.reset(BOX, 0)
    assert simulator.asked == []
    assert math.isinf(state.gaps[0])
    assert math.isinf(state.gaps[2])
    rows = state.poses.tolist()
    boxes = [Footprint(x, y, yaw, *size) for (x, y, _, yaw), size in
             zip(rows, simulator.world.sizes, strict=True)]  # fmt: skip
    assert math.isclose(state.gaps[1], gap(boxes[0], boxes[1]), abs_tol=1e-6)
    while state.poses[0, 0] < state.poses[1, 0]:
        state = simulator.step(Control())
        expected = 0.0 if state.contacts else 0.5 if simulator.asked else state.gaps[1]
        assert state.gaps[1] == expected
    assert set(simulator.asked) == {1}
    assert state.contacts == ("box",)


def test_an_adapter_may_work_in_the_arrays_that_it_places() -> None:
    class Scaling(Recorder):
        def place(self, poses, speeds) -> None:
            poses *= -1.0
            speeds *= 3.6

    ours, its = Recorder(), Scaling()
    for simulator in (ours, its):
        simulator.reset(BOX, 0)
    mine, other = ours.step(Control()), its.step(Control())
    assert mine.poses.tobytes() == other.poses.tobytes()
    assert mine.speeds.tobytes() == other.speeds.tobytes()


@pytest.mark.parametrize("measured", [[math.nan], [-math.inf], [-3.0], [], [1.0, 2.0], None, ["x"]])
def test_gaps_that_are_none_are_the_simulator_s_fault(measured) -> None:
    class Lying(Recorder):
        def gaps(self, rows):
            return measured

    near = scene(actor("box", "cardboard_box", ahead=9.0), speed=1.0)
    with pytest.raises(SimulatorError, match=r"recorder: gaps\(\) returned"):
        Lying().reset(near, 0)


def test_states_cannot_be_changed() -> None:
    state = Recorder().reset(BOX, 0)
    for array in (state.poses, state.speeds, state.gaps):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_a_scene_that_cannot_be_staged_is_refused_with_all_reasons() -> None:
    simulator = Recorder()
    with pytest.raises(SceneError) as caught:
        simulator.reset(scene(actor("a", lane=5), actor("b", lane=-4)), 0)
    assert [issue.path for issue in caught.value.issues] == [
        "actors[0].placement.lane",
        "actors[1].placement.lane",
    ]
    assert simulator.calls == []


def test_nothing_works_before_reset_and_after_close() -> None:
    simulator = FlatSimulator()
    for use in (
        lambda: simulator.step(Control()),
        lambda: simulator.render(Camera()),
        simulator.observe,
        simulator.snapshot,
        simulator.state,
    ):
        with pytest.raises(SimulatorError):
            use()
        simulator.reset(BOX, 0)
        simulator.close()
        with pytest.raises(SimulatorError):
            use()


def test_contact_and_leaving_the_road_are_data() -> None:
    with FlatSimulator() as simulator:
        state = simulator.reset(scene(actor("box", "cardboard_box", ahead=20.0)), 0)
        gaps = [state.gaps[1]]
        driver = Cruise()
        for _ in range(80):
            state = simulator.step(driver.act(simulator.observe()))
            gaps.append(state.gaps[1])
            if gaps[-1] == 0.0:
                break
        assert state.contacts == ("box",)
        assert all(a > b for a, b in pairwise(gaps))
        while not state.off_road:
            state = simulator.step(Control(0.0, 0.3))
        assert state.time < 10.0


def test_branching_from_a_snapshot_repeats_exactly() -> None:
    with FlatSimulator() as simulator:
        staged = scene(
            actor("a", "car", "cut_in", lane=1, ahead=12.0, lanes=-1,
                  trigger=Trigger(value=0.4)),
        )  # fmt: skip
        simulator.reset(staged, 0)
        for _ in range(15):
            simulator.step(Control())
        kept = simulator.snapshot()
        here = simulator.state().fingerprint()
        first = [simulator.step(Control(-2.0)).fingerprint() for _ in range(30)]
        assert simulator.restore(kept).fingerprint() == here
        assert [simulator.step(Control(-2.0)).fingerprint() for _ in range(30)] == first
        assert np.isfinite(simulator.state().gaps[1])
