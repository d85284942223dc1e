"""Clauses and noun phrases of a text, for the extraction of claims."""

import re
from dataclasses import dataclass, field

from oodscen.author._reading import phrases
from oodscen.author._reading.numbers import number_at
from oodscen.claims._things import Mention

_UNINFLECTED = frozenset({"deer", "sheep", "moose", "elk"})
_FEW, _MANY = 2, 3


@dataclass
class Subject:
    """A thing that a text mentions."""

    name: str
    mention: Mention
    count: int = 1
    is_agent: bool = False
    """True if it is named only as the agent of a past action. It may be gone, so it counts as
    present only if it moves."""

    @property
    def is_faint(self) -> bool:
        """True if it counts as present only when another claim is made about it."""
        return self.is_agent or self.mention.thing.faint


@dataclass(frozen=True)
class Noun:
    """A noun phrase: a thing, the ego, or a pronoun."""

    start: int
    end: int
    subject: Subject | None
    """`None` for the ego and pronouns."""
    is_oblique: bool
    """True if it follows a preposition."""

    @property
    def is_certain(self) -> bool:
        """True if it names a thing that counts as present by being named."""
        return self.subject is not None and not self.subject.is_faint


@dataclass
class Clause:
    """A segment of a sentence."""

    start: int
    end: int
    sentence: int
    is_relative: bool
    nouns: list[Noun] = field(default_factory=list)

    @property
    def heads(self) -> list[Noun]:
        """The noun phrases that may be subjects: those without a preposition."""
        return [noun for noun in self.nouns if not noun.is_oblique]


def clauses_of(text: str) -> list[Clause]:
    """Split a text into clauses, in order."""
    clauses, start, sentence = [], 0, 0
    for match in [*phrases.context("break").finditer(text), None]:
        end = len(text) if match is None else match.end()
        if end > start:
            relative = phrases.context("relative").match(text[start:]) is not None
            clauses.append(Clause(start, end, sentence, relative))
        if match is not None and phrases.context("sentence").match(match.group(0)):
            sentence += 1
        start = end
    return clauses


def count_of(lead: str, mention: Mention) -> int:
    """Return the number of things that a mention means; a value above one means several.

    It is one if the text gives a number that cannot be read.
    """
    match = phrases.context("quantity").search(lead)
    if match is None:
        return _FEW if mention.is_plural else 1
    number, pair, several = match.groups()
    if not mention.is_plural and mention.word not in _UNINFLECTED:
        return 1
    if number:
        return number_at(lead, *match.span(1), counts=True) or 1
    if pair:
        return _FEW
    large = re.search(r"crowd|large|dozens|many|herd|swarm", several, re.IGNORECASE)
    return _MANY if large else _FEW


def last_end(pattern: re.Pattern[str], text: str) -> int:
    """Return the end of the last match of a pattern, or 0 if there is none."""
    return max((match.end() for match in pattern.finditer(text)), default=0)
