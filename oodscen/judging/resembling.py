"""Which option an answer resembles that names none: misspelt, or in the words of a label."""

from collections.abc import Iterable, Mapping, Sequence
from difflib import SequenceMatcher

from oodscen.judging.matching import affirmed_words, telling_words
from oodscen.judging.wording import normalise

LONGEST_SLIP = 30
"""Longer texts are no misspelt ids, in characters."""

LEAST_LIKENESS = 0.8
"""How like an id its misspelling is, of 1."""

LEAST_LEAD = 0.1
"""How much less like the next id it is."""

LEAST_SHARE = 0.6
"""Of the words in an answer and a label, how many they share to be taken for the same."""


def misspelt(whole: str, offered: Sequence[str]) -> str | None:
    """Return the option whose id a whole answer misspells: "emergancy brake"."""
    whole = whole.strip(" .,;:!?()[]{}'\n")
    if not offered or len(whole) > LONGEST_SLIP:
        return None
    (best, name), *others = _ranked(
        (SequenceMatcher(None, whole, normalise(name)).ratio(), name) for name in offered
    )
    is_clear = not others or best - others[0][0] > LEAST_LEAD
    return name if best >= LEAST_LIKENESS and is_clear else None


def resembled(text: str, labels: Mapping[str, str]) -> tuple[str, str] | None:
    """Return the one option whose telling words a short answer has, and how that was found."""
    said = affirmed_words(text)
    if not said or not labels:
        return None
    words = {name: telling_words(label) for name, label in labels.items()}
    holding = [name for name, own in words.items() if all(_begins_one(one, own) for one in said)]
    if len(holding) == 1:
        return holding[0], "words of the label"
    shared = [name for name, own in words.items() if 2 * len(own & said) >= len(own) > 0]
    if len(shared) == 1:
        return shared[0], "words of the label"
    ranked = _ranked((len(own & said) / len(own | said), name) for name, own in words.items())
    (best, name), *others = ranked
    if best >= LEAST_SHARE and (not others or others[0][0] < best):
        return name, "most words of the label"
    return None


def _ranked(scores: Iterable[tuple[float, str]]) -> list[tuple[float, str]]:
    return sorted(scores, reverse=True)


def _begins_one(word: str, words: set[str]) -> bool:
    return word in words or any(len(word) > 3 and one.startswith(word) for one in words)
