"""States and observations from outside are copied if they are what they promise, and refused by name otherwise."""

import pickle
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from oodscen._abilities import Rehearses, Snapshots
from oodscen.data._pairing import twin_id
from oodscen.data._scene import Trigger
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.driving._states import check_observation, own_state, watched
from oodscen.errors import SimulatorError
from oodscen.protocols import Camera, Control
from oodscen.stages._drive import drive
from oodscen.stages._simulate import simulate
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator

SCENE = example_scene()
IDS = ("ego", *(actor.id for actor in SCENE.actors))


@pytest.fixture(scope="module")
def good():
    with FlatSimulator() as simulator:
        return simulator.reset(SCENE, 0)


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


def test_a_good_state_is_copied(good) -> None:
    mine = own_state(good, IDS, "engine: step()")
    assert mine.fingerprint() == good.fingerprint()
    assert (mine.step, mine.time, mine.ids) == (good.step, good.time, good.ids)
    for name in ("poses", "speeds", "gaps", "accelerations", "places"):
        assert not np.shares_memory(getattr(mine, name), getattr(good, name))


BAD_STATES = {
    "nothing": lambda one: None,
    "NaN gaps": lambda one: replace(one, gaps=one.gaps * np.nan),
    "NaN poses": lambda one: replace(one, poses=one.poses * np.nan),
    "infinite speeds": lambda one: replace(one, speeds=one.speeds + np.inf),
    "infinite places": lambda one: replace(one, places=one.places + np.inf),
    "a list": lambda one: replace(one, poses=one.poses.tolist()),
    "words": lambda one: replace(one, poses=one.poses.astype(str)),
    "too few": lambda one: replace(one, gaps=one.gaps[:0]),
    "flat": lambda one: replace(one, poses=one.poses.ravel()),
    "other order": lambda one: replace(one, ids=one.ids[::-1]),
    "a ghost": lambda one: replace(one, ids=(*one.ids, "ghost")),
    "off nothing": lambda one: replace(one, off_road=None),
    "off a word": lambda one: replace(one, off_road="no"),
    "a time in words": lambda one: replace(one, time="1"),
    "no time": lambda one: replace(one, time=float("nan")),
    "a step of a half": lambda one: replace(one, step=0.5),
}


@pytest.mark.parametrize("fault", BAD_STATES)
def test_another_state_is_refused_by_the_method_s_name(good, fault: str) -> None:
    with pytest.raises(SimulatorError, match=r"^engine: step\(\) returned "):
        own_state(BAD_STATES[fault](good), IDS, "engine: step()")


BAD_TIMES = {
    "stands still": lambda one: replace(one, time=0.0),
    "runs back": lambda one: replace(one, time=-one.time),
    "runs twice as fast": lambda one: replace(one, time=2 * one.time),
}


@pytest.mark.parametrize("fault", BAD_TIMES)
def test_a_time_that_does_not_advance_by_a_step_is_refused(fault: str) -> None:
    simulator = watched(Foreign(BAD_TIMES[fault]))
    simulator.reset(SCENE, 0)
    with pytest.raises(SimulatorError, match=r"foreign: step\(\) returned the time"):
        simulator.step(Control())


@pytest.mark.parametrize("value", [np.nan, None, "3", 1j])
def test_an_observation_without_numbers_is_refused(value) -> None:
    with FlatSimulator() as simulator:
        simulator.reset(SCENE, 0)
        seen = simulator.observe()
    check_observation(replace(seen, speed=np.float32(3.0), friction=Fraction(1, 2)), "engine")
    for name in ("speed", "friction", "curve_speed"):
        with pytest.raises(SimulatorError, match=rf"^engine returned {name}: "):
            check_observation(replace(seen, **{name: value}), "engine")


def test_abilities_stay_and_own_simulators_are_not_wrapped() -> None:
    class Odd(FlatSimulator):
        def step(self, control):
            return super().step(control)

    assert watched(flat := FlatSimulator()) is flat
    odd = watched(Odd())
    assert odd is watched(odd)
    assert isinstance(odd, Snapshots)
    assert isinstance(odd, Rehearses)
    plain = watched(Foreign())
    assert not isinstance(plain, Snapshots)
    assert not isinstance(plain, Rehearses)


def test_a_restored_state_is_checked_too() -> None:
    class Odd(FlatSimulator):
        def restore(self, snapshot):
            return replace(super().restore(snapshot), gaps=np.zeros(1) * np.nan)

    odd = watched(Odd())
    odd.reset(SCENE, 0)
    with pytest.raises(SimulatorError, match=r"restore\(\) returned gaps"):
        odd.restore(odd.snapshot())


def test_watching_changes_no_result() -> None:
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


def test_a_watched_simulator_can_be_pickled() -> None:
    class_made = watched(Counted())
    again = pickle.loads(pickle.dumps(class_made))
    assert again.reset(SCENE, 0).fingerprint() == class_made.reset(SCENE, 0).fingerprint()
    assert again.restore(again.snapshot()).time == 0.0


class Counted(FlatSimulator):
    """Counts its steps, so its states are not built by the base classes alone."""

    steps = 0

    def step(self, control):
        self.steps += 1
        return super().step(control)


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
    early = Trigger(kind="time", value=0.5)
    scene = example_scene().model_copy(update={"decision": early, "horizon_s": 0.5})
    before = scene.digest()
    with pytest.raises(SimulatorError, match="flat changed the scene"):
        simulate(scene, FlatSimulator(), actions=(), camera=Camera(64, 48))
    with pytest.raises(SimulatorError, match="flat changed the scene"):
        scene.record(FlatSimulator(), tmp_path / "video.mp4", view="ego", camera=Camera(64, 48))
    results = drive([scene], RuleBasedDriver, FlatSimulator())
    status = "ok" if method == "render" else "failed"  # This driver wants no frames.
    assert [(result.scene_id, result.status) for result in results] == [
        (scene.id, status),
        (twin_id(scene.id), status),
    ]
    assert scene.digest() == before
    assert not (tmp_path / "video.mp4").exists()
