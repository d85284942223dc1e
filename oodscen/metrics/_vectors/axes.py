"""Principal axes of a set of vectors, for maps."""

import numpy as np
from numpy.typing import NDArray

from oodscen.encoders._similarity import Vectors


def principal_axes(
    vectors: Vectors, count: int = 2
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean [d], the principal axes [count, d] and the shares of variance [count].

    The largest component of each axis is positive, which fixes its sign. Axes beyond the rank are zero.
    """
    wide = np.asarray(vectors, np.float64)
    mean = wide.mean(axis=0)
    apart = wide - mean
    scatter = apart.T @ apart
    values, columns = np.linalg.eigh(scatter)
    total = float(np.trace(scatter)) or 1.0
    found, share = np.zeros((count, wide.shape[1])), np.zeros(count)
    for place in range(min(count, len(values), max(len(wide) - 1, 0))):
        value, axis = float(values[-1 - place]), columns[:, -1 - place]
        if value <= 1e-12 * total:
            break
        found[place] = axis * np.sign(axis[np.abs(axis).argmax()])
        share[place] = value / total
    return mean, found, share
