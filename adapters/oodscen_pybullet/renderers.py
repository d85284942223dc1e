"""Which camera takes the pictures."""

import importlib.util
import warnings
from types import ModuleType
from typing import Literal, get_args

from oodscen.errors import UnknownComponent
from oodscen_pybullet.stage import BulletStage, Stage

Renderer = Literal["raster", "pybullet"]


def choose_renderer(wanted: Renderer) -> Renderer:
    """Return the renderer to use: the wanted one, or PyBullet's camera with a warning.

    Raises:
        UnknownComponent: When there is no such renderer.
    """
    if wanted not in get_args(Renderer):
        raise UnknownComponent("renderer", wanted, get_args(Renderer))
    if wanted == "raster" and importlib.util.find_spec("numba") is None:
        warnings.warn(
            "numba is not installed: pictures come from PyBullet's own camera, which is slow "
            "(pip install 'oodscen[pybullet]')",
            RuntimeWarning,
            stacklevel=3,
        )
        return "pybullet"
    return wanted


def open_stage(renderer: Renderer, engine: ModuleType) -> Stage:
    """Return an empty stage for a renderer."""
    if renderer == "raster":
        from oodscen_pybullet.canvas import Canvas

        return Canvas()
    return BulletStage(engine)
