"""The choice of the camera that takes the pictures."""

import warnings
from collections.abc import Callable
from functools import partial
from types import ModuleType

from oodscen.numerics._kernels import is_compiled
from oodscen_pybullet._rendering.bullet_camera import BulletRenderer
from oodscen_pybullet._rendering.rasteriser import Rasteriser
from oodscen_pybullet._rendering.stage import Stage


def choose_camera(engine: ModuleType) -> Callable[[], Stage]:
    """Return the opener of a stage: the rasteriser's or, with a warning, PyBullet's own without numba."""
    if is_compiled():
        return Rasteriser
    warnings.warn(
        "numba is missing or broken: pictures come from PyBullet's own camera, which is slow "
        "(pip install 'oodscen[pybullet]')",
        RuntimeWarning,
        stacklevel=2,
    )
    return partial(BulletRenderer, engine, casts_shadows=True)
