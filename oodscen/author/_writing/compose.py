"""Composition of texts from opening, place, conditions, traffic and event."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np

from oodscen._words.text import folded_words
from oodscen.author._knowledge.base import BackgroundTraffic, HazardKind, Knowledge, RoadKind
from oodscen.author._reading.ego_naming import Name, with_ego_named
from oodscen.author._settings import Scope, every_setting
from oodscen.author._staging.aside import ASIDE_SHARE, event_aside, may_be_aside
from oodscen.author._staging.decision_distances import approach
from oodscen.author._writing.agreement import Agreement, PlaceAndTime
from oodscen.author._writing.constructions import (
    CONSTRUCTIONS,
    FALLBACK,
    Construction,
    Plot,
    nominal,
)
from oodscen.author._writing.headline import headline
from oodscen.prompts._scenario.describe_path import Style

Option = TypeVar("Option")

_IDLE_TRIES = 400
"""Number of consecutive repeated drafts after which a hazard counts as exhausted."""
_BRIEF_OPENING = "The ego vehicle is"
"""Short opening for places that need no more: `on a country road`."""


class _Register(NamedTuple):
    """Habits of a style: names of the ego that take turns, and shares of the texts with something more."""

    names: tuple[Name, ...]
    traffic: float
    detail: float
    brief: float
    """Share with the short opening."""


_NAMES: tuple[Name, ...] = (*6 * ("ego",), "the ego vehicle", "the ego vehicle", "the ego car")
_REGISTERS: dict[Style, _Register] = {
    "natural": _Register(_NAMES, traffic=0.12, detail=0.2, brief=0.75),
    "paper": _Register(("ego", "the ego vehicle"), traffic=0.3, detail=0.5, brief=0.0),
    "terse": _Register(("ego",), traffic=0.0, detail=0.0, brief=0.0),
    "verbose": _Register(
        ("ego", "the ego vehicle", "the ego vehicle"), traffic=0.7, detail=1.0, brief=0.0
    ),
    "first-person": _Register(("I",), traffic=0.1, detail=0.3, brief=0.4),
}
_PREPOSED = 0.3
"""Share of the separate event sentences that begin with the distance."""
_INVERTED = 0.35
"""Share of the separate event sentences that end with the subject, if the event permits it."""
_TERSE_EVENT, _TERSE_EVENTS = 10, 3
"""Largest number of words of an event in a terse text, and the number of shortest events to use if too few fit."""
_TERSE_WHERE = ("{distance} m ahead", "ahead", "just ahead", "{distance} m ahead")
"""Phrases for distances in a terse text."""


class Composer:
    """Writes texts about hazards."""

    def __init__(self, knowledge: Knowledge) -> None:
        self.knowledge = knowledge
        self._agreement = Agreement(knowledge)

    def text(self, hazard: HazardKind, rng: np.random.Generator, style: Style = "natural") -> str:
        """Return one text."""
        return next(self.texts(hazard, rng, set(), style))

    def texts(
        self,
        hazard: HazardKind,
        rng: np.random.Generator,
        taken: set[str],
        style: Style = "natural",
        scope: Scope | None = None,
    ) -> Iterator[str]:
        """Yield texts until no new ones can be found, and add them to `taken`, without case and punctuation.

        Events, roads, conditions and constructions take turns, so that even a few texts vary. The settings are those
        of the scope, or all that suit the hazard.
        """
        scope = scope or every_setting(hazard, self.knowledge)
        turns = _Turns(rng)
        # A later question of a path begins with the drafts of the earlier ones.
        idle, most_idle = 0, _IDLE_TRIES + len(taken)
        while idle < most_idle:
            plot = self._plot(hazard, rng, turns, style, scope)
            options = CONSTRUCTIONS[style]
            suits = [option.suits(plot) for option in options]
            construction = turns.first("construction", options, suits) or FALLBACK
            event = self._located(plot, hazard, construction, rng)
            text = construction.build(replace(plot, event=event))
            text = with_ego_named(text, turns.next("name", _REGISTERS[style].names))
            key = folded_words(text)
            if key in taken or not 20 <= len(text) <= 600:
                idle += 1
                continue
            idle = 0
            taken.add(key)
            yield text

    def _plot(
        self,
        hazard: HazardKind,
        rng: np.random.Generator,
        turns: "_Turns",
        style: Style,
        scope: Scope,
    ) -> Plot:
        place = turns.next("place", scope.places or self.knowledge.places)
        condition = None
        if scope.conditions:
            key = turns.next("condition", scope.conditions)
            condition = self.knowledge.condition_keys.get(key)
        phrases = list(condition.phrases) if condition else []
        statements = condition.statements if condition else ()
        setting = PlaceAndTime(place=place.key, conditions=(condition.key,) if condition else ())
        wheres = list(place.phrases)
        events = list(hazard.events)
        if style == "terse":
            wheres = _shortest([phrase for phrase in wheres if nominal(phrase)] or wheres)
            phrases = _shortest(phrases, 0)
            events = self._short(hazard, setting)
        fit = [self._agreement.suits(event, setting) for event in events]
        event = turns.first(f"event {len(events)}", events, fit) or events[0]
        if may_be_aside(hazard) and rng.random() < ASIDE_SHARE:
            event = event_aside(event) or event
        details = self._agreement.suiting(hazard.details, setting)
        opening = turns.next("opening", self.knowledge.wording.openings)
        named_place = f"place {place.key} {len(wheres)}"
        where = turns.next(named_place, wheres)
        if where.startswith(("on ", "in ", "inside ")) and rng.random() < _REGISTERS[style].brief:
            opening = _BRIEF_OPENING
        return Plot(
            event=event,
            place=place,
            where=where,
            condition=condition,
            weather=turns.next(f"weather {condition.key}", phrases) if condition else "",
            statement=turns.next(f"stated {condition.key}", statements)
            if condition and statements
            else "",
            is_act=hazard.class_name == "interactional",
            traffic=self._traffic(hazard, event, place, rng, _REGISTERS[style].traffic, scope),
            opening=opening,
            detail=_pick(rng, details)
            if details and rng.random() < _REGISTERS[style].detail
            else "",
            has_pronoun=style != "first-person",
        )

    def _short(self, hazard: HazardKind, setting: PlaceAndTime) -> list[str]:
        """Return the short events for a terse text, or the shortest few if there are not enough."""
        suiting = self._agreement.suiting(hazard.events, setting) or list(hazard.events)
        suiting.sort(key=lambda event: len(headline(event).split()))
        short = [event for event in suiting if len(headline(event).split()) <= _TERSE_EVENT]
        return short if len(short) >= _TERSE_EVENTS else suiting[:_TERSE_EVENTS]

    def _traffic(
        self,
        hazard: HazardKind,
        event: str,
        place: RoadKind,
        rng: np.random.Generator,
        share: float,
        scope: Scope,
    ) -> str:
        if not hazard.traffic or rng.random() > share:
            return ""
        fitting = [
            traffic
            for traffic in scope.traffic
            if _is_met_on(traffic, place)
            and self._agreement.suits(event, PlaceAndTime(traffic=traffic.key))
        ]
        return _pick(rng, _pick(rng, fitting).phrases) if fitting else ""

    def _located(
        self, plot: Plot, hazard: HazardKind, construction: Construction, rng: np.random.Generator
    ) -> str:
        """Fill in the location; the ego is named there if nothing else in the text names it."""
        event = _NAMED_TWICE.sub(r"\1", plot.event)
        if "{where}" not in event:
            return event
        words = self.knowledge.wording
        is_named = re.search(r"\bego\b", event) is not None or "from {where}" in event
        is_brief = is_named or (construction.names_ego and rng.random() < 0.8)
        if construction.is_line:
            lines = _TERSE_WHERE[:1] if "from {where}" in event else _TERSE_WHERE
            low, high = approach(hazard, plot.place).ahead
            distance = 5 * round(rng.uniform(low, high) / 5.0)
            return event.replace("{where}", _pick(rng, lines).format(distance=distance))
        if rng.random() < 0.6:
            low, high = approach(hazard, plot.place).ahead
            steps = [metres for metres in range(5, 301, 5) if low <= metres <= high]
            distance = _pick(rng, steps) if steps else 5 * round(0.1 * (low + high))
            phrases = list(words.metres if is_brief else words.metres_ego)
            if "from {where}" in event:
                phrases = [phrase for phrase in phrases if phrase.endswith(" ahead")]
            if " road " in f"{event} ":
                phrases = [phrase for phrase in phrases if not phrase.endswith(" road")]
            where = _pick(rng, phrases).format(distance=distance)
        elif "ego vehicle {where}" in event:
            where = _pick(rng, [near for near in words.near if " distance " in near] or words.near)
        else:
            where = _pick(rng, words.near if is_brief else words.near_ego)
        return _ordered(event, where, construction, rng)


def _ordered(event: str, where: str, construction: Construction, rng: np.random.Generator) -> str:
    """Fill in the location, in its place or at the beginning."""
    if construction.is_apart:
        match = _LYING.fullmatch(event)
        if match is not None and rng.random() < _INVERTED:
            subject = match["subject"][0].lower() + match["subject"][1:]
            start = match["lane"][0].upper() + match["lane"][1:]
            return f"{start} {where} {match['verb']} {subject}{match['rest']}"
        fits = _PREPOSABLE.search(event) is not None and not _BOUND.search(event)
        if fits and rng.random() < _PREPOSED:
            rest = " ".join(event.replace("{where}", "").split()).replace(" ,", ",")
            start = f"About {where}" if where[0].isdigit() else where[0].upper() + where[1:]
            return f"{start}, {rest[0].lower()}{rest[1:]}"
    return event.replace("{where}", where)


_NAMED_TWICE = re.compile(r"((?:in front|ahead) of the ego vehicle) \{where\}", re.IGNORECASE)
_LYING = re.compile(
    r"(?P<subject>(?:An?|Several|Two|Some) (?:(?!\b(?<!that )(?:has|have|is|are|and)\b)[^,])+?) (?P<verb>lies|lie|stands?|sits?|stretch(?:es)?|gapes|blazes) "
    r"(?P<lane>(?:right |upright )?(?:in|across|over) (?:the middle of )?(?:the ego's lane|the path of the ego vehicle)) "
    r"\{where\}(?P<rest>(?:,.*)?)"
)
_BOUND = re.compile(r"from \{where\}|, \{where\}(?:,|$)")
_PREPOSABLE = re.compile(
    r"^(?:An?|The|Two|Three|Several|Some|Somebody|Someone|[A-Z][a-z]+s)\b.*\{where\}"
)


def _shortest(phrases: Sequence[str], more: int = 1) -> list[str]:
    """Return the phrases with at most `more` words more than the shortest."""
    least = min((len(phrase.split()) for phrase in phrases), default=0)
    return [phrase for phrase in phrases if len(phrase.split()) <= least + more]


def _is_met_on(traffic: BackgroundTraffic, place: RoadKind) -> bool:
    return set(traffic.traits) <= set(place.traits)


class _Turns:
    """Shuffled decks: every option is used once before any is repeated."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._decks: dict[str, list[int]] = {}

    def next(self, deck: str, options: Sequence[Option]) -> Option:
        """Return the next option of a deck."""
        return options[self._deck(deck, len(options)).pop()]

    def first(self, deck: str, options: Sequence[Option], suits: Sequence[bool]) -> Option | None:
        """Return the next suitable option; skipped options keep their turn."""
        for is_fresh in (False, True):
            indices = self._deck(deck, len(options), is_fresh=is_fresh)
            for position in reversed(range(len(indices))):
                if suits[indices[position]]:
                    return options[indices.pop(position)]
        return None

    def _deck(self, deck: str, size: int, *, is_fresh: bool = False) -> list[int]:
        """Return the indices left in a deck; an empty one, or one that is to be fresh, is shuffled again."""
        indices = self._decks.setdefault(deck, [])
        if is_fresh or not indices:
            indices[:] = [int(index) for index in self._rng.permutation(size)]
        return indices


def _pick(rng: np.random.Generator, options: Sequence[Option]) -> Option:
    return options[int(rng.integers(len(options)))]
