"""Meanings of labels, centred: what all of them share is taken away before they are compared.

Texts about driving share a frame ("a vehicle on the road ...") that makes all of them near to each
other. Without it the cosine of two labels tells whether they mean the same kind of scenario.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen._paper import ATTESTED
from oodscen.protocols import Encoder

Vector = NDArray[np.float64]


def unit_rows(encoder: Encoder, texts: Iterable[str]) -> Vector:
    """Encode texts: [n, d] unit rows in double precision; a zero row stays zero.

    Raises:
        EncoderError: When the encoder fails.
    """
    from oodscen.encoders import encode

    rows = encode(encoder, list(texts)).astype(np.float64)
    lengths = np.sqrt((rows * rows).sum(axis=1, keepdims=True))
    return np.asarray(rows / np.where(lengths > 0.0, lengths, 1.0))


def label_rows(encoder: Encoder, labels: Sequence[str]) -> tuple[Vector, Vector]:
    """Encode labels, and find their centre.

    The centre is the mean of the labels and of the kinds that the paper names, so that few labels of
    one sort are not taken for what all have in common.

    Args:
        encoder: Turns texts into vectors.
        labels: Of one tree, or of all that are compared.

    Returns:
        [n, d] unit rows, not centred; and [d], the centre to subtract.

    Raises:
        EncoderError: When the encoder fails.
    """
    rows = unit_rows(encoder, [*labels, *(item.name for item in ATTESTED)])
    return rows[: len(labels)], rows.mean(axis=0)
