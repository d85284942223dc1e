"""The off-topic guard: flags texts that are not about driving a car on a road.

OOD-ness ranks a recipe above every accident, so off-topic texts must be removed before a set is
scored. The guard is fitted to bundled data: the ordinary driving texts on one side, `elsewhere.txt`
and the *tune* half of `off_topic_texts` on the other. It uses no OOD text. A text is flagged below a
threshold that was set on *tune*, with each subject scored without its own texts, and on the public
OOD sets.

    score    f(e) + near(e, driving) - near(e, elsewhere): f is a linear function of the embedding by
             class-balanced ridge regression, near the mean of the 3 largest cosines. About 1.5 for ordinary
             driving, -1.5 for other texts; flagged below the threshold

Its error rates on unseen texts are in `docs/metrics.md` and come with every result. Pitfalls: texts
about driving in another language are flagged (the default encoder does not read it), texts about
racing games and car trade may pass, and a terse OOD text without a vehicle in it may be flagged.
The threshold holds for all-MiniLM-L6-v2; for another encoder `calibrated` is false, and the flags
are only a hint.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from oodscen._io.files import bundled
from oodscen.baselines._off_topic import off_topic_texts
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.data._base import Data
from oodscen.encoders._similarity import Vectors, largest
from oodscen.metrics._detection.detectors import DECIMALS, Encode

_RIDGE = 0.3
"""Ridge of the weights."""
_NEAREST = 3
"""Texts of each side whose cosines count."""
THRESHOLD = 0.1
"""Score below which a text is flagged."""
_CALIBRATED = "all-MiniLM-L6-v2@"
"""Beginning of the names of encoders that the threshold was set for."""
_CONSTANT_RIDGE = 1e-9
"""Ridge of the constant, which is to be free: enough to keep the system solvable."""


class OffTopicFlags(Data):
    """The texts of a set that are not about driving a car."""

    flagged: tuple[int, ...]
    """Indices of the texts that are not about driving, in order."""
    scores: tuple[float, ...]
    """One per text; lower is further from driving."""
    threshold: float
    share: float
    """Share of flagged texts, in [0, 1]."""
    calibrated: bool
    """True if the threshold was set for this encoder."""


class Guard:
    """A fitted off-topic guard; the module docstring describes it."""

    def __init__(self, encode: Encode, encoder: str) -> None:
        self._encoder = encoder
        self._inside = encode(ordinary_driving().texts)
        self._outside = encode([*elsewhere(), *(text.text for text in off_topic_texts("tune"))])
        self._weights = _fit(self._inside, self._outside)

    def scores(self, vectors: Vectors) -> NDArray[np.float64]:
        """Return [n] scores of [n, d] vectors; low is off-topic."""
        linear = np.asarray(vectors @ self._weights[:-1] + self._weights[-1], np.float64)
        inside, outside = (
            largest(vectors, references, _NEAREST)[0].mean(axis=1)
            for references in (self._inside, self._outside)
        )
        return np.asarray(np.round(linear + (inside - outside), DECIMALS), np.float64)

    def flags(self, vectors: Vectors, threshold: float = THRESHOLD) -> OffTopicFlags:
        """Return the flags of the texts with these vectors, [n, d]."""
        values = self.scores(vectors)
        return OffTopicFlags(
            flagged=tuple(np.flatnonzero(values < threshold).tolist()),
            scores=tuple(values.tolist()),
            threshold=threshold,
            share=float((values < threshold).mean()),
            calibrated=is_calibrated(self._encoder),
        )


def is_calibrated(encoder: str) -> bool:
    """Return whether the threshold was set for the encoder of this name."""
    return encoder.startswith(_CALIBRATED)


@cache
def elsewhere() -> tuple[str, ...]:
    """Return the bundled texts, not about driving, that the guard is fitted to."""
    lines = bundled("elsewhere.txt", "oodscen.metrics._detection").splitlines()
    return tuple(line for line in lines if line and not line.startswith("# "))


def _fit(inside: Vectors, outside: Vectors) -> NDArray[np.float64]:
    """Return ridge weights, the constant last, towards 1 inside and -1 outside, which share the loss equally."""
    size = inside.shape[1] + 1
    left, right = np.eye(size) * _RIDGE, np.zeros(size)
    left[-1, -1] = _CONSTANT_RIDGE
    for vectors, target in ((inside, 1.0), (outside, -1.0)):
        wide = np.hstack([vectors.astype(np.float64), np.ones((len(vectors), 1))])
        left += 0.5 / len(wide) * (wide.T @ wide)
        right += 0.5 / len(wide) * target * wide.sum(axis=0)
    return np.asarray(np.linalg.solve(left, right), np.float64)
