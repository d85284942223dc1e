"""Extraction of claims: the statements of a text about a scene, from its words alone."""

import re
from bisect import bisect_right
from collections.abc import Iterator

from oodscen.author._reading import phrases
from oodscen.author._reading.clauses import (
    Clause,
    Noun,
    Subject,
    clauses_of,
    last_end,
)
from oodscen.author._reading.numbers import number_at
from oodscen.author._reading.phrases import Pattern
from oodscen.author._reading.stationarity import usual_motion
from oodscen.author._reading.subjects import nouns_of
from oodscen.author._reading.unreal import is_unreal
from oodscen.claims._things import mentions
from oodscen.data._claim import Claim, Kind

_STRONGER = {
    "rain": ("heavy_rain", "light_rain"),
    "snow": ("heavy_snow", "light_snow"),
    "fog": ("thick_fog",),
    "mist": ("fog", "thick_fog"),
    "wet_road": ("rain", "heavy_rain", "light_rain"),
    "junction": ("t_junction",),
    "day": ("night", "twilight"),
    "twilight": ("night",),
    "moving": ("crossing", "oncoming", "reversing", "slow", "into_lane", "from_left", "from_right"),
    "ahead": ("behind",),
    "red": ("all_on",),
    "green": ("all_on",),
}
"""Values that are not claimed beside a more specific value, or one that contradicts them and is more certain."""
_WILFUL = frozenset(
    {"oncoming", "moving", "slow", "reversing", "crossing", "from_left", "from_right"}
)
_CROSSES = frozenset({"crossing", "into_lane", "from_left", "from_right"})
_SIDES = frozenset({"from_left", "from_right"})
_INVERTED = re.compile(
    r"(?:stands?|lies?|lay|sits?|gapes?|comes|runs|stood|sat) (?:an?|the|some|two|several) (?:[\w-]+ ){0,2}",
    re.IGNORECASE,
)
_DETERMINERS = frozenset("a an the its his her their two three some several no another".split())
_QUOTED = 200
"""Largest length of a quote, in characters."""
_APPOSED = 24
"""Largest distance between a noun and a relative clause about it, in characters."""


def read_claims(text: str) -> tuple[Claim, ...]:
    """Return the claims of a text: settings first, then thing by thing."""
    return _ClaimReading(" ".join(text.replace("\u2019", "'").split())).claims()


class _ClaimReading:
    def __init__(self, text: str) -> None:
        self.text = text
        self.found: dict[tuple[Kind, str, str], Claim] = {}
        self.clauses = clauses_of(text)
        self.nouns, self.subjects = nouns_of(text)
        self.mentioned = list(mentions(text))
        self.starts = [clause.start for clause in self.clauses]
        for noun in self.nouns:
            self.clauses[self._clause_at(noun.start)].nouns.append(noun)

    def _clause_at(self, position: int) -> int:
        """Return the number of the clause with a position."""
        return bisect_right(self.starts, position) - 1

    def claims(self) -> tuple[Claim, ...]:
        self._settings()
        for subject in self.subjects:
            if not subject.is_faint:
                self._present(subject)
        for pattern in phrases.statements("predicate"):
            for match in pattern.regex.finditer(self.text):
                self._predicate(pattern, match)
        for noun in self.nouns:
            if noun.subject is not None:
                self._leading(noun, noun.subject)
        for match in phrases.context("blocked_by").finditer(self.text):
            after = next((n for n in self.nouns if 0 <= n.start - match.end() <= 30), None)
            if after is not None and after.subject is not None:
                self._add("place", "in_lane", after.subject.name, *match.span())
        self._signals()
        told: dict[str, set[str]] = {}
        for kind, value, name in self.found:
            if kind in ("motion", "place"):
                told.setdefault(name, set()).add(f"{kind} {value}")
        for subject in self.subjects:
            motion = usual_motion(self.text, subject, self.nouns, told.get(subject.name, set()))
            if motion is not None:
                self._present(subject)
                mention = subject.mention
                self._add("motion", motion, subject.name, mention.start, mention.end)
        return tuple(self._kept())

    def _present(self, subject: Subject) -> None:
        start, end, thing = subject.mention.start, subject.mention.end, subject.mention.thing
        self._add("thing", "present", subject.name, start, end)
        if subject.count > 1 and not (thing.many or thing.map or thing.vague):
            self._add("count", str(subject.count), subject.name, start, end)

    # -------------------------------------------------------------- predicates

    def _predicate(self, pattern: Pattern, found: re.Match[str]) -> None:
        start = found.end() - len(found.group(0).lstrip(" "))
        end = found.end()
        is_verb = pattern.kind == "motion"
        value = self._value(pattern, found)
        if value is None or self._is_denied(pattern, start, end):
            return
        is_of_it = pattern.kind == "distance" and self.text.startswith(" of it", end)
        if pattern.value in _SIDES:
            subject = self._comer(start, end)
        else:
            subject = self._owner(start, end, is_verb=is_verb)
        if subject is None or (subject.is_faint and not is_verb and not _adjoins(subject, start)):
            if not is_of_it:
                self._unowned(pattern, found, value)
            return
        if is_of_it and self._is_among_others(start, subject, whole=True):
            return
        if not self._may_hold(pattern, found.group(0), start, subject):
            return
        doer = self._on_foot(subject, start) if is_verb else subject
        if doer is not None:
            if doer.is_faint:
                self._present(doer)
            self._add(pattern.kind, value, doer.name, start, end)

    def _value(self, pattern: Pattern, found: re.Match[str]) -> str | None:
        """Return what a match claims; `None` if its number cannot be read."""
        if pattern.value:
            return pattern.value
        number = number_at(self.text, *found.span(1))
        return None if number is None else str(number)

    def _is_denied(self, pattern: Pattern, start: int, end: int) -> bool:
        """Return whether the words around a predicate take it back, or make it a modifier."""
        lead, value = self.text[:start][-40:], pattern.value
        if pattern.kind == "motion":
            is_over = value not in ("stationary", "slow") and phrases.context("perfect").search(
                lead
            )
            is_weather = value not in _SIDES and phrases.context("weather_does").search(lead)
            is_denied = phrases.context("forbidden").search(lead) or is_weather or is_over
            return bool(is_denied) or self._leads(end) or self._is_within(start)
        if value == "off":
            return False
        if pattern.kind == "state" and phrases.context("unshown").search(lead):
            return True
        is_left = value == "clear_of_lane" and phrases.context("left").search(lead)
        return bool(phrases.context("negated").search(lead) or is_left)

    def _may_hold(self, pattern: Pattern, words: str, start: int, subject: Subject) -> bool:
        """Return whether a predicate can be about a thing at all."""
        thing, value = subject.mention.thing, pattern.value
        if pattern.kind == "state":
            return thing.group in ("vehicle", "signal")
        if value == "behind":
            is_clear = thing.group == "vehicle" and not self._is_among_others(start, subject)
            return is_clear or "ego" in words.casefold()
        if pattern.kind != "motion":
            return True
        if value == "stationary":
            return not subject.is_agent
        if value == "reversing" and thing.group != "vehicle" and not subject.is_faint:
            return False
        if thing.name == "car door" and value == "into_lane":
            return False
        return not (thing.name in phrases.things("inert") and value in _WILFUL)

    def _on_foot(self, subject: Subject, start: int) -> Subject | None:
        """Return the subject who walks, if a verb is for people on foot; `None` if no subject can walk.

        The subject of a vehicle that "walks" is its driver; an unnamed subject is a pedestrian.
        """
        thing = subject.mention.thing
        is_vehicle = thing.group == "vehicle" and thing.name not in phrases.things("cycles")
        if is_vehicle and phrases.context("strides").match(self.text, start):
            drivers = [one for one in self.subjects if one.mention.thing.name == "driver"]
            if not drivers:
                return None
            subject = self._walker(drivers[-1])
        is_walker = subject.is_faint and phrases.context("on_foot").match(self.text, start)
        return self._walker(subject) if is_walker else subject

    def _walker(self, subject: Subject) -> Subject:
        """Return a subject for an unnamed pedestrian, unless the text names people."""
        if any(one.mention.thing.group == "person" for one in self.subjects):
            return subject
        mention = next(mentions("person"))
        start, end = subject.mention.start, subject.mention.end
        walker = Subject("person", mention._replace(start=start, end=end))
        self.subjects.append(walker)
        self._present(walker)
        return walker

    def _comer(self, start: int, end: int) -> Subject | None:
        """Return the thing that comes from a side; if the side opens a clause, the thing after it."""
        subject = self._owner(start, end, is_verb=True)
        clause = self.clauses[self._clause_at(start)]
        if any(noun.end <= start and not noun.is_oblique for noun in clause.nouns):
            return subject
        after = [n for n in clause.nouns if n.start >= end and not n.is_oblique]
        return after[0].subject if after else subject

    def _unowned(self, pattern: Pattern, found: re.Match[str], value: str) -> None:
        """Claim a place or distance for a subject that the text leaves unclear."""
        sides = ("reversing", "from_left", "from_right")
        if pattern.kind != "distance" and pattern.value not in ("ahead", "in_lane", *sides):
            return
        start, end = found.span()
        at = self._clause_at(start)
        clause = self.clauses[at]
        words = self.text[clause.start : clause.end]
        lies = pattern.kind == "place" and phrases.context("lies").search(words)
        if pattern.value in sides and clause.nouns:
            return
        is_lane = pattern.value == "in_lane"
        heads = [noun for noun in clause.nouns if noun.start < start]
        if not heads and at and self.clauses[at - 1].sentence == clause.sentence:
            heads = self.clauses[at - 1].nouns
        if is_lane and any(noun.subject is None and not noun.is_oblique for noun in heads):
            return
        named = [
            noun.subject
            for one in self.clauses
            if one.sentence == clause.sentence
            for noun in one.nouns
            if noun.subject is not None
        ]
        if phrases.context("roadway").search(words) or not (lies or named):
            return
        alone = {one.name: one for one in named if not one.is_faint}
        if len(alone) == 1:
            (subject,) = alone.values()
            if not self._is_elsewhere(subject):
                self._add(pattern.kind, value, subject.name, start, end)
                return
        if pattern.value in sides:
            return
        self._add("thing", "present", "something", start, end)
        self._add(pattern.kind, value, "something", start, end)

    def _is_elsewhere(self, subject: Subject) -> bool:
        """Return whether the text puts the subject somewhere other than the ego's lane ahead."""
        places = ("behind", "oncoming_lane", "left_lane", "right_lane", "clear_of_lane")
        return any(("place", value, subject.name) in self.found for value in places)

    def _is_within(self, position: int) -> bool:
        return any(n.subject and n.start <= position < n.end for n in self.nouns)

    def _is_among_others(self, position: int, subject: Subject, *, whole: bool = False) -> bool:
        """Return whether the sentence, or the whole text, has named another thing to which `it` may refer."""
        begin = 0 if whole else last_end(phrases.context("sentence"), self.text[:position])
        return any(
            noun.subject not in (None, subject)
            for noun in self.nouns
            if begin <= noun.start < position
        )

    def _leads(self, end: int) -> bool:
        """Return whether a word is an adjective of the noun that immediately follows."""
        following = next((noun for noun in self.nouns if noun.start >= end), None)
        if following is None or following.subject is None or following.subject.is_faint:
            return False
        between = self.text[end : following.start]
        return re.fullmatch(r" (?:(?!(?:an?|the|its)\b)[\w-]+ )?", between) is not None

    def _owner(self, start: int, end: int, *, is_verb: bool) -> Subject | None:
        """Return the thing that a predicate describes; `None` for the ego or if it is unclear."""
        at = self._clause_at(start)
        clause = self.clauses[at]
        before = [noun for noun in clause.nouns if noun.end <= start]
        heads = [noun for noun in before if not noun.is_oblique]
        if heads and clause.is_relative:
            opening = self.text[clause.start : heads[0].start].split()
            is_verb_first = len(opening) > 1 and opening[1].casefold() not in _DETERMINERS
            antecedent = self._last_before(clause)
            tail = self.text[heads[0].end : start].split()
            is_past = len(opening) == 1 and self._is_ego(heads[0]) and 0 < len(tail) < 6
            if (is_verb_first or (is_past and "and" not in tail)) and antecedent is not None:
                return antecedent
        if before and start - before[-1].end <= 1 and self._may_govern(before[-1]):
            return self._meant(before[-1]).subject
        if heads:
            head = self._meant(heads[0])
            if head.subject is None and self._is_ego(head) and not is_verb and len(before) > 1:
                rest = [noun for noun in before if noun.start > head.start]
                return rest[-1].subject if rest else None
            return head.subject
        if not is_verb:
            after = [n for n in clause.nouns if n.start >= end and not n.is_oblique]
            if after and not before:
                return after[0].subject
        if not before and clause.is_relative:
            return self._last_before(clause)
        if is_verb and not clause.is_relative:
            follower = next((n for n in clause.nouns if n.start >= end), None)
            between = self.text[start : follower.start] if follower is not None else ""
            if follower is not None and follower.subject and _INVERTED.fullmatch(between):
                return follower.subject
        earlier = self._subject_before(at)
        if earlier is not None:
            return earlier.subject
        return before[0].subject if before and is_verb else None

    def _meant(self, noun: Noun) -> Noun:
        """Return the referent of a pronoun: the last thing that its sentence named."""
        word = self.text[noun.start : noun.end].casefold()
        if word in ("he", "she"):
            people = [
                one
                for one in self.nouns
                if one.end <= noun.start
                and one.subject
                and one.subject.mention.thing.group == "person"
            ]
            return people[-1] if people else noun
        if word not in ("it", "they"):
            return noun
        earlier = [
            one
            for one in self.nouns
            if one.end <= noun.start and (one.subject is not None or not one.is_oblique)
        ]
        if not earlier or earlier[-1].subject is None:
            return noun
        between = self.text[earlier[-1].end : noun.start]
        return noun if phrases.context("sentence").search(between) else earlier[-1]

    def _is_ego(self, noun: Noun) -> bool:
        words = self.text[noun.start : noun.end].casefold()
        return words in ("it", "you") or "ego" in words

    def _may_govern(self, noun: Noun) -> bool:
        """Return whether the words right after a noun phrase can describe it."""
        is_possessive = self.text[noun.end - 2 : noun.end] == "'s"
        is_possessive = is_possessive or self.text.startswith("'", noun.end)
        return not is_possessive and (noun.subject is not None or not noun.is_oblique)

    def _last_before(self, clause: Clause) -> Subject | None:
        """Return the referent of a relative clause: the noun phrase right before it."""
        earlier = [noun for noun in self.nouns if noun.end <= clause.start]
        if not earlier or clause.start - earlier[-1].end > _APPOSED:
            return None
        between = self.text[earlier[-1].end : clause.start]
        return None if phrases.context("sentence").search(between) else earlier[-1].subject

    def _subject_before(self, at: int) -> Noun | None:
        """Return the subject of the nearest earlier clause of the same sentence."""
        for clause in reversed(self.clauses[:at]):
            if clause.sentence != self.clauses[at].sentence:
                return None
            heads = [noun for noun in clause.nouns if not noun.is_oblique]
            heads = heads or [n for n in clause.nouns if n.subject is not None]
            heads = heads or clause.nouns
            if all(noun.subject is not None and noun.subject.is_faint for noun in heads):
                heads = [noun for noun in heads if not noun.is_oblique]
            if heads:
                return heads[0]
        return None

    def _leading(self, noun: Noun, subject: Subject) -> None:
        """Add the claims of adjectives right before a noun."""
        lead = self.text[max(0, noun.start - 40) : noun.start]
        if re.match(r"[\w-]", self.text[noun.start - len(lead) - 1 : noun.start - len(lead)]):
            lead = re.sub(r"^[\w-]+", "", lead)
        words = re.search(r"(?:[\w-]+,?\s+){1,4}$", lead)
        phrase = f"{words.group(0) if words else ''}{self.text[noun.start : noun.end]}"
        shift = noun.end - len(phrase)
        for pattern in phrases.statements("lead"):
            for match in pattern.regex.finditer(phrase):
                if match.end() > noun.start - shift:
                    continue
                between = phrase[match.end() : len(phrase) - (noun.end - noun.start)]
                if re.search(r"\b(?:the|an?|of|in|on|by|with|from|and|to|its)\b", between):
                    continue
                if subject.is_faint and (subject.mention.thing.vague or "," in between):
                    continue
                self._present(subject)
                start, end = match.start() + shift, match.end() + shift
                self._add(pattern.kind, pattern.value, subject.name, start, end)

    def _signals(self) -> None:
        signals = [s for s in self.subjects if s.mention.thing.name == "traffic light"]
        for pattern in phrases.statements("signal") if signals else ():
            for match in pattern.regex.finditer(self.text):
                self._add(pattern.kind, pattern.value, signals[0].name, *match.span())

    # -------------------------------------------------------------- settings

    def _settings(self) -> None:
        unreal: list[tuple[Kind, int, int]] = []
        for pattern in phrases.statements("setting"):
            for match in pattern.regex.finditer(self.text):
                kind, start, end = pattern.kind, *match.span()
                is_within = any(
                    kind == other and first <= start and end <= last
                    for other, first, last in unreal
                )
                if is_within or is_unreal(kind, match, self.mentioned):
                    unreal.append((kind, start, end))
                    continue
                value = self._value(pattern, match)
                if value is None:
                    continue
                self._add(pattern.kind, value, "", *match.span())
                if pattern.kind == "own_lanes" and re.search("each|either|per", match.group(0)):
                    self._add("road", "two_way", "", *match.span())

    # -------------------------------------------------------------- what is kept

    def _add(self, kind: Kind, value: str, subject: str, start: int, end: int) -> None:
        key = (kind, value, subject)
        if key not in self.found:
            quote = self.text[start:end]
            if len(quote) > _QUOTED:
                quote = quote[: _QUOTED + 1].rpartition(" ")[0]
            self.found[key] = Claim(kind=kind, value=value, subject=subject, quote=quote)

    def _kept(self) -> Iterator[Claim]:
        told = {(claim.subject, claim.value) for claim in self.found.values()}
        moving = {subject for subject, value in told if value in _CROSSES}
        present = {subject for kind, _, subject in self.found if kind == "thing"}
        for claim in self.found.values():
            if claim.subject and claim.subject not in present:
                continue
            stronger = _STRONGER.get(claim.value, ())
            if any((claim.subject, value) in told for value in stronger):
                continue
            move = self.found.get(("motion", "moving", claim.subject))
            leaves = move is not None and phrases.context("leaves").match(move.quote) is not None
            if claim.value == "clear_of_lane" and (claim.subject in moving or leaves):
                continue
            if claim.value == "clear_of_lane" and (claim.subject, "in_lane") in told:
                continue
            yield claim


def _adjoins(subject: Subject, start: int) -> bool:
    return subject.mention.thing.name == "driver" and 0 <= start - subject.mention.end <= 1
