"""Further measures of one set: of its vectors (`oodscen.metrics._vectors.distances`), and of its words.

The lexical measures need no encoder and ignore meaning:

    compression_ratio   bytes of the texts, sorted and joined by line ends, over their bytes after zlib at level 9.
                        At least about 0.5; higher is more repetitive. Shaib et al., *Standardizing the measurement
                        of text diversity*, 2024. Grows with the size of the set.
    distinct_n          different word n-grams over all word n-grams. In (0, 1]; higher is more varied. Li et al.,
                        2016. Falls with the size of the set.

Pitfalls: synonyms and misspellings raise variety, and a thousand events in one frame look repetitive.
"""

import re
import zlib
from collections.abc import Sequence
from typing import TYPE_CHECKING

from oodscen.baselines._texts import check_texts
from oodscen.data._base import Data
from oodscen.metrics._vectors.distances import remote_clique, vendi

if TYPE_CHECKING:
    from oodscen.metrics._vectors.space import BaselineSpace

_WORD = re.compile(r"\w+(?:['\u2019-]\w+)*")


class Variety(Data):
    """Further measures of one set; none is comparable between sets of different size."""

    n: int
    vendi: float
    """Effective number of different texts, in [1, n]."""
    remote_clique: float | None
    """Mean distance over pairs, in [0, 2]; `None` for one text."""
    compression_ratio: float
    """Higher is more repetitive."""
    distinct_1: float | None
    distinct_2: float | None
    """Share of distinct words, and of distinct pairs of words, in (0, 1]."""
    encoder: str


def variety(space: "BaselineSpace", texts: Sequence[str]) -> Variety:
    """Return further measures of variety of one set."""
    vectors = space.vectors(texts)
    return Variety(
        n=len(texts),
        vendi=vendi(vectors),
        remote_clique=remote_clique(vectors) if len(texts) > 1 else None,
        compression_ratio=compression_ratio(texts),
        distinct_1=distinct_n(texts, 1),
        distinct_2=distinct_n(texts, 2),
        encoder=space.encoder.name,
    )


def compression_ratio(texts: Sequence[str]) -> float:
    """Return the factor by which compression shrinks a set."""
    content = "\n".join(sorted(check_texts(texts))).encode()
    return len(content) / len(zlib.compress(content, 9))


def distinct_n(texts: Sequence[str], n: int) -> float | None:
    """Return the share of distinct word n-grams, ignoring case; `None` if no text has n words."""
    total, different = 0, set()
    for text in check_texts(texts):
        words = _WORD.findall(text.lower())
        ngrams = [tuple(words[start : start + n]) for start in range(len(words) - n + 1)]
        total += len(ngrams)
        different.update(ngrams)
    return len(different) / total if total else None
