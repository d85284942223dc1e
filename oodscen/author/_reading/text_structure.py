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
_FEW_WORDS = 6
"""Smallest number of words after the ego that are more than a verb with its adverbs."""
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
        if following is None or not following.is_certain:
            return False
        between = self.text[end : following.start]
        return _UP_TO_ADJECTIVE.fullmatch(between) is not None

    def comer(self, start: int, end: int) -> Subject | None:
        """Return the thing that comes from a side; if the side opens a clause, the thing after it."""
        clause = self.clauses[self.clause_at(start)]
        if not any(noun.end <= start for noun in clause.heads):
            for noun in clause.heads:
                if noun.start >= end:
                    return noun.subject
        return self.owner(start, end, is_verb=True)

    def owner(self, start: int, end: int, *, is_verb: bool) -> Subject | None:
        """Return the thing that a predicate describes; `None` for the ego or if it is unclear."""
        clause = self.clauses[self.clause_at(start)]
        before = [noun for noun in clause.nouns if noun.end <= start]
        head = next((noun for noun in before if not noun.is_oblique), None)
        if head is not None and self._is_about_antecedent(clause, head, start):
            antecedent = self._antecedent(clause)
            if antecedent is not None:
                return antecedent
        if before and start - before[-1].end <= 1 and self._may_govern(before[-1]):  # a van parked
            return self._referent(before[-1]).subject
        if head is None:
            return self._owner_elsewhere(clause, start, end, is_verb=is_verb)
        head = self._referent(head)
        if self._is_ego(head) and not is_verb and len(before) > 1:  # we meet a van in our lane
            return before[-1].subject if before[-1].start > head.start else None
        return head.subject

    def _owner_elsewhere(
        self, clause: Clause, start: int, end: int, *, is_verb: bool
    ) -> Subject | None:
        """Return the thing that a predicate describes if its clause has no subject before it."""
        if self.is_about_absent(start):
            return None
        oblique = next((noun for noun in clause.nouns if noun.end <= start), None)
        if oblique is None:
            follower = next((noun for noun in clause.heads if noun.start >= end), None)
            if follower is not None and not is_verb:  # ahead, a van
                return follower.subject
            if clause.is_relative:  # a van, which is parked
                return self._antecedent(clause)
        if is_verb and not clause.is_relative:
            follower = next((noun for noun in clause.nouns if noun.start >= end), None)
            if follower is not None and _INVERTED.fullmatch(self.text, start, follower.start):
                return follower.subject
        earlier = self._earlier_head(clause)
        if earlier is not None:
            return earlier.subject
        return oblique.subject if oblique is not None and is_verb else None

    def is_about_absent(self, position: int) -> bool:
        """Return whether the words at a position are about what the text denies.

        Words between commas, without a subject of their own, are about that of the words before.
        """
        clause, end = self.clauses[self.clause_at(position)], position
        while not phrases.context("absent").search(self.text[clause.start : end]):
            if clause.heads or not _GOES_ON.match(self.text, clause.start):
                return False
            end = clause.start
            clause = self.clauses[self.clause_at(end - 1)]
        return True

    def _is_about_antecedent(self, clause: Clause, head: Noun, start: int) -> bool:
        """Return whether a predicate describes the antecedent of its clause, not the first noun in it.

        So it is after a verb (`the van that hit the cone`) and where the ego is the subject (`the
        child that we passed`).
        """
        if not clause.is_relative:
            return False
        opening = self.text[clause.start : head.start].split()
        if len(opening) > 1:
            return opening[1].casefold() not in _DETERMINERS
        between = self.text[head.end : start].split()
        is_past = 0 < len(between) < _FEW_WORDS and "and" not in between
        return len(opening) == 1 and is_past and self._is_ego(head)

    def _referent(self, noun: Noun) -> Noun:
        """Return the referent of a pronoun: the last person, or the last thing that its sentence named."""
        word = self.text[noun.start : noun.end].casefold()
        earlier = [other for other in self.nouns if other.end <= noun.start]
        if word in ("he", "she"):
            return next((other for other in reversed(earlier) if _is_person(other)), noun)
        if word not in ("it", "they"):
            return noun
        last = next(
            (other for other in reversed(earlier) if other.subject or not other.is_oblique), None
        )
        if last is None or last.subject is None:
            return noun
        is_past = phrases.context("sentence").search(self.text[last.end : noun.start])
        return noun if is_past else last

    def _is_ego(self, noun: Noun) -> bool:
        words = self.text[noun.start : noun.end]
        return noun.subject is None and phrases.context("may_be_ego").fullmatch(words) is not None

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

    def _earlier_head(self, clause: Clause) -> Noun | None:
        """Return the subject of the nearest earlier clause of the same sentence."""
        for earlier in reversed(self.clauses):
            if earlier.start < clause.start and earlier.sentence == clause.sentence:
                head = _head_of(earlier)
                if head is not None:
                    return head
        return None


def _head_of(clause: Clause) -> Noun | None:
    """Return the subject of a clause; without one, the first thing that it names, unless all are faint."""
    if clause.heads:
        return clause.heads[0]
    things = [noun for noun in clause.nouns if noun.subject is not None]
    if things:
        return things[0] if any(noun.is_certain for noun in things) else None
    return clause.nouns[0] if clause.nouns else None


def _is_person(noun: Noun) -> bool:
    return noun.subject is not None and noun.subject.mention.thing.group == "person"
