"""Centred embeddings of labels: the part common to all labels is subtracted before they are compared.

Texts about driving share a frame ("a vehicle on the road ...") that brings all of them close to each
other. Without it the cosine of two labels shows whether they mean the same kind of scenario.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen._paper import ATTESTED
from oodscen.encoders._check import check_rows, encode
from oodscen.protocols import Encoder

Vector = NDArray[np.float64]
"""One vector [d], or several as rows [n, d], in double precision."""


def unit_rows(encoder: Encoder, texts: Iterable[str]) -> Vector:
    """Return the embeddings of texts: [n, d] unit rows in double precision; a zero row stays zero.

    Raises:
        EncoderError: If the encoder fails.
    """
    rows = encode(encoder, list(texts)).astype(np.float64)
    lengths = np.sqrt((rows * rows).sum(axis=1, keepdims=True))
    return np.asarray(rows / np.where(lengths > 0.0, lengths, 1.0))


def label_rows(encoder: Encoder, labels: Sequence[str]) -> tuple[Vector, Vector]:
    """Return the embeddings of labels, and their centre.

    The centre is the mean of the labels and of the kinds that the paper names. A few labels of one sort
    then do not pass for what all labels have in common.

    Returns:
        [n, d] unit rows, not centred; and [d], the centre to subtract.

    Raises:
        EncoderError: If the encoder fails, or gives a text another row than when it is alone.
    """
    texts = [*labels, *(kind.name for kind in ATTESTED)]
    rows = unit_rows(encoder, texts)
    check_rows(encoder, texts, rows.astype(np.float32))
    return rows[: len(labels)], rows.mean(axis=0)
