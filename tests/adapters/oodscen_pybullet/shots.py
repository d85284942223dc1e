"""Raw pictures of plain surfaces."""

import numpy as np
from oodscen_pybullet._rendering.stage import Shot
from oodscen_pybullet._rendering.view import CameraView


def plain_shot(
    view: CameraView, depth: float, *, kinds: int | np.ndarray = 0, colour: int = 0
) -> Shot:
    """Return a raw picture of a surface at one depth, m; infinity is the sky."""
    shape = (view.height, view.width)
    far = np.full(shape, depth, np.float32)
    return Shot(
        rgb=np.full((*shape, 3), colour, np.uint8),
        depth=far,
        rows=np.full(shape, -1, np.int32),
        reach=far,
        sky=np.where(np.isinf(far), 255, 0).astype(np.uint8),
        lit=np.zeros(shape, np.uint8),
        kinds=np.full(shape, kinds, np.uint8),
    )
