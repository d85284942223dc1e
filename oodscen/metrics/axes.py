"""Principal axes of a set of vectors, for maps."""

import numpy as np
from numpy.typing import NDArray

from oodscen.metrics.similarity import Vectors


def principal_axes(
    vectors: Vectors, count: int = 2
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean [d], the principal axes [count, d] and the shares of variance [count].

    The sign of an axis is such that its largest component is positive; axes beyond the rank are zero.
    """
    wide = np.asarray(vectors, np.float64)
    mean = wide.mean(axis=0)
    _, lengths, axes = np.linalg.svd(wide - mean, full_matrices=False)
    total = float(np.square(lengths).sum()) or 1.0
    found, share = np.zeros((count, wide.shape[1])), np.zeros(count)
    for place in range(min(count, len(axes))):
        axis = axes[place]
        found[place] = axis * np.sign(axis[np.abs(axis).argmax()])
        share[place] = lengths[place] ** 2 / total
    return mean, found, share
