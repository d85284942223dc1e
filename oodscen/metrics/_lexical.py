"""Lexical measures of a set: they need no encoder and ignore meaning.

    compression_ratio   bytes of the texts, joined by line ends, over their bytes after zlib at level 9. At least
                        about 0.5; higher is more repetitive. Shaib et al., *Standardizing the measurement
                        of text diversity*, 2024. Grows with the size of the set.
    distinct_n          different word n-grams over all word n-grams. In (0, 1]; higher is more varied. Li et al.,
                        2016. Falls with the size of the set.

Pitfalls: synonyms and misspellings raise variety, and a thousand events in one frame look repetitive.
"""

import re
import zlib
from collections.abc import Sequence

from oodscen.baselines._texts import check_texts

_WORD = re.compile(r"\w+(?:['\u2019-]\w+)*")


def compression_ratio(texts: Sequence[str]) -> float:
    """Return the factor by which compression shrinks a set."""
    content = "\n".join(check_texts(texts)).encode()
    return len(content) / len(zlib.compress(content, 9))


def distinct_n(texts: Sequence[str], n: int = 2) -> float | None:
    """Return the share of distinct word n-grams, ignoring case; `None` if no text has n words."""
    total, seen = 0, set()
    for text in check_texts(texts):
        words = _WORD.findall(text.lower())
        grams = [tuple(words[place : place + n]) for place in range(len(words) - n + 1)]
        total += len(grams)
        seen.update(grams)
    return len(seen) / total if total else None
