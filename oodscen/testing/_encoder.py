"""An encoder without dependencies, for tests and quick runs."""

import hashlib
import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen._numbers import whole_number

_WORD = re.compile(r"\w+")


class HashEncoder(Brief):
    """Hashed bags of words: the same on every machine, in microseconds, without a model.

    Every word has a bucket among `dimension` and a sign. A row is the signed count of the text's words,
    scaled to unit length, so texts that share words are close. Meaning plays no part: the figures are
    not comparable with those of a trained encoder. A text without words gives a zero row.

    Args:
        dimension: Length of a vector, at least 1; as text, too, as in the name `hash:64`.

    Raises:
        UsageError: If it is anything else.
    """

    _repr_fields = ("dimension",)

    def __init__(self, dimension: int | str = 256) -> None:
        if isinstance(dimension, str) and re.fullmatch("[0-9]{1,9}", dimension):
            dimension = int(dimension)
        self.dimension = whole_number("the dimension of the hash encoder", dimension, 1)
        self.name = f"hash-{self.dimension}"

    def encode(self, texts: Sequence[str]) -> NDArray[np.float32]:
        """Return one row per text, in order: [n, dimension] float32."""
        counts = np.zeros((len(texts), self.dimension), np.float64)
        for row, text in zip(counts, texts, strict=True):
            for word in _WORD.findall(text.casefold()):
                digest = int.from_bytes(hashlib.sha256(word.encode()).digest()[:8], "little")
                row[(digest >> 1) % self.dimension] += 1.0 if digest & 1 else -1.0
        lengths = np.sqrt((counts * counts).sum(axis=1, keepdims=True))
        return (counts / np.where(lengths > 0.0, lengths, 1.0)).astype(np.float32)
