import importlib.util
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from oodscen_pybullet import PyBulletSimulator
from oodscen_pybullet import _renderers as renderers
from oodscen_pybullet._engine import load_pybullet
from oodscen_pybullet._renderers import choose_renderer, open_stage
from oodscen_pybullet._rendering.bullet_camera import BulletStage
from oodscen_pybullet._rendering.rasteriser import Canvas

from oodscen.data._scene import Actor, Scene
from oodscen.errors import SimulatorError, UnknownComponent
from oodscen.protocols import Camera

MakeActor = Callable[..., Actor]
MakeScene = Callable[..., Scene]


@pytest.fixture
def _no_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(renderers, "has_numba", lambda: False)


def test_the_rasteriser_is_the_default() -> None:
    assert PyBulletSimulator().renderer == "raster"
    assert PyBulletSimulator(renderer="pybullet").renderer == "pybullet"


def test_unknown_renderers_are_refused_with_close_matches() -> None:
    with pytest.raises(UnknownComponent) as caught:
        PyBulletSimulator(renderer="rastre")  # type: ignore[arg-type]  # the mistake under test
    assert caught.value.matches == ("raster",)


@pytest.mark.usefixtures("_no_numba")
def test_without_numba_pybullets_camera_stands_in_with_one_warning() -> None:
    with pytest.warns(RuntimeWarning) as caught:
        simulator = PyBulletSimulator()
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert simulator.renderer == "pybullet"


@pytest.mark.usefixtures("_no_numba")
def test_whoever_asks_for_pybullets_camera_is_not_warned() -> None:
    assert choose_renderer("pybullet") == "pybullet"


def test_each_renderer_has_its_stage() -> None:
    engine = load_pybullet()
    for renderer, kind in (("raster", Canvas), ("pybullet", BulletStage)):
        stage = open_stage(choose_renderer(renderer), engine)  # type: ignore[arg-type]  # literals
        assert isinstance(stage, kind)
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
    weather: dict[str, object], camera: Camera, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    scene = make_scene(
        make_actor("car", 14.0), make_actor("cow", 9.0, name="b", offset=2.0), **weather
    )
    frames = []
    for renderer in ("raster", "pybullet"):
        with PyBulletSimulator(renderer=renderer) as simulator:  # type: ignore[arg-type]  # literals
            simulator.reset(scene, 3)
            frames.append(simulator.render(camera))
    ours, theirs = frames
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
    print(one.renderer, one.render(Camera(64, 48)).rgb.shape)
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.stdout.strip() == "pybullet (48, 64, 3)", ran.stderr


def test_opengl_works_or_says_why_not(
    camera: Camera, make_scene: MakeScene, make_actor: MakeActor
) -> None:
    scene = make_scene(make_actor("car", 14.0))
    with PyBulletSimulator(renderer="opengl") as simulator:
        simulator.reset(scene, 3)
        try:
            frame = simulator.render(camera)
        except SimulatorError as reason:
            pytest.skip(str(reason))
    with PyBulletSimulator() as simulator:
        simulator.reset(scene, 3)
        assert (frame.ids == simulator.render(camera).ids).mean() > 0.99


def test_opengl_that_is_missing_is_an_error_and_not_another_camera(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    renderers.find_opengl.cache_clear()
    with pytest.raises(SimulatorError, match="opengl"):
        open_stage("opengl", load_pybullet())
