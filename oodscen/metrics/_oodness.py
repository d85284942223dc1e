r"""OOD-ness: how far texts lie from a baseline of ordinary driving.

Source: the paper's section Metrics, equation 1. It prints `min_i cos(e_b,i, e_o,j)` and says
that a higher value means more out of distribution. The literal formula does not behave so: it is
the cosine to the *least* similar baseline text, it grows when a text moves towards the baseline as a
whole, and it can hardly be -0.953 for a batch of the baseline itself, as the paper tabulates. The
formula that fits the table in sign and order is `-max_i cos`: the minimum was taken of the *negated*
cosine and the minus sign was lost. Hence two definitions:

    tabulated   -max_i cos(e_b,i, e_o,j)    in [-1, 1]; -1 for a text of the baseline; higher is more OOD
    printed      min_i cos(e_b,i, e_o,j)    in [-1, 1]; equation 1 to the letter, gives no useful ranking

A set's OOD-ness is the mean over its texts.

Pitfalls: style (an ordinary situation worded unlike the baseline scores as OOD), a small or
narrow baseline (everything is far from it; `tabulated` falls as the baseline grows), text that is not
about driving at all (scores highest), and length (long texts blend several situations).
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, Self, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from oodscen.data._base import Data
from oodscen.data._issues import same_length
from oodscen.encoders._similarity import Nearest, Rows, Vectors, nearest, smallest
from oodscen.errors import UnknownComponent
from oodscen.statistics._intervals import Interval
from oodscen.statistics._resampling import bootstrap_mean

if TYPE_CHECKING:
    from oodscen.metrics._vectors.space import BaselineSpace

Definition = Literal["tabulated", "printed"]
"""The paper's two definitions of OOD-ness."""
Measure = Literal["tabulated", "printed", "kth", "mahalanobis", "density", "whitened", "events"]
"""A definition of OOD-ness, or a detector of `oodscen.metrics._detection.detectors`."""


class NearestText(Data):
    """The baseline text nearest to a text."""

    index: int
    """Index in the baseline."""
    text: str
    cosine: float


class Oodness(Data):
    """The OOD-ness of a set of texts; `oodscen.metrics._oodness` explains formula and pitfalls."""

    mean: float
    """Mean over the texts; higher is more OOD. In [-1, 1] for both definitions."""
    per_text: tuple[float, ...]
    """One score per text, in order."""
    nearest: tuple[NearestText, ...]
    """One per text, in order: the nearest baseline text, for every definition; its text is empty if unknown."""
    interval: Interval | None
    """Interval of the mean; `None` for fewer than five texts or clusters."""
    n: int = Field(ge=1)
    """Number of texts."""
    N: int = Field(ge=1)
    """Number of baseline texts."""
    definition: Measure
    encoder: str
    """The encoder's name, with the hash of its weights."""
    seed: int = 0
    """Seed of the bootstrap."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        same_length(n=self.n, per_text=len(self.per_text), nearest=len(self.nearest))
        return self


def scores(vectors: Vectors, baseline: Rows, definition: Definition) -> NDArray[np.float64]:
    """Return the OOD-ness of [n, d] texts against [N, d] of the baseline: [n], in [-1, 1].

    Raises:
        UnknownComponent: If there is no such definition.
    """
    if definition not in get_args(Definition):
        raise UnknownComponent("definition", str(definition), get_args(Definition))
    if definition == "printed":
        return smallest(vectors, baseline)
    return 0.0 - nearest(vectors, baseline).cosine


def oodness(
    space: "BaselineSpace",
    texts: Sequence[str],
    clusters: Sequence[str] | None,
    definition: Measure,
) -> Oodness:
    """Return the OOD-ness of a set of texts by a definition or a detector; see `Metrics.oodness`."""
    neighbours = space.nearest(space.vectors(texts))
    if definition == "tabulated":
        values = 0.0 - neighbours.cosine
    else:
        values = space.scores(texts, definition)
    return Oodness(
        mean=float(values.mean()),
        per_text=tuple(values.tolist()),
        nearest=_nearest_texts(neighbours, space.baseline.texts),
        interval=bootstrap_mean(values, clusters, seed=space.seed),
        n=len(texts),
        N=len(space.baseline),
        definition=definition,
        encoder=space.encoder.name,
        seed=space.seed,
    )


def _nearest_texts(neighbours: Nearest, baseline: Sequence[str]) -> tuple[NearestText, ...]:
    pairs = zip(neighbours.index.tolist(), neighbours.cosine.tolist(), strict=True)
    return tuple(
        NearestText(index=index, text=baseline[index] if baseline else "", cosine=cosine)
        for index, cosine in pairs
    )
