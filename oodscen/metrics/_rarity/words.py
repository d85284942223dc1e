"""Stems of words as vectors: they carry the content of a text where an embedding carries its style."""

import re
from collections.abc import Sequence
from functools import cache
from typing import Final
from unicodedata import combining, normalize

import numpy as np
from numpy.typing import NDArray

from oodscen._words.text import inflection_stem

_WORD = re.compile(r"[^\W\d_]{2,}")
_SENTENCE_BREAK = re.compile(r"(?<=[.!?:])\s+")
_COURTEOUS: Final = """
apologies apologise appreciate attention cheers colleague colleagues dear excuse forgive grateful greetings hello hi kind kindly obliged pardon
please regards sincerely sir madam sorry thank thanks thankful welcome wishes yours
"""
_FILLING: Final = """
advance afternoon all an and any answer are as at be below best bother by can certainly could course day do does evening everyone faithfully feel
find following for free glad good happy has have help here hope if in information interruption is it know let look many may me might morning much
my note notice of on or our question read reading respectfully shall should so such sure team that the there these this those time to trouble truly
us very warm was we well were will with would you your
"""
"""Words that say nothing beside courteous ones."""
_LEAST_LENGTH = 1e-9
"""Least length by which a row is divided: rows of zeros stay so."""


def stems(text: str) -> list[str]:
    """Return the stems of a text's words, of any alphabet and without accents, in order."""
    plain = "".join(char for char in normalize("NFD", text.lower()) if not combining(char))
    return [inflection_stem(word) for word in _WORD.findall(plain)]


def without_courtesy(text: str) -> str:
    """Return a text without its sentences of courtesy alone; the text itself if there are no others."""
    sentences = _SENTENCE_BREAK.split(text)
    others = [sentence for sentence in sentences if not _is_courtesy(sentence)]
    return " ".join(others) if 0 < len(others) < len(sentences) else text


def _is_courtesy(sentence: str) -> bool:
    courteous, filling = _courtesy_stems()
    sentence_stems = set(stems(sentence))
    return not sentence_stems.isdisjoint(courteous) and sentence_stems <= courteous | filling


@cache
def _courtesy_stems() -> tuple[frozenset[str], frozenset[str]]:
    """Return the stems of courteous words, and of those that say nothing beside them."""
    return frozenset(stems(_COURTEOUS)), frozenset(stems(_FILLING))


class Words:
    """Maps texts to rows of weighted stems; [V] weights are the inverse document frequencies of a vocabulary."""

    def __init__(self, vocabulary: Sequence[str], weights: NDArray[np.floating]) -> None:
        self._columns = {stem: column for column, stem in enumerate(vocabulary)}
        self._weights = np.asarray(weights, np.float32)

    def rows(self, texts: Sequence[str]) -> NDArray[np.float32]:
        """Return [n, V] rows of unit length; zero for a text without a known stem."""
        rows = np.zeros((len(texts), len(self._weights)), np.float32)
        for row, text in zip(rows, texts, strict=True):
            row[[self._columns[stem] for stem in stems(text) if stem in self._columns]] = 1.0
        rows *= self._weights
        lengths = np.linalg.norm(rows, axis=1, keepdims=True)
        return np.asarray(rows / np.maximum(lengths, _LEAST_LENGTH), np.float32)

    def known_share(self, text: str) -> float:
        """Return the share of a text's words, of any alphabet, whose stems are known."""
        known = [stem in self._columns for stem in stems(text)]
        return sum(known) / len(known) if known else 0.0
