"""A toy stack's repository: its tests run inside pytest, with the plugin."""

import shutil

import pytest

import oodscen.pytest_plugin._fixtures  # noqa: F401  # Sessions in this process share the module.
from oodscen import Scenario, Study, make_simulator, simulate
from oodscen.testing import example_scene

STACK = """
import unittest

import pytest

from oodscen import make_driver


class Blind:
    def __init__(self):
        self.driver = make_driver("keep_speed")

    def act(self, observation):
        return self.driver.act(observation)


class Broken:
    def act(self, observation):
        raise RuntimeError("no map")


class Skips:
    def act(self, observation):
        raise {skip}("no GPU")


class Cautious(Blind):
    def __init__(self):
        self.driver = make_driver("emergency_brake")


class Startled:
    def __init__(self):
        self.keep, self.brake = map(make_driver, ("keep_speed", "emergency_brake"))

    def act(self, observation):
        return (self.brake if observation.time > 2.0 else self.keep).act(observation)


Stack = {stack}
"""
TESTS = """
import stack


def test_safe(scene, drive):
    assert drive(stack.Stack, name="Stack").is_safe


def test_twin(drive, twin):
    driven = drive(stack.Stack, twin, name="Stack")
    assert driven.is_safe
    assert not driven.is_needless
"""


@pytest.fixture(scope="session")
def study(tmp_path_factory):
    """Make a study of two boxes in the lane, and one beside it."""
    folder = tmp_path_factory.mktemp("plugin") / "study"
    folder.mkdir()
    scene = example_scene()
    (box,) = scene.actors
    beside = box.model_copy(
        update={"placement": box.placement.model_copy(update={"offset_m": -3.2, "ahead_m": 50.0})}
    )
    scenes = [
        scene.model_copy(update={"id": "box-001", "scenario_id": "box-001"}),
        scene.model_copy(update={"id": "box-002", "scenario_id": "box-002", "horizon_s": 6.0}),
        scene.model_copy(update={"id": "kerb-001", "scenario_id": "kerb-001", "actors": (beside,)}),
    ]
    labels = {"box": "Box in the lane", "kerb": "Box at the kerb"}
    scenarios = [
        Scenario(
            id=one.id, text=f"A box, {one.id}.", leaf=leaf, path=("Root", "Boxes", labels[leaf])
        )
        for one in scenes
        for leaf in (one.id.partition("-")[0],)
    ]
    with make_simulator("flat") as simulator:
        episodes = [simulate(one, simulator).episode for one in scenes[:1]]
    for name, rows in {"scenes": scenes, "scenarios": scenarios, "episodes": episodes}.items():
        text = "".join(row.to_json() + "\n" for row in rows)
        (folder / f"{name}.jsonl").write_text(text, encoding="utf-8")
    (folder / "study.json").write_text('{"config": {"simulator": "flat"}}')
    return Study.open(folder)


@pytest.fixture
def session(pytester, study, monkeypatch):
    """Return a function that runs the tests of a stack, with the options that it is given."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    pytester.makeini("[pytest]\naddopts = --strict-markers -p oodscen.pytest_plugin._hooks\n")
    pytester.makepyfile(test_stack=TESTS)
    pytester.syspathinsert()

    def run(stack, *options, named=True, skip="unittest.SkipTest"):
        pytester.makepyfile(stack=STACK.format(stack=stack, skip=skip))
        shutil.rmtree(pytester.path / "__pycache__", ignore_errors=True)
        words = [f"--oodscen={study.folder}"] if named else []
        strict = ("-W", "error", "-W", "ignore::pytest.PytestAssertRewriteWarning")
        return pytester.runpytest_inprocess(*strict, *words, *options)

    return run
