"""Checks the contract of `Encoder.encode` at the boundary."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen._members import conforming, working
from oodscen._numbers import whole_number
from oodscen.encoders._similarity import Vectors, unit
from oodscen.errors import EncoderError, UsageError
from oodscen.protocols import Encoder

LEAST_COSINE = 0.9
"""Least cosine of the vectors of one text in two calls; eight-bit models differ a little from batch to batch."""


def encode(encoder: Encoder, texts: Sequence[str]) -> NDArray[np.float32]:
    """Return the embeddings of texts, after checking the encoder's output.

    Returns:
        [n, d] float32, C-contiguous, one row per text, in order.

    Raises:
        UsageError: If `encoder` is not an encoder.
        EncoderError: If it fails or breaks its contract.
    """
    count = len(texts)
    with working("encoder", conforming("encoder", encoder).name):
        vectors = encoder.encode(list(texts))  # The encoder may change the list that it is given.
        return check_embeddings(vectors, count, encoder)


def dimension(encoder: Encoder) -> int:
    """Return the length of an encoder's vectors.

    Raises:
        EncoderError: If it is no whole number above 0, or cannot be told.
    """
    with working("encoder", encoder.name):
        value = encoder.dimension
    try:
        return whole_number(f"the dimension of the encoder {encoder.name!r}", value, 1)
    except UsageError as error:
        raise EncoderError(str(error)) from None


def unit_embeddings(encoder: Encoder, texts: Sequence[str]) -> Vectors:
    """Return the checked embeddings of texts, scaled to unit length; a zero row stays zero."""
    return unit(encode(encoder, texts))


def check_rows(encoder: Encoder, texts: Sequence[str], vectors: NDArray[np.float32]) -> None:
    """Check on the shortest and the longest text that each has the vector that it has alone.

    Args:
        encoder: The encoder that made the vectors.
        texts: The texts of one call.
        vectors: [n, d], checked.

    Raises:
        EncoderError: If a row belongs to another text, or changes from call to call.
    """
    by_length = sorted(range(len(texts)), key=lambda index: len(texts[index]))
    for index in (by_length[0], by_length[-1]):
        pair = unit(np.vstack([vectors[index], encode(encoder, [texts[index]])]))
        if pair.any() and float(pair[0] @ pair[1]) < LEAST_COSINE:
            raise EncoderError(
                f"{encoder.name} gave text {index} of {len(texts)} another vector than when it is alone: "
                "row i must belong to text i, and be the same in every call"
            )


def check_embeddings(vectors: object, n: int, encoder: Encoder) -> NDArray[np.float32]:
    """Return a copy of `vectors` if they are one finite float32 row for each of `n` texts.

    Raises:
        EncoderError: If type, shape, dtype, a value or the dimension violates the protocol.
    """
    if not isinstance(vectors, np.ndarray):
        raise EncoderError(
            f"{encoder.name} returned {type(vectors).__name__}, not a float32 array [n, d]"
        )
    shape = (n, dimension(encoder))
    if vectors.shape != shape:
        raise EncoderError(
            f"{encoder.name} returned an array of shape {vectors.shape} for {n} texts, not {shape}"
        )
    if vectors.dtype != np.float32:
        raise EncoderError(f"{encoder.name} returned {vectors.dtype}, not float32")
    finite = np.isfinite(vectors).all(axis=1)
    if not finite.all():
        raise EncoderError(
            f"{encoder.name} returned a value that is not finite for text {int(finite.argmin())}"
        )
    return np.array(vectors, order="C")  # The encoder may return the same array every time.
