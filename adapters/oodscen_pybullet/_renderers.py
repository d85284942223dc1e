"""The choice of the camera that takes the pictures."""

import importlib.util
import subprocess
import sys
import warnings
from functools import cache
from types import ModuleType
from typing import Literal, get_args

from oodscen.errors import SimulatorError, UnknownComponent
from oodscen.numerics._kernels import is_compiled
from oodscen_pybullet._rendering.bullet_camera import BulletStage, Stage

Renderer = Literal["raster", "pybullet", "opengl"]

_TRIAL = """
import sys
import pybullet as p
client = p.connect(p.DIRECT)
if p.loadPlugin(sys.argv[1], "_eglRendererPlugin", physicsClientId=client) < 0:
    sys.exit("the plugin refuses")
p.getCameraImage(8, 8, renderer=p.ER_BULLET_HARDWARE_OPENGL, physicsClientId=client)
print("works", file=sys.stderr)
"""
"""Loads the plugin in a separate process, because it ends the process if OpenGL is missing."""


def has_numba() -> bool:
    """Return whether numba is installed, without importing it; it may still be broken."""
    return importlib.util.find_spec("numba") is not None


def choose_renderer(wanted: Renderer, *, is_tried: bool = False) -> Renderer:
    """Return the renderer to use: the requested one, or PyBullet's camera with a warning.

    Args:
        wanted: The requested renderer.
        is_tried: Whether to import numba to check that it works.

    Raises:
        UnknownComponent: If there is no such renderer.
    """
    if wanted not in get_args(Renderer):
        raise UnknownComponent("renderer", wanted, get_args(Renderer))
    if wanted == "raster" and not (is_compiled() if is_tried else has_numba()):
        warnings.warn(
            "numba is missing or broken: pictures come from PyBullet's own camera, which is slow "
            "(pip install 'oodscen[pybullet]')",
            RuntimeWarning,
            stacklevel=3,
        )
        return "pybullet"
    return wanted


def open_stage(renderer: Renderer, engine: ModuleType) -> Stage:
    """Return an empty stage for a renderer.

    Raises:
        SimulatorError: If OpenGL was requested but is not available.
    """
    if renderer == "raster":
        from oodscen_pybullet._rendering.rasteriser import Canvas

        return Canvas()
    if renderer == "opengl":
        return BulletStage(engine, plugin=find_opengl())
    return BulletStage(engine, casts_shadows=not is_compiled())


@cache
def find_opengl() -> str:
    """Return the file of PyBullet's OpenGL camera after testing it in a separate process.

    Raises:
        SimulatorError: If it is missing, or there is no OpenGL.
    """
    spec = importlib.util.find_spec("eglRenderer")
    if spec is None or spec.origin is None:
        raise SimulatorError("renderer 'opengl': PyBullet was built without its EGL plugin")
    try:
        ran = subprocess.run(
            [sys.executable, "-c", _TRIAL, spec.origin],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise SimulatorError("renderer 'opengl': the EGL plugin does not answer") from None
    if "works" not in ran.stderr:
        lines = [*ran.stdout.splitlines(), *ran.stderr.splitlines()]
        reason = lines[-1] if lines else f"exit status {ran.returncode}"
        raise SimulatorError(f"renderer 'opengl': the EGL plugin does not work here: {reason}")
    return spec.origin
