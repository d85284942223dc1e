"""The things that a text mentions: which words name a new thing, which an earlier one, and which none."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from oodscen.author._reading import phrases
from oodscen.author._reading.clauses import Noun, Subject, count_of, last_end
from oodscen.claims._things import Mention, mentions

_NEAR = 60
"""Number of characters before a noun in which its preposition or its quantity stands."""
_NEW = frozenset({"a", "an", "another", "a second", "a third", "a further"})
_KNOWN = frozenset({"the", "these", "those", "its"})
_POSSESSIVE = frozenset({"its", "their", "his", "her"})


@dataclass(frozen=True)
class NounInContext:
    """A noun in a text, with the words around it."""

    text: str
    mention: Mention
    earlier: tuple[Subject, ...]
    """The things named before."""

    @cached_property
    def before(self) -> str:
        return self.text[: self.mention.start]

    @cached_property
    def after(self) -> str:
        return self.text[self.mention.end :]

    @cached_property
    def sentence(self) -> str:
        """The words of its sentence before the noun."""
        return self.before[last_end(phrases.context("sentence"), self.before) :]

    @cached_property
    def lead(self) -> str:
        """The words of its clause before the noun."""
        return self.sentence[last_end(phrases.context("break"), self.sentence) :]

    @cached_property
    def determiner(self) -> str:
        """The article or pronoun that determines the noun; empty if there is none."""
        match = phrases.context("determiner").search(self.lead)
        return match.group(1).casefold() if match else ""

    @cached_property
    def count(self) -> int:
        return count_of(self.lead, self.mention)

    @property
    def is_new(self) -> bool:
        """True if the noun introduces another thing."""
        is_counted = phrases.context("quantity").search(self.lead) is not None
        return self.determiner in _NEW or (is_counted and self.determiner not in _KNOWN)

    @property
    def is_inflected(self) -> bool:
        """True if the noun has a plural ending."""
        words = self.text[self.mention.start : self.mention.end].casefold()
        return self.mention.is_plural and words != self.mention.word.casefold()

    @property
    def name(self) -> str:
        return self.mention.thing.name

    @property
    def group(self) -> str:
        return self.mention.thing.group


def _is_carried(at: NounInContext) -> bool:
    """Return whether a thing is merely a part or the load of what is named right before it."""
    last = at.earlier[-1].mention if at.earlier else None
    bearer = phrases.context("bearer").search(at.sentence)
    if bearer and (last is None or last.end <= at.mention.start - len(bearer.group(0))):
        return True
    if last is None:
        return False
    between = at.text[last.end : at.mention.start]
    return phrases.context("carried").fullmatch(between.lstrip()) is not None


_NOTHING: tuple[Callable[[NounInContext], object], ...] = (
    lambda at: (
        phrases.context("not_there").search(at.sentence)
        and not (at.name == "traffic light" and phrases.context("all_of_them").search(at.before))
    ),
    lambda at: (
        phrases.context("listed").search(at.sentence) and phrases.context("or_more").match(at.after)
    ),
    lambda at: phrases.context("not_itself").match(at.after),
    lambda at: not at.is_inflected and phrases.context("described").match(at.after),
    lambda at: at.name == "traffic light" and phrases.context("lights_up").match(at.after),
    lambda at: (
        phrases.context("as_a").search(at.before) and phrases.context("ends").match(at.after)
    ),
    lambda at: at.name == "object" and phrases.context("turns_out").match(at.after),
    lambda at: at.name == "barrier" and at.after.startswith(" of "),
    lambda at: at.mention.word == "drunk" and phrases.context("being").search(at.before),
    lambda at: at.name == "car door" and at.before.endswith("'s "),
    lambda at: at.group == "person" and phrases.context("rides").match(at.after),
    lambda at: at.name in phrases.things("parts") and at.determiner in ("the", "its", "their"),
    lambda at: at.group == "object" and _is_carried(at),
    lambda at: (
        at.mention.word == "tree"
        and at.mention.is_plural
        and phrases.context("background").search(at.lead)
    ),
)
"""Tests of a noun that names nothing that is there; any of them suffices."""

_NOTHING_NEW: tuple[Callable[[NounInContext], object], ...] = (
    lambda at: (
        at.determiner == "the"
        and at.mention.word == "cab"
        and not phrases.context("cab_of_its_own").match(at.after)
    ),
    lambda at: (
        at.determiner == "its"
        and at.group in ("vehicle", "object")
        and not phrases.context("left_its").search(at.lead)
    ),
    lambda at: at.determiner == "the" and at.name == "tree" and at.mention.is_plural,
    lambda at: at.mention.thing.vague and at.determiner in _POSSESSIVE,
    lambda at: (
        phrases.context("behind").match(at.after)
        and phrases.context("left_a").search(at.lead[-40:])
    ),
)
"""Tests of a noun that names nothing of its own, unless it names a thing that was named before."""


def subject_of(at: NounInContext) -> Subject | None:
    """Return the thing that a noun names: an earlier one, or a new one; `None` if it names none."""
    if any(test(at) for test in _NOTHING):
        return None
    same = [subject for subject in at.earlier if subject.mention.thing is at.mention.thing]
    if same and (not at.is_new or at.determiner == "one"):
        return same[-1]
    if _is_generic(at):
        alike = [subject for subject in at.earlier if _is_alike(subject, at)]
        if alike and not phrases.context("placed").match(at.after):
            return alike[-1]
        if at.count > 1:
            return None
    if any(test(at) for test in _NOTHING_NEW):
        return None
    is_somebody = at.mention.thing.vague or at.group == "person"
    is_agent = is_somebody and phrases.context("agent").match(at.after) is not None
    label = at.name if not same else f"{at.name} {len(same) + 1}"
    return Subject(label, at.mention, at.count, is_agent)


def _is_generic(at: NounInContext) -> bool:
    return (
        at.name in phrases.things("generic")
        and at.mention.word in phrases.things("generic") | phrases.things("generic_words")
        and at.determiner in ("the", "its", "this", "that")
    )


def _is_alike(one: Subject, at: NounInContext) -> bool:
    thing = one.mention.thing
    return thing.group == at.group and thing.name not in phrases.things("cycles")


def nouns_of(text: str) -> tuple[list[Noun], list[Subject]]:
    """Return the noun phrases of a text in order, and the things that they name."""
    nouns: list[Noun] = []
    subjects: list[Subject] = []
    named = list(mentions(text))
    for mention, after in zip(named, [*named, None][1:], strict=True):
        at = NounInContext(text, mention, tuple(subjects))
        is_modifier = after is not None and text[mention.end : after.start] == " "
        is_driver = mention.thing.name == "driver" and phrases.context("of_its_vehicle").match(
            at.after
        )
        if is_modifier or is_driver:
            continue
        subject = subject_of(at)
        if subject is not None and subject not in subjects:
            subjects.append(subject)
        is_oblique = _is_oblique(at) or (subject is None and _is_part(at))
        nouns.append(Noun(mention.start, mention.end, subject, is_oblique))
    for match in phrases.context("ego").finditer(text):
        if not any(n.start < match.end() and match.start() < n.end for n in nouns):
            is_possessive = match.group(0).endswith(("'s", "your"))
            lead = text[: match.start()][-20:]
            is_oblique = is_possessive or phrases.context("oblique").search(lead) is not None
            nouns.append(Noun(match.start(), match.end(), None, is_oblique))
    return sorted(nouns, key=lambda noun: noun.start), subjects


def _is_oblique(at: NounInContext) -> bool:
    """Return whether a noun phrase follows a preposition and therefore is not a subject."""
    lead = at.before[-_NEAR:]
    if (
        not phrases.context("oblique").search(lead)
        or phrases.context("for_a").search(at.before)
        or phrases.context("part_of").search(lead)
    ):
        return False
    grouped = phrases.context("quantity").search(lead)
    if grouped and grouped.group(3):
        return phrases.context("oblique").search(lead[: grouped.start()]) is not None
    return True


def _is_part(at: NounInContext) -> bool:
    lead = at.before[-40:]
    tests = (phrases.context("its").search(at.before), phrases.context("carried").search(lead))
    return any((*tests, phrases.context("lacked").search(lead), re.match("'s ", at.after)))
