"""Words of texts in the forms of the table of concepts, and its expressions by their first word."""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache

from oodscen._words.text import without_possessives
from oodscen.judging._aspects.concepts import Concept, concepts

LINKS = frozenset(
    """
    about above across after against ahead along around at before behind below beside between by
    down during for from in inside into near off on onto out outside over past round since that
    through to toward towards under until up when where which while who with
    """.split()
)
"""Prepositions and conjunctions, which have one form."""
_RIGID = frozenset({"box", "doe", "not", "the"})
"""Words whose inflected forms are other words: "boxes" (crates), "does", "noted", "thing"."""
_PLURAL_ONLY = frozenset(
    """
    barrel bear branch buck car combine cop crane drum duck float rock skip stag tire train wheel
    """.split()
)
"""Words for things that have a plural, and no participle or past: "bearing" and "tired" are other words."""


def split_words(text: str) -> tuple[list[str], list[int]]:
    """Return a text's words in the table's form, and the number of the clause that holds each word."""
    words: list[str] = []
    clauses: list[int] = []
    for number, clause in enumerate(re.split(r"[,;.:!?]|\b(?=and\b|but\b)", _plain(text))):
        for word in re.findall(r"[^\W_]+", clause):
            words.append(_table_forms().get(word, word))
            clauses.append(number)
    return words, clauses


@cache
def expressions_by_first_word() -> Mapping[str, Sequence[tuple[tuple[str, ...], Concept]]]:
    """Return the expressions by their first word, longest first."""
    expressions: dict[str, list[tuple[tuple[str, ...], Concept]]] = {}
    for concept in concepts().values():
        for expression in concept.expressions:
            text = _plain(expression).replace("*", " * ")
            words = tuple(
                _table_forms().get(word, word) for word in re.findall(r"[^\W_]+|\*", text)
            )
            expressions.setdefault(words[0], []).append((words, concept))
    for alike in expressions.values():
        alike.sort(key=lambda entry: -sum(word != "*" for word in entry[0]))
    return expressions


def _plain(text: str) -> str:
    """Return a text in lower case, without contractions and possessives."""
    text = text.casefold().replace("\u2019", "'").replace("n't", " not")
    return without_possessives(text)


@cache
def _table_forms() -> Mapping[str, str]:
    """Map every inflected form to the table's word: "stopping" to "stop"."""
    vocabulary = {
        word
        for concept in concepts().values()
        for expression in concept.expressions
        for word in re.findall(r"[^\W_]+", _plain(expression))
    }
    forms: dict[str, str] = {}
    for word in sorted(vocabulary, key=lambda word: (len(word), word)):
        base = forms.get(word, word)
        for form in _inflected(word):
            forms.setdefault(form, base)
    return forms


def _inflected(word: str) -> Iterator[str]:
    """Yield a word and its regular plural, participles and past."""
    yield word
    if len(word) < 3 or word in LINKS or word in _RIGID:
        return
    is_sibilant = word.endswith(("s", "x", "z", "ch", "sh"))
    yield word + ("es" if is_sibilant else "s")
    if word in _PLURAL_ONLY:
        return
    if word.endswith("y") and word[-2] not in "aeiou":
        yield from (word[:-1] + "ies", word[:-1] + "ied")
    stem = word.removesuffix("e")
    yield from (stem + "ing", stem + "ed")
    if word[-1] not in "aeiouwxy" and word[-2] in "aeiou":
        yield from (word + word[-1] + "ing", word + word[-1] + "ed")
