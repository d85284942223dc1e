import importlib.util

import pytest

from oodscen import make_simulator
from oodscen.errors import MissingExtra, SimulatorCrash
from oodscen.interchange._traces.rerun_files import _film, write_rerun
from tests.interchange.staging import SCENES

SCENE = SCENES[0]


@pytest.mark.skipif(bool(importlib.util.find_spec("rerun")), reason="Rerun is installed")
def test_without_the_package_the_extra_is_named(tmp_path):
    with pytest.raises(MissingExtra) as caught:
        write_rerun(SCENE, make_simulator("flat"), tmp_path / "run.rrd")
    assert caught.value.extra == "rerun"


def test_a_recording_has_every_part(tmp_path):
    pytest.importorskip("rerun")
    from rerun.chunk import RrdReader

    path, scene = tmp_path / "run.rrd", SCENE.model_copy(update={"horizon_s": 1.0})
    with make_simulator("pybullet") as simulator:
        write_rerun(scene, simulator, path, action="stop", every_s=60.0)
    found = {str(part.entity_path) for part in RrdReader(path).stream()}
    assert {f"/world/{actor.id}" for actor in SCENE.actors} | {
        "/world/ego",
        "/world/lanes",
    } <= found
    assert {"/world/ego/camera/picture", "/world/ego/camera/depth", "/plan/bodies"} <= found
    assert {"/actions/stop/speed", "/actions/keep_speed/distance"} <= found


class FullDisk:
    """The log of a recording whose pictures do not fit on the disk."""

    def camera(self, camera):
        pass

    def picture(self, time, frame):
        raise OSError("no space left")


def test_only_what_the_simulator_raises_is_its_failure(monkeypatch):
    with make_simulator("flat") as simulator:
        states = [simulator.reset(SCENE, 0)]
        with pytest.raises(OSError, match="no space left"):
            _film(FullDisk(), simulator, 0.5, iter(states))
        monkeypatch.setattr(simulator, "render", lambda camera: 1 / 0)
        with pytest.raises(SimulatorCrash, match="ZeroDivisionError"):
            _film(FullDisk(), simulator, 0.5, iter(states))
