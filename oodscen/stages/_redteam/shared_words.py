"""Labels compared with a text by the words that they share."""

import math
import re
from collections import Counter
from collections.abc import Sequence

from oodscen._words.text import stem


def shared_word_scores(text: str, labels: Sequence[str]) -> list[float]:
    """Return for each label the share of its weighted words that a text contains, 0 to 1.

    Rare words among the labels weigh more. Words are compared by their stems, so that inflections coincide.
    """
    text_words = stems(text)
    label_words = [stems(label) for label in labels]
    counts = Counter(word for words in label_words for word in words)
    weights = {word: math.log1p(len(labels) / count) for word, count in counts.items()}
    scores = []
    for words in label_words:
        total = math.fsum(weights[word] for word in sorted(words))
        shared = math.fsum(weights[word] for word in sorted(words & text_words))
        scores.append(shared / total if total else 0.0)
    return scores


def stems(text: str) -> set[str]:
    """Return the stems of the words of three letters and more."""
    return {stem(word) for word in re.findall(r"[^\W\d_]{3,}", text.casefold())}
