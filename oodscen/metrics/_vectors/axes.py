"""Principal axes of a set of vectors, for maps."""

import numpy as np
from numpy.typing import NDArray

from oodscen.encoders._similarity import Vectors

_NO_SHARE = 1e-12
"""Share of the variance up to which an axis holds none."""


def principal_axes(
    vectors: Vectors,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean [d], two principal axes [2, d] and their shares of variance [2].

    The largest component of each axis is positive, which fixes its sign. Axes beyond the rank are zero.
    """
    wide = np.asarray(vectors, np.float64)
    mean = wide.mean(axis=0)
    centred = wide - mean
    scatter = centred.T @ centred
    values, columns = np.linalg.eigh(scatter)
    total = float(np.trace(scatter)) or 1.0
    axes, shares = np.zeros((2, wide.shape[1])), np.zeros(2)
    for index in range(min(2, len(values), max(len(wide) - 1, 0))):
        value, axis = float(values[-1 - index]), columns[:, -1 - index]
        if value <= _NO_SHARE * total:
            break
        axes[index] = axis * np.sign(axis[np.abs(axis).argmax()])
        shares[index] = value / total
    return mean, axes, shares
