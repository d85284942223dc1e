"""Driving stacks over scenes and twins: outcomes are data, whatever a driver does."""

import math

import pytest

from oodscen import make_simulator
from oodscen._abilities import MountsCamera
from oodscen.data._drive_result import DriveResult
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.driving._motion.actions import Cruise
from oodscen.errors import SimulatorError, UsageError
from oodscen.protocols import Camera, Control
from oodscen.stages._drive import drive
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene


@pytest.fixture(scope="module")
def simulator():
    with make_simulator("flat") as made:
        yield made


class Broken:
    def act(self, observation):
        raise RuntimeError("no idea")


class Wild:
    def act(self, observation):
        return Control(math.nan, 0.0)


def test_a_blind_driver_hits_and_the_rule_based_one_does_not(simulator):
    blind = drive([example_scene()], Cruise, simulator, name="blind")
    ruled = drive([example_scene()], RuleBasedDriver, simulator)
    assert [one.scene_id for one in ruled] == ["example-001", "example-001~twin"]
    assert blind[0].collisions
    assert not blind[0].passed
    assert blind[1].passed
    assert ruled[0].passed
    assert ruled[0].twin_passed
    assert ruled[0].progress_lost > 0
    assert ruled[1].brakes_needlessly is False
    assert ruled[1].progress == pytest.approx(1.0, abs=0.02)
    assert ruled[0].min_headway_s is not None


def test_drives_repeat_byte_for_byte_in_any_order(simulator):
    first = drive([example_scene()], RuleBasedDriver, simulator)
    named = drive([example_scene()], "rule-based", simulator)
    assert [one.driver for one in named] == ["rule-based"] * 2
    assert [one.passed for one in named] == [one.passed for one in first]
    drive([example_scene()], Cruise, simulator)
    assert drive([example_scene()], RuleBasedDriver, simulator) == first


class Mute(Exception):
    def __str__(self):
        raise ValueError("no words")


class Halved(Exception):
    def __str__(self):
        return "half a letter \ud83d, and https://ada:opensesame@lab7/"


class Raising:
    def __init__(self, error):
        self.error = error

    def act(self, observation):
        raise self.error


@pytest.mark.parametrize("error", [Mute, Halved])
def test_an_error_is_recorded_whatever_its_text_holds(simulator, error):
    results = drive([example_scene()], lambda: Raising(error()), simulator, name="raising")
    assert [result.error_type for result in results] == [error.__name__] * 2
    for result in results:
        assert DriveResult.parse(result.to_json()) == result
        assert "opensesame" not in result.error


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (SystemExit(0), "SystemExit: 0"),
        (GeneratorExit(), "GeneratorExit"),
        (Mute(), "Mute"),
        (ZeroDivisionError("division by zero"), "ZeroDivisionError: division by zero"),
        (UsageError("no such lane"), "no such lane"),
    ],
)
def test_an_error_of_a_driver_is_told_with_its_type(simulator, error, said):
    for one in drive([example_scene()], lambda: Raising(error), simulator, name="raising"):
        assert one.error == said


@pytest.mark.parametrize(("driver", "error"), [(Broken, "RuntimeError"), (Wild, "UsageError")])
def test_a_driver_that_fails_is_a_result(simulator, driver, error):
    results = drive([example_scene()], driver, simulator)
    assert [result.error_type for result in results] == [error, error]
    assert all(result.status == "failed" and not result.passed for result in results)


def test_a_factory_that_makes_no_driver_is_told_so(simulator):
    for made in (None, 5, Wild):
        for one in drive([example_scene()], lambda made=made: made, simulator, name="stack"):
            assert one.error_type == "UsageError"
            assert "this driver" in one.error


def test_a_twin_that_cannot_be_run_leaves_the_result_of_its_scene():
    class Picky(FlatSimulator):
        def reset(self, scene, seed):
            if scene.is_twin:
                raise SimulatorError("no twins here")
            return super().reset(scene, seed)

    with Picky() as simulator:
        whole, twin = drive([example_scene()], Cruise, simulator, name="blind")
    assert (whole.id, whole.status, whole.is_twin) == ("example-001@blind", "ok", False)
    assert (twin.id, twin.status, twin.is_twin) == ("example-001~twin@blind", "failed", True)


def test_a_scene_that_cannot_be_run_has_the_result_of_its_twin_as_well(simulator):
    lost = example_scene().model_copy(update={"id": "lost", "map": "nowhere"})
    results = drive([lost, example_scene()], Cruise, simulator, name="blind")
    assert [(one.id, one.status) for one in results] == [
        ("lost@blind", "failed"),
        ("lost~twin@blind", "failed"),
        ("example-001@blind", "ok"),
        ("example-001~twin@blind", "ok"),
    ]
    (alone,) = drive([lost], Cruise, simulator, name="blind", twins=False)
    assert alone == results[0]


@pytest.mark.parametrize("member", ["reset", "step", "observe", "render"])
def test_a_simulator_that_crashes_during_a_drive_is_not_the_driver_s_fault(member):
    class Sees(Cruise):
        wants_frames = True

    class Crashing(FlatSimulator):
        calls = 0

        def __getattribute__(self, name):
            found = super().__getattribute__(name)
            if name != member:
                return found

            def counted(*args):
                Crashing.calls += 1
                if Crashing.calls > last:
                    raise ValueError("no \x1b[31mroad\nhere")
                return found(*args)

            return counted

    for last in (0, 1) if member in ("reset", "render") else (0, 40, 110):
        Crashing.calls = 0
        with Crashing() as simulator:
            (result,) = drive(
                [example_scene()], Sees, simulator, twins=False, camera=Camera(16, 12)
            )
        if Crashing.calls > last:
            assert result.error_type == "SimulatorCrash"
            assert "'flat' crashed" in result.error
            assert result.error.isprintable()
    assert Crashing.calls


def test_a_driver_may_ask_for_frames(simulator):
    seen = []

    class Sees(Cruise):
        wants_frames = True

        def act(self, observation):
            seen.append(observation.frame.rgb.shape)
            return super().act(observation)

    drive([example_scene()], Sees, simulator, twins=False, camera=Camera(width=16, height=12))
    assert set(seen) == {(12, 16, 3)}

    class Mounts(Sees):
        camera = Camera(width=20, height=10)

    seen.clear()
    assert isinstance(Mounts(), MountsCamera)
    drive([example_scene()], Mounts, simulator, twins=False)
    assert set(seen) == {(10, 20, 3)}


def test_a_driver_of_no_length_looks_as_well(simulator):
    seen = []

    class Looks(Cruise):
        def __len__(self):
            return 0

        def look(self, state):
            seen.append(state.step)

    drive([example_scene()], Looks, simulator, twins=False)
    assert seen[:3] == [0, 1, 2]


@pytest.mark.parametrize("scenes", [5, "ab", [5], None, example_scene()])
def test_what_are_no_scenes_is_refused(simulator, scenes):
    with pytest.raises(UsageError, match="scene"):
        drive(scenes, RuleBasedDriver, simulator)


def test_every_drive_has_an_id_of_its_own(simulator):
    scene = example_scene()
    like_its_twin = scene.model_copy(update={"id": f"{scene.id}~twin"})
    for scenes in ([scene, scene], [scene, like_its_twin]):
        with pytest.raises(UsageError, match="id of its own"):
            drive(scenes, RuleBasedDriver, simulator)


@pytest.mark.parametrize("name", [" ", "\ud800", "a\nb", "a\u202eb", 5])
def test_a_driver_has_a_name(simulator, name):
    with pytest.raises(UsageError, match="name"):
        drive([example_scene()], RuleBasedDriver, simulator, name=name)
