"""The rasteriser against PyBullet's own camera, which stands in for it without numba."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from oodscen_pybullet import PyBulletSimulator
from oodscen_pybullet._engine import load_pybullet
from oodscen_pybullet._rendering import cameras
from oodscen_pybullet._rendering.bullet_camera import BulletRenderer
from oodscen_pybullet._rendering.cameras import choose_camera
from oodscen_pybullet._rendering.rasteriser import Rasteriser

from oodscen.data._scene import Actor, Scene
from oodscen.protocols import Camera, Frame

MakeActor = Callable[..., Actor]
MakeScene = Callable[..., Scene]


@pytest.fixture
def _no_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cameras, "is_compiled", lambda: False)


def test_the_rasteriser_is_the_default() -> None:
    stage = choose_camera(load_pybullet())()
    assert isinstance(stage, Rasteriser)
    stage.close()
    stage.close()


@pytest.mark.usefixtures("_no_numba")
def test_without_numba_pybullets_camera_stands_in_with_one_warning() -> None:
    with pytest.warns(RuntimeWarning, match="numba") as caught:
        stages = [choose() for choose in [choose_camera(load_pybullet())] * 2]
    assert len(caught) == 1
    for stage in stages:
        assert isinstance(stage, BulletRenderer)
        stage.close()
        stage.close()


@pytest.mark.parametrize(
    "weather",
    [
        {"cloud_cover": 1.0},
        {"fog_visual_range_m": 60.0},
        {"sun_elevation_deg": -20.0},
        {"precipitation": "rain", "precipitation_mm_h": 20.0},
        {"precipitation": "snow", "precipitation_mm_h": 5.0},
    ],
)
def test_both_cameras_take_much_the_same_pictures(
    weather: dict[str, object], camera: Camera, make_scene: MakeScene, make_actor: MakeActor,
    simulator: PyBulletSimulator, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    scene = make_scene(
        make_actor("car", 14.0), make_actor("cow", 9.0, name="b", offset=2.0), **weather
    )

    def show(one: PyBulletSimulator) -> Frame:
        one.reset(scene, 3)
        return one.render(camera)

    ours = show(simulator)
    monkeypatch.setattr(cameras, "is_compiled", lambda: False)
    with PyBulletSimulator() as other, pytest.warns(RuntimeWarning, match="numba"):
        theirs = show(other)
    assert theirs.unhidden is None
    assert (ours.ids == theirs.ids).mean() > 0.998
    assert np.abs(ours.rgb.astype(int) - theirs.rgb).mean() < (7.0 if ours.rgb.mean() > 60 else 9.0)


def test_the_catalogue_needs_nothing_heavy() -> None:
    code = """
import sys
from oodscen_pybullet import PyBulletSimulator
assert len(PyBulletSimulator().catalogue().assets) > 100
print(*({"numba", "llvmlite", "cv2", "pybullet"} & set(sys.modules)))
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == ""


@pytest.mark.parametrize("how", ["missing", "broken"])
def test_without_a_working_numba_scenes_are_still_shown(how: str, tmp_path: Path) -> None:
    if how == "broken":
        (tmp_path / "numba.py").write_text("raise RuntimeError('needs another NumPy')")
    code = f"""
import sys, warnings
if {how!r} == "missing":
    sys.modules["numba"] = None
else:
    sys.path.insert(0, {str(tmp_path)!r})
warnings.simplefilter("ignore")
from oodscen_pybullet import PyBulletSimulator
from oodscen.protocols import Camera
from oodscen.testing import example_scene
with PyBulletSimulator() as one:
    one.reset(example_scene(), 0)
    frame = one.render(Camera(64, 48))
    print(frame.rgb.shape, frame.unhidden)
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.stdout.strip() == "(48, 64, 3) None", ran.stderr
