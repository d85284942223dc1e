"""The concepts that a text names."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import NamedTuple

from oodscen.claims._cancelled import describes_noun, is_weather_cancelled
from oodscen.judging._aspects.concepts import Concept, concepts, unseen_concepts
from oodscen.judging._aspects.word_forms import LINKS, expressions_by_first_word, split_words

WIDEST_GAP = 3
"""The most words that "*" in an expression can match."""

_DENIALS = frozenset({"no", "not", "without", "never", "neither", "nor", "free", "absence"})
_WEATHER = ("fog", "dust storm", "snow", "rain", "hail", "ice")


@dataclass(frozen=True)
class Naming:
    """The concepts and words found in a text."""

    concepts: tuple[Concept, ...]
    """Every concept named, ordered by its first word; denied ones are excluded."""
    heads: tuple[Concept, ...]
    """The things that the text is about: those named before its first preposition, state or act."""
    rest: tuple[str, ...]
    """The words outside any expression, in the table's form, without prepositions."""


class _Mention(NamedTuple):
    """A concept, and the index of the word with which its expression begins."""

    start: int
    concept: Concept


@lru_cache(maxsize=4096)
def naming_of(text: str) -> Naming:
    """Return what a text names; if several expressions start at the same word, the longest wins."""
    words, clauses = split_words(_without_past_weather(text))
    mentions, used = _mentions(words)
    stated = [mention for mention in mentions if mention.concept.kind != "aside"]
    denied = _denied(words, clauses, used, [mention.start for mention in stated])
    stated = [mention for mention in stated if mention.start not in denied]
    return Naming(
        concepts=tuple(mention.concept for mention in stated),
        heads=tuple(_heads(stated, words, used)),
        rest=tuple(
            word for index, word in enumerate(words) if index not in used and word not in LINKS
        ),
    )


@lru_cache(maxsize=4096)
def visible_naming(text: str) -> Naming:
    """Return what a label names that frames can show.

    A concept that cannot be seen gives way to what it is a kind of: an angry person to a person.
    """
    naming = naming_of(text)
    return Naming(_visible(naming.concepts), _visible(naming.heads), naming.rest)


def _visible(named: Sequence[Concept]) -> tuple[Concept, ...]:
    names: list[str] = []
    for concept in named:
        names += concept.wider if concept.name in unseen_concepts() else [concept.name]
    return tuple(concepts()[name] for name in dict.fromkeys(names))


def _mentions(words: Sequence[str]) -> tuple[list[_Mention], set[int]]:
    """Return the concepts whose expressions stand among some words, and the indices of all words of these."""
    mentions: list[_Mention] = []
    used: set[int] = set()
    for start, word in enumerate(words):
        for expression, concept in expressions_by_first_word().get(word, ()):
            indices = _indices(expression, words, start)
            if indices and not used.intersection(indices):
                used.update(indices)
                mentions.append(_Mention(start, concept))
                break
    return mentions, used


def _indices(expression: Sequence[str], words: Sequence[str], start: int) -> tuple[int, ...]:
    """Return the indices of an expression's words when it begins at `start`; empty if it does not match."""
    indices: list[int] = []
    ahead, gap = start, 0
    for word in expression:
        if word == "*":
            gap = WIDEST_GAP
            continue
        within = range(ahead, min(ahead + gap + 1, len(words)))
        index = next((index for index in within if words[index] == word), None)
        if index is None:
            return ()
        indices.append(index)
        ahead, gap = index + 1, 0
    return tuple(indices)


def _denied(
    words: Sequence[str], clauses: Sequence[int], used: set[int], starts: Sequence[int]
) -> set[int]:
    """Return the starts of denied concepts, as in "no deer" or "a deer is not there"."""
    first_denial: dict[int, int] = {}
    denied_clauses: set[int] = set()
    last_start = {clauses[start]: start for start in starts}
    for index, word in enumerate(words):
        if word not in _DENIALS or index in used:
            continue
        clause = clauses[index]
        first_denial.setdefault(clause, index)
        if word in ("not", "never") and last_start.get(clause, -1) < index:
            denied_clauses.add(clause)
    return {
        start
        for start in starts
        if clauses[start] in denied_clauses or start > first_denial.get(clauses[start], len(words))
    }


def _heads(stated: Sequence[_Mention], words: Sequence[str], used: set[int]) -> Iterator[Concept]:
    things = [mention for mention in stated if mention.concept.kind in ("odd", "ordinary")]
    if not things:
        return
    first = things[0].start
    ends = [
        index
        for index, word in enumerate(words)
        if index > first and index not in used and word in LINKS
    ]
    ends += [
        start for start, concept in stated if start > first and concept.kind in ("state", "act")
    ]
    end = min(ends, default=len(words))
    starts = {mention.start for mention in things}
    # In "truck tyre" the truck only says which tyre.
    yield from (
        concept
        for start, concept in things
        if start < end and (concept.kind == "odd" or start + 1 not in starts)
    )


def _without_past_weather(text: str) -> str:
    """Return a text without weather that is over, or that only describes a thing: a snow plough."""
    return _weather_words().sub(lambda match: "-" if _is_cancelled(match) else match.group(0), text)


def _is_cancelled(match: re.Match[str]) -> bool:
    return is_weather_cancelled(match) or describes_noun(match)


@cache
def _weather_words() -> re.Pattern[str]:
    words = {word for name in _WEATHER for word in concepts()[name].expressions if word.isalpha()}
    return re.compile(rf"\b(?:{'|'.join(sorted(words, key=len, reverse=True))})\b", re.IGNORECASE)
