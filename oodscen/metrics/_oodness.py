r"""OOD-ness: how far texts lie from a baseline of ordinary driving.

Source: the paper's section Metrics, equation 1. It prints `min_i cos(e_b,i, e_o,j)` and says
that a higher value means more out of distribution. The literal formula does not behave so: it is
the cosine to the *least* similar baseline text, it grows when a text moves towards the baseline as a
whole, and it can hardly be -0.953 for a batch of the baseline itself, as the paper tabulates. What
fits the table in sign and order is `-max_i cos`: the minimum was taken of the *negated* cosine and
the minus sign was lost. Hence two definitions:

    tabulated   -max_i cos(e_b,i, e_o,j)    in [-1, 1]; -1 for a text of the baseline; higher is more OOD
    printed      min_i cos(e_b,i, e_o,j)    in [-1, 1]; equation 1 to the letter, ranks nothing of use

A set's OOD-ness is the mean over its texts.

What fools it: style (an ordinary situation worded unlike the baseline scores as OOD), a small or
narrow baseline (everything is far from it; `tabulated` falls as the baseline grows), text that is not
about driving at all (scores highest), and length (long texts blend several situations).
"""

from typing import ClassVar, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from oodscen.data._base import Data
from oodscen.errors import UnknownComponent
from oodscen.metrics._vectors.similarity import Rows, Vectors, nearest, smallest
from oodscen.statistics._resampling import Interval

Definition = Literal["tabulated", "printed"]
"""Of the paper's OOD-ness."""
Measure = Literal["tabulated", "printed", "kth", "mahalanobis", "density", "whitened", "events"]
"""A definition of OOD-ness, or a detector of `oodscen.metrics._detection.detectors`."""


class Neighbour(Data):
    """The baseline text that lies nearest to a text."""

    noun: ClassVar[str] = "neighbour"

    index: int
    """Its place in the baseline."""
    text: str
    cosine: float


class Oodness(Data):
    """The OOD-ness of a set of texts. See `oodscen.metrics._oodness` for formula and traps."""

    noun: ClassVar[str] = "OOD-ness"

    mean: float
    """Over the texts; higher is more OOD. In [-1, 1] for both definitions."""
    per_text: tuple[float, ...]
    """One score per text, in order."""
    nearest: tuple[Neighbour, ...]
    """One per text, in order: the nearest baseline text, whatever the definition."""
    interval: Interval | None
    """Of the mean; `None` for fewer than two texts or clusters."""
    n: int = Field(ge=1)
    """Number of texts."""
    N: int = Field(ge=1)
    """Number of baseline texts."""
    definition: Measure
    encoder: str
    """Its name, with the hash of its weights."""
    seed: int = 0
    """Of the bootstrap."""


def scores(vectors: Vectors, baseline: Rows, definition: Definition) -> NDArray[np.float64]:
    """Return the OOD-ness of each text.

    Args:
        vectors: [n, d] of the texts, rows of unit length or zero.
        baseline: [N, d], likewise.
        definition: Which of the two.

    Returns:
        [n], in [-1, 1].

    Raises:
        UnknownComponent: When there is no such definition.
    """
    if definition not in get_args(Definition):
        raise UnknownComponent("definition", str(definition), get_args(Definition))
    if definition == "printed":
        return smallest(vectors, baseline)
    return 0.0 - nearest(vectors, baseline).cosine
