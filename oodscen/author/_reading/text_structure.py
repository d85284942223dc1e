"""The structure of a text: its clauses and noun phrases, and the thing that a predicate describes."""

import re
from bisect import bisect_right

from oodscen.author._reading import phrases
from oodscen.author._reading.clauses import Clause, Noun, Subject, clauses_of, last_end
from oodscen.author._reading.subjects import nouns_of

_INVERTED = re.compile(
    r"(?:stands?|lies?|lay|sits?|gapes?|comes|runs|stood|sat) (?:an?|the|some|two|several) (?:[\w-]+ ){0,2}",
    re.IGNORECASE,
)
"""A verb and the words before the subject that follows it: `stands a large`."""
_UP_TO_ADJECTIVE = re.compile(r" (?:(?!(?:an?|the|its)\b)[\w-]+ )?", re.IGNORECASE)
"""A blank and an adjective at most."""
_GOES_ON = re.compile(r"(?<=, )(?!(?:and|but) )")
"""The start of words between commas."""
_DETERMINERS = frozenset("a an the its his her their two three some several no another".split())
_APPOSED = 24
"""Largest distance between a noun and a relative clause about it, in characters."""


class TextStructure:
    """The clauses, noun phrases and things of a text; positions are those of its characters."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.clauses = clauses_of(text)
        self.nouns, self.subjects = nouns_of(text)
        self._starts = [clause.start for clause in self.clauses]
        for noun in self.nouns:
            self.clauses[self.clause_at(noun.start)].nouns.append(noun)

    def clause_at(self, position: int) -> int:
        """Return the number of the clause with a position."""
        return bisect_right(self._starts, position) - 1

    def is_within_noun(self, position: int) -> bool:
        """Return whether a position lies in the name of a thing."""
        return any(noun.subject and noun.start <= position < noun.end for noun in self.nouns)

    def names_others(self, position: int, subject: Subject, *, whole: bool = False) -> bool:
        """Return whether the sentence, or the whole text, has named another thing to which `it` may refer."""
        begin = 0 if whole else last_end(phrases.context("sentence"), self.text[:position])
        return any(
            noun.subject not in (None, subject)
            for noun in self.nouns
            if begin <= noun.start < position
        )

    def modifies_noun(self, end: int) -> bool:
        """Return whether a word is an adjective of the noun that immediately follows."""
        following = next((noun for noun in self.nouns if noun.start >= end), None)
        if following is None or following.subject is None or following.subject.is_faint:
            return False
        between = self.text[end : following.start]
        return _UP_TO_ADJECTIVE.fullmatch(between) is not None

    def comer(self, start: int, end: int) -> Subject | None:
        """Return the thing that comes from a side; if the side opens a clause, the thing after it."""
        subject = self.owner(start, end, is_verb=True)
        clause = self.clauses[self.clause_at(start)]
        if any(noun.end <= start and not noun.is_oblique for noun in clause.nouns):
            return subject
        after = [noun for noun in clause.nouns if noun.start >= end and not noun.is_oblique]
        return after[0].subject if after else subject

    def owner(self, start: int, end: int, *, is_verb: bool) -> Subject | None:
        """Return the thing that a predicate describes; `None` for the ego or if it is unclear."""
        index = self.clause_at(start)
        clause = self.clauses[index]
        before = [noun for noun in clause.nouns if noun.end <= start]
        heads = [noun for noun in before if not noun.is_oblique]
        if heads and clause.is_relative:
            opening = self.text[clause.start : heads[0].start].split()
            is_verb_first = len(opening) > 1 and opening[1].casefold() not in _DETERMINERS
            antecedent = self._antecedent(clause)
            tail = self.text[heads[0].end : start].split()
            is_past = len(opening) == 1 and self._is_ego(heads[0]) and 0 < len(tail) < 6
            if (is_verb_first or (is_past and "and" not in tail)) and antecedent is not None:
                return antecedent
        if before and start - before[-1].end <= 1 and self._may_govern(before[-1]):
            return self._referent(before[-1]).subject
        if heads:
            head = self._referent(heads[0])
            if head.subject is None and self._is_ego(head) and not is_verb and len(before) > 1:
                rest = [noun for noun in before if noun.start > head.start]
                return rest[-1].subject if rest else None
            return head.subject
        if self.is_about_absent(start):
            return None
        if not is_verb:
            after = [noun for noun in clause.nouns if noun.start >= end and not noun.is_oblique]
            if after and not before:
                return after[0].subject
        if not before and clause.is_relative:
            return self._antecedent(clause)
        if is_verb and not clause.is_relative:
            follower = next((noun for noun in clause.nouns if noun.start >= end), None)
            between = self.text[start : follower.start] if follower is not None else ""
            if follower is not None and follower.subject and _INVERTED.fullmatch(between):
                return follower.subject
        earlier = self._earlier_head(index)
        if earlier is not None:
            return earlier.subject
        return before[0].subject if before and is_verb else None

    def is_about_absent(self, position: int) -> bool:
        """Return whether the words at a position are about what the text denies.

        Words between commas, without a subject of their own, are about that of the words before.
        """
        clause, end = self.clauses[self.clause_at(position)], position
        while not phrases.context("absent").search(self.text[clause.start : end]):
            has_head = any(not noun.is_oblique for noun in clause.nouns)
            if has_head or not _GOES_ON.match(self.text, clause.start):
                return False
            end = clause.start
            clause = self.clauses[self.clause_at(end - 1)]
        return True

    def _referent(self, noun: Noun) -> Noun:
        """Return the referent of a pronoun: the last thing that its sentence named."""
        word = self.text[noun.start : noun.end].casefold()
        if word in ("he", "she"):
            people = [
                other
                for other in self.nouns
                if other.end <= noun.start
                and other.subject
                and other.subject.mention.thing.group == "person"
            ]
            return people[-1] if people else noun
        if word not in ("it", "they"):
            return noun
        earlier = [
            other
            for other in self.nouns
            if other.end <= noun.start and (other.subject is not None or not other.is_oblique)
        ]
        if not earlier or earlier[-1].subject is None:
            return noun
        between = self.text[earlier[-1].end : noun.start]
        return noun if phrases.context("sentence").search(between) else earlier[-1]

    def _is_ego(self, noun: Noun) -> bool:
        words = self.text[noun.start : noun.end]
        return phrases.context("may_be_ego").fullmatch(words) is not None

    def _may_govern(self, noun: Noun) -> bool:
        """Return whether the words right after a noun phrase can describe it."""
        is_possessive = self.text[noun.end - 2 : noun.end] == "'s"
        is_possessive = is_possessive or self.text.startswith("'", noun.end)
        return not is_possessive and (noun.subject is not None or not noun.is_oblique)

    def _antecedent(self, clause: Clause) -> Subject | None:
        """Return the referent of a relative clause: the noun phrase right before it."""
        earlier = [noun for noun in self.nouns if noun.end <= clause.start]
        if not earlier or clause.start - earlier[-1].end > _APPOSED:
            return None
        between = self.text[earlier[-1].end : clause.start]
        return None if phrases.context("sentence").search(between) else earlier[-1].subject

    def _earlier_head(self, index: int) -> Noun | None:
        """Return the subject of the nearest earlier clause of the same sentence."""
        for clause in reversed(self.clauses[:index]):
            if clause.sentence != self.clauses[index].sentence:
                return None
            heads = [noun for noun in clause.nouns if not noun.is_oblique]
            heads = heads or [noun for noun in clause.nouns if noun.subject is not None]
            heads = heads or clause.nouns
            if all(noun.subject is not None and noun.subject.is_faint for noun in heads):
                heads = [noun for noun in heads if not noun.is_oblique]
            if heads:
                return heads[0]
        return None
