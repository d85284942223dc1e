"""Stems of words as vectors: they carry the content of a text where an embedding carries its style."""

import re
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import snowballstemmer
from numpy.typing import NDArray

_WORD = re.compile(r"[a-z]{2,}")
_ANY_WORD = re.compile(r"\w{2,}")
_STEMMER = snowballstemmer.stemmer("english")


def stems(text: str) -> list[str]:
    """Return the stems of a text's words in plain Latin letters, in order."""
    return [_stem(word) for word in _WORD.findall(text.lower())]


@lru_cache(maxsize=65_536)
def _stem(word: str) -> str:
    return str(_STEMMER.stemWord(word))


class Words:
    """Maps texts to rows of weighted stems.

    Args:
        vocabulary: The stems that count.
        weights: Inverse document frequency of each, [V].
    """

    def __init__(self, vocabulary: Sequence[str], weights: NDArray[np.floating]) -> None:
        self._place = {stem: place for place, stem in enumerate(vocabulary)}
        self._weights = np.asarray(weights, np.float32)

    def rows(self, texts: Sequence[str]) -> NDArray[np.float32]:
        """Return [n, V] rows of unit length; zero for a text without a known stem."""
        found = np.zeros((len(texts), len(self._weights)), np.float32)
        for row, text in zip(found, texts, strict=True):
            row[[self._place[stem] for stem in stems(text) if stem in self._place]] = 1.0
        found *= self._weights
        length = np.linalg.norm(found, axis=1, keepdims=True)
        return np.asarray(found / np.maximum(length, 1e-9), np.float32)

    def known(self, text: str) -> float:
        """Return the share of a text's words, of any alphabet, whose stems are known."""
        total = len(_ANY_WORD.findall(text))
        return sum(stem in self._place for stem in stems(text)) / total if total else 0.0
