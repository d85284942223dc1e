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


def parts_of(label: str) -> tuple[str, ...]:
    """Return the labels of the kinds that a label lists: "A or B doing C" gives "A doing C" and "B doing C".

    Words from the first preposition or verb after the list belong to all of its parts, and so does the last noun
    where a part before is an adjective. A label that is no plain list at its beginning is returned as it is.
    """
    if len(_OR.findall(label)) != 1 or not label.isprintable():
        return (label,)
    *before, last = (part.split() for part in _LIST.split(label))
    end = _end_of_noun(last)
    if end is None or not all(part and _end_of_noun(part) == len(part) for part in before):
        return (label,)
    noun, tail = last[:end], last[end:]
    kinds = []
    for part in before:
        is_adjective = len(noun) > 1 and _ADJECTIVE.search(part[-1].casefold()) is not None
        kinds.append([*part, noun[-1]] if is_adjective else part)
    labels = [" ".join([*kind, *tail]) for kind in (*kinds, noun)]
    return tuple(dict.fromkeys(text[0].upper() + text[1:] for text in labels))


def _end_of_noun(words: list[str]) -> int | None:
    """Return the number of words before the first preposition or verb; `None` if there is none or it is unclear."""
    for index, word in enumerate(words):
        folded = word.casefold()
        if folded in _SMALL:
            return index or None
        if index and folded.endswith(("ing", "ed")):
            is_last = index + 1 == len(words)
            return index if is_last or words[index + 1].casefold() in _SMALL else None
    return len(words) or None


_OR = re.compile(r"\sor\s", re.IGNORECASE)
_LIST = re.compile(r"\s*,\s*or\s+|\s+or\s+|\s*,\s*", re.IGNORECASE)
"""The marks between the parts of a list."""
_ADJECTIVE = re.compile(
    r"-down$|ed$|en$|ing$|ous$|ful$|less$|ive$|ic$|(?<!anim)(?<!sign)al$|^(wild|loose|lost|dead|low|high|large|small|big|heavy|thick|dense|wet|"
    r"dry|slow|fast|old|young|empty)$"
)
"""Adjectives by their endings, and some others; "animal" and "signal" are nouns."""
