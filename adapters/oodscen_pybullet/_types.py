"""Kinds of points and arrays."""

import numpy as np
from numpy.typing import NDArray

Point = tuple[float, float, float]
Pose = tuple[float, float, float, float]
"""x, y, z, m, and yaw, rad."""
Heading = tuple[float, float]
"""Cosine and sine of a direction on the ground."""

Array = NDArray[np.float64]
F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
Strings = NDArray[np.str_]
