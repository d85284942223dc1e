"""The rule for labels of kinds: short enough to stand for a kind and not for an anecdote."""

import re

from oodscen.tree._labels import label_fault

MOST_WORDS = 8
"""Largest number of words of a label, apart from articles and prepositions."""

_SMALL = frozenset(
    "a an and as at by down for from in into its of off on onto or out over that the their through to under up with "
    "without across ahead along".split()
)


def kind_fault(label: str) -> str:
    """Return why a text cannot be the label of a kind, or an empty string."""
    if fault := label_fault(label):
        return fault
    words = [word for word in re.findall(r"[^\s,;]+", label.casefold()) if word not in _SMALL]
    if len(words) > MOST_WORDS:
        return (
            f"{len(words)} words without articles and prepositions tell an anecdote: name the kind, who or what, "
            f"doing what, in at most {MOST_WORDS} words"
        )
    return ""
