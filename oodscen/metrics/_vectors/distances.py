r"""Distances between two sets of texts, and measures of one set, from embeddings.

    mmd            unbiased squared maximum mean discrepancy with the kernel exp(-|x - y|^2 / 2 s^2), s the median
                   distance within the reference. About 0 for two draws of one source (may be negative), at
                   most 2. Gretton et al., *A kernel two-sample test*, 2012. Sensitive to style; needs some
                   dozens of texts.
    frechet        |m1 - m2|^2 + tr(S1 + S2 - 2 (S1 S2)^1/2). At least 0; 0 for equal sets. Dowson and Landau, 1982;
                   Heusel et al., 2017. Grows as a set shrinks below some thousand texts: compare equal sizes
                   only.
    vendi          exp of the entropy of the eigenvalues of K / n, K the cosines of the set. In [1, n]; the
                   effective number of different texts. Friedman and Dieng, 2023. Raised by off-topic text.
    remote_clique  mean distance 1 - cos over all pairs: 1 + `pairwise` diversity. In [0, 2].

Sets of different size are not comparable by `vendi` and `frechet`.
"""

import numpy as np
from numpy.typing import NDArray

from oodscen.encoders._similarity import Vectors
from oodscen.errors import UsageError
from oodscen.metrics._diversity import mean_pairwise

_STEP = 1024
"""Rows of a block of distances."""
_MEDIAN_ROWS = 1000
"""Rows of the reference, about, whose distances give the width of the kernel."""
_NO_SHARE = 1e-12
"""Share of an eigenvalue up to which it is zero but for rounding."""


def mmd(a: Vectors, b: Vectors) -> float:
    """Return the unbiased squared maximum mean discrepancy of two sets of at least 2 rows; `b` is the reference."""
    _require_rows(2, a, b)
    sample = b[:: max(1, len(b) // _MEDIAN_ROWS)].astype(np.float64)
    median = float(np.median(_squared_distances(sample, sample)[np.triu_indices(len(sample), 1)]))
    scale = median if median > 0.0 else 1.0
    within = [(_kernel_sum(x, x, scale) - len(x)) / (len(x) * (len(x) - 1)) for x in (a, b)]
    return within[0] + within[1] - 2.0 * _kernel_sum(a, b, scale) / (len(a) * len(b))


def frechet(a: Vectors, b: Vectors) -> float:
    """Return the Fréchet distance between normal distributions fitted to two sets of at least 2 rows."""
    _require_rows(2, a, b)
    (mean_a, cov_a), (mean_b, cov_b) = _moments(a), _moments(b)
    values, axes = np.linalg.eigh(cov_a)
    root = axes * np.sqrt(np.maximum(values, 0.0)) @ axes.T
    between = np.linalg.eigvalsh(root @ cov_b @ root)
    trace = np.trace(cov_a) + np.trace(cov_b) - 2.0 * np.sqrt(np.maximum(between, 0.0)).sum()
    return max(float(np.square(mean_a - mean_b).sum() + trace), 0.0)


def vendi(vectors: Vectors) -> float:
    """Return the Vendi score of a set; a zero vector counts as unlike all others."""
    _require_rows(1, vectors)
    wide = vectors.astype(np.float64)
    n, dimension = wide.shape
    zero_rows = int((np.square(wide).sum(axis=1) == 0.0).sum())
    # K and the d x d matrix share their non-zero eigenvalues: the smaller one is enough.
    gram = wide.T @ wide if n > dimension else wide @ wide.T
    values = np.concatenate([np.linalg.eigvalsh(gram), np.ones(zero_rows)]) / n
    positive = values[values > _NO_SHARE]
    return float(np.exp(-(positive * np.log(positive)).sum()))


def remote_clique(vectors: Vectors) -> float:
    """Return the mean distance 1 - cos over all pairs of a set of at least 2 rows."""
    _require_rows(2, vectors)
    return 1.0 - mean_pairwise(vectors)


def _require_rows(least: int, *sets: Vectors) -> None:
    for vectors in sets:
        if len(vectors) < least:
            raise UsageError(f"needs at least {least} texts in a set, and one has {len(vectors)}")


def _moments(vectors: Vectors) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    wide = vectors.astype(np.float64)
    mean = wide.mean(axis=0)
    centred = wide - mean
    return mean, np.atleast_2d(centred.T @ centred / (len(wide) - 1))


def _squared_distances(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    lengths = np.square(a).sum(axis=1)[:, None] + np.square(b).sum(axis=1)
    return np.asarray(np.maximum(lengths - 2.0 * (a @ b.T), 0.0), np.float64)


def _kernel_sum(a: Vectors, b: Vectors, scale: float) -> float:
    wide, total = b.astype(np.float64), 0.0
    for first in range(0, len(a), _STEP):
        block = a[first : first + _STEP].astype(np.float64)
        total += float(np.exp(_squared_distances(block, wide) / (-2.0 * scale)).sum())
    return total
