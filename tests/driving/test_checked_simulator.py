"""A simulator's states and observations are checked wherever scenes are run, and scenes stay as they are."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from oodscen._abilities import Rehearses, Snapshots
from oodscen.data._pairing import twin_id
from oodscen.data._scene import Trigger
from oodscen.driving._checked_simulator import checked_simulator
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.errors import SimulatorError
from oodscen.protocols import Camera, Control
from oodscen.stages._drive import drive
from oodscen.stages._simulate import simulate
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator
from tests.driving.test_states import BAD_STATES, SCENE


class Foreign:
    """Implements the protocol directly; `mends` changes its states."""

    name, dt = "foreign", FlatSimulator.dt

    def __init__(self, mends=lambda state: state, sees=lambda seen: seen):
        self._inner, self._mends, self._sees = FlatSimulator(), mends, sees
        self.catalogue, self.render = self._inner.catalogue, self._inner.render
        self.close = self._inner.close

    def reset(self, scene, seed):
        return self._mends(self._inner.reset(scene, seed))

    def step(self, control):
        return self._mends(self._inner.step(control))

    def observe(self):
        return self._sees(self._inner.observe())

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()


BAD_TIMES = {
    "stands still": lambda one: replace(one, time=0.0),
    "runs back": lambda one: replace(one, time=-one.time),
    "runs twice as fast": lambda one: replace(one, time=2 * one.time),
}


@pytest.mark.parametrize("fault", BAD_TIMES)
def test_a_time_that_does_not_advance_by_a_step_is_refused(fault: str) -> None:
    simulator = checked_simulator(Foreign(BAD_TIMES[fault]))
    simulator.reset(SCENE, 0)
    with pytest.raises(SimulatorError, match=r"foreign: step\(\) returned the time"):
        simulator.step(Control())


def test_abilities_stay_and_own_simulators_are_not_wrapped() -> None:
    class Odd(FlatSimulator):
        def step(self, control):
            return super().step(control)

    assert checked_simulator(flat := FlatSimulator()) is flat
    odd = checked_simulator(Odd())
    assert odd is checked_simulator(odd)
    assert isinstance(odd, Snapshots)
    assert isinstance(odd, Rehearses)
    plain = checked_simulator(Foreign())
    assert not isinstance(plain, Snapshots)
    assert not isinstance(plain, Rehearses)


def test_a_restored_state_is_checked_too() -> None:
    class Odd(FlatSimulator):
        def restore(self, snapshot):
            return replace(super().restore(snapshot), gaps=np.zeros(1) * np.nan)

    odd = checked_simulator(Odd())
    odd.reset(SCENE, 0)
    with pytest.raises(SimulatorError, match=r"restore\(\) returned gaps"):
        odd.restore(odd.snapshot())


def test_checks_change_no_result() -> None:
    ours = simulate(SCENE, FlatSimulator(), render=False).episode
    theirs = simulate(SCENE, Foreign(), render=False).episode
    assert theirs.trace_sha256 == ours.trace_sha256
    assert theirs.is_deterministic


@pytest.mark.parametrize("fault", ["NaN gaps", "other order", "off nothing", "a list"])
def test_a_bad_state_fails_the_episode_and_the_drive_that_met_it(fault: str) -> None:
    with pytest.raises(SimulatorError, match=r"foreign: reset\(\) returned"):
        simulate(SCENE, Foreign(BAD_STATES[fault]), render=False)
    results = drive([SCENE], RuleBasedDriver, Foreign(BAD_STATES[fault]), name="x")
    assert {(result.status, result.error_type) for result in results} == {
        ("failed", "SimulatorError")
    }


def test_a_late_bad_state_fails_one_drive_of_several() -> None:
    """The scene's drive meets it; the other scene's does not."""
    other = SCENE.model_copy(update={"id": "other"})
    met = []

    def mends(state):
        met.append(state)
        return BAD_STATES["NaN poses"](state) if len(met) == 3 else state

    results = drive([SCENE, other], RuleBasedDriver, Foreign(mends), name="x", twins=False)
    assert [result.status for result in results] == ["failed", "ok"]


def test_an_observation_of_nan_is_the_simulator_s_fault() -> None:
    blind = Foreign(sees=lambda seen: replace(seen, offset_m=np.nan))
    (result,) = drive([SCENE], RuleBasedDriver, blind, name="x", twins=False)
    assert (result.status, result.error_type) == ("failed", "SimulatorError")
    assert "observe()" in result.error


def test_a_checked_simulator_can_be_pickled() -> None:
    class_made = checked_simulator(Counted())
    again = pickle.loads(pickle.dumps(class_made))
    assert again.reset(SCENE, 0).fingerprint() == class_made.reset(SCENE, 0).fingerprint()
    assert again.restore(again.snapshot()).time == 0.0


class Counted(FlatSimulator):
    """Counts its steps, so its states are not built by the base classes alone."""

    steps = 0

    def step(self, control):
        self.steps += 1
        return super().step(control)


def test_a_simulator_that_makes_the_scene_unstageable_is_told_so(tmp_path) -> None:
    """The next reset is refused because of the value: it is not the scene that is at fault."""

    class Notes(FlatSimulator):
        def reset(self, scene, seed):
            state = super().reset(scene, seed)
            scene.actors[0].behaviour.parameters["note"] = 1.0
            return state

    early = Trigger(kind="time", value=0.5)
    scene = example_scene().model_copy(update={"decision": early, "horizon_s": 0.5})
    with pytest.raises(SimulatorError, match="flat changed the scene"):
        simulate(scene, Notes(), actions=("stop",), render=False)
    for result in drive([scene], RuleBasedDriver, Notes()):
        assert (result.status, "changed the scene" in result.error) == ("failed", True)


@pytest.mark.parametrize("method", ["reset", "step", "render"])
def test_a_simulator_that_changes_its_scene_is_told_so_and_the_scene_stays(
    tmp_path, monkeypatch, method
) -> None:
    unchanged = getattr(FlatSimulator, method)

    def changing(simulator, *given):
        found = unchanged(simulator, *given)
        object.__setattr__(simulator.world.scene, "scenario_id", "another")
        return found

    monkeypatch.setattr(FlatSimulator, method, changing)
    early, camera = Trigger(kind="time", value=0.5), Camera(64, 48)
    scene = example_scene().model_copy(update={"decision": early, "horizon_s": 0.5})
    before = scene.digest()
    with pytest.raises(SimulatorError, match="flat changed the scene"):
        simulate(scene, FlatSimulator(), actions=(), camera=camera)
    with pytest.raises(SimulatorError, match="flat changed the scene"):
        scene.record(FlatSimulator(), tmp_path / "video.mp4", view="ego", camera=camera)
    results = drive([scene], RuleBasedDriver, FlatSimulator())
    status = "ok" if method == "render" else "failed"  # This driver wants no frames.
    assert [(result.scene_id, result.status) for result in results] == [
        (scene.id, status),
        (twin_id(scene.id), status),
    ]
    assert scene.digest() == before
    assert not (tmp_path / "video.mp4").exists()
