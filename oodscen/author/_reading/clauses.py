"""Clauses and noun phrases of a text, for who reads what it says."""

import re
from dataclasses import dataclass, field

from oodscen.author._reading import phrases
from oodscen.claims._things import Mention

_UNINFLECTED = frozenset({"deer", "sheep", "moose", "elk"})
_FEW, _MANY = 2, 3


@dataclass
class Subject:
    """A thing that a text speaks of."""

    name: str
    mention: Mention
    count: int = 1
    is_agent: bool = False
    """It only did something, and may be gone: it is there if it moves."""

    @property
    def is_faint(self) -> bool:
        """Whether it is claimed to be there only where something else is said of it."""
        return self.is_agent or self.mention.thing.faint


@dataclass(frozen=True)
class Noun:
    """A noun phrase: of a thing, of the ego, or a pronoun."""

    start: int
    end: int
    subject: Subject | None
    """`None` for the ego and pronouns."""
    is_oblique: bool
    """It follows a preposition."""


@dataclass
class Clause:
    """A stretch of a sentence."""

    start: int
    end: int
    sentence: int
    is_relative: bool
    nouns: list[Noun] = field(default_factory=list)


def clauses_of(text: str) -> list[Clause]:
    """Cut a text into clauses, in order."""
    clauses, start, sentence = [], 0, 0
    for found in [*phrases.BREAK.finditer(text), None]:
        end = len(text) if found is None else found.end()
        if end > start:
            relative = phrases.RELATIVE.match(text[start:]) is not None
            clauses.append(Clause(start, end, sentence, relative))
        if found is not None and phrases.SENTENCE.match(found.group(0)):
            sentence += 1
        start = end
    return clauses


def count_of(lead: str, mention: Mention) -> int:
    """Return how many of a thing a mention means; more than one stands for several."""
    found = phrases.QUANTITY.search(lead)
    if found is None:
        return _FEW if mention.is_plural else 1
    number, pair, several = found.groups()
    if not mention.is_plural and mention.word not in _UNINFLECTED:
        return 1
    if number:
        return phrases.NUMBER_WORDS.get(number.casefold()) or max(int(number), 1)
    if pair:
        return _FEW
    large = re.search(r"crowd|large|dozens|many|herd|swarm", several, re.IGNORECASE)
    return _MANY if large else _FEW


def number_of(words: str) -> str:
    """Return a number, given as digits or words, in digits."""
    return str(phrases.NUMBER_WORDS.get(words.casefold(), words))


def last_end(pattern: re.Pattern[str], text: str) -> int:
    """Return where the last match of a pattern ends; 0 where there is none."""
    return max((found.end() for found in pattern.finditer(text)), default=0)
