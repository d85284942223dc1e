"""Writing: one or two sentences from opening, place, conditions, traffic and event."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from oodscen.llms.author.approach import approach
from oodscen.llms.author.knowledge import Condition, Hazard, Knowledge, Place, Traffic
from oodscen.prompts.describe_path import plain

Option = TypeVar("Option")

_LONG_EVENT = 17
"""Words from which on an event has a sentence of its own."""
_IDLE_TRIES = 400
"""Drafts in a row that repeat earlier texts, after which a hazard counts as exhausted."""


@dataclass(frozen=True)
class Plot:
    """What a text is going to say, before it is worded."""

    event: str
    """With its placeholder until the construction is chosen."""
    place: Place
    where: str
    """Phrase for the place."""
    condition: Condition | None = None
    weather: str = ""
    """Phrase for the condition."""
    statement: str = ""
    """Clause for the condition."""
    is_act: bool = False
    """Whether somebody does something unusual."""
    traffic: str = ""
    opening: str = ""
    detail: str = ""


class Composer:
    """Writes texts about hazards."""

    def __init__(self, knowledge: Knowledge) -> None:
        """Write with the words of a knowledge base."""
        self.knowledge = knowledge

    def text(self, hazard: Hazard, rng: np.random.Generator) -> str:
        """Write one text."""
        return next(self.texts(hazard, rng, set()))

    def texts(self, hazard: Hazard, rng: np.random.Generator, taken: set[str]) -> Iterator[str]:
        """Write texts until nothing new comes.

        Events, roads, conditions and constructions take turns, so that few texts are varied ones.

        Args:
            hazard: What they are about.
            rng: Decides everything.
            taken: Texts to avoid, without case and punctuation; what is written is added.
        """
        turns = _Turns(rng)
        idle = 0
        while idle < _IDLE_TRIES:
            plot = self._plot(hazard, rng, turns)
            built = turns.next("structure", list(_STRUCTURES))
            structure = _STRUCTURES[built if _STRUCTURES[built].suits(plot) else "two sentences"]
            event = self._located(plot, hazard, structure.names_ego, rng)
            text = structure.build(replace(plot, event=event))
            key = plain(text)
            if key in taken or not 20 <= len(text) <= 600:
                idle += 1
                continue
            idle = 0
            taken.add(key)
            yield text

    def _plot(self, hazard: Hazard, rng: np.random.Generator, turns: "_Turns") -> Plot:
        places = [p for key in hazard.places for p in self.knowledge.place_keys.get(key, ())]
        place = turns.next("place", places or list(self.knowledge.places))
        condition = None
        if hazard.conditions:
            key = turns.next("condition", list(hazard.conditions))
            condition = self.knowledge.condition_keys.get(key)
        event = turns.next("event", list(hazard.events))
        return Plot(
            event=event,
            place=place,
            where=turns.next(f"place {place.key}", list(place.phrases)),
            condition=condition,
            weather=_pick(rng, condition.phrases) if condition else "",
            statement=_pick(rng, condition.statements)
            if condition and condition.statements
            else "",
            is_act=hazard.class_name == "interactional",
            traffic=self._traffic(hazard, place, rng),
            opening=turns.next("opening", list(self.knowledge.wording.openings)),
            detail=_pick(rng, hazard.details) if hazard.details and rng.random() < 0.5 else "",
        )

    def _traffic(self, hazard: Hazard, place: Place, rng: np.random.Generator) -> str:
        if not hazard.traffic or rng.random() > 0.3:
            return ""
        fitting = [t for t in self.knowledge.traffic if _met_on(t, place)]
        return _pick(rng, _pick(rng, fitting).phrases) if fitting else ""

    def _located(
        self, plot: Plot, hazard: Hazard, names_ego: bool, rng: np.random.Generator
    ) -> str:
        """Fill in where it is; the ego is named once more where nothing else names it."""
        event = _NAMED_TWICE.sub(r"\1", plot.event)
        if "{where}" not in event:
            return event
        words = self.knowledge.wording
        named = re.search(r"\bego\b", event) is not None or "from {where}" in event
        briefly = named or (names_ego and rng.random() < 0.8)
        if rng.random() < 0.6:
            low, high = approach(hazard, plot.place).ahead
            steps = [five * 5 for five in range(1, 61) if low <= five * 5 <= high]
            distance = _pick(rng, steps) if steps else 5 * round(0.1 * (low + high))
            phrases = words.metres if briefly else words.metres_ego
            where = _pick(rng, phrases).format(distance=distance)
        else:
            where = _pick(rng, words.near if briefly else words.near_ego)
        return event.replace("{where}", where)


def _met_on(traffic: Traffic, place: Place) -> bool:
    return set(traffic.traits) <= set(place.traits)


class _Turns:
    """Shuffled decks: every option comes once before one comes again."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._decks: dict[str, list[int]] = {}

    def next(self, deck: str, options: Sequence[Option]) -> Option:
        left = self._decks.setdefault(deck, [])
        if not left:
            left += [int(index) for index in self._rng.permutation(len(options))]
        return options[left.pop()]


def _pick(rng: np.random.Generator, options: Sequence[Option]) -> Option:
    return options[int(rng.integers(len(options)))]


# ------------------------------------------------------------------ constructions

_NAMED_TWICE = re.compile(r"((?:in front|ahead) of the ego vehicle) \{where\}", re.IGNORECASE)
_ADVERBIAL = re.compile(
    r"(On|In|At|Late|By|Within|From|Behind|Without|After|Since|Towards?|Between|While|Under|Beneath|"
    r"Beyond|Although|Coming|Instead|It|Over|Across|Along|Beside|Before|Near|Once|As|With|Every|"
    r"Ahead|Around|Against|Halfway|Suddenly|Seconds|Moments|Just|Only|Where|When|Having|For)\b"
)
_PLAIN = re.compile(
    r"(An?|The|Two|Three|Four|Five|Six|Several|Some|Somebody|Someone|Another|Dozens|Thousands)\b"
)
_LASTING = re.compile(
    r"\b(is|are|was|has|have|had|stands?|lies?|sits?|blocks?|holds?|keeps?|occup\w+|remains?|waits?|"
    r"stays?|hangs?|covers?|fills?|travels?|moves|drives?|walks?|rides?|leads?)\b"
)


def _starts_plainly(plot: Plot) -> bool:
    """Tell whether the event begins with its subject."""
    if _PLAIN.match(plot.event) is not None:
        return True
    return not plot.is_act and _ADVERBIAL.match(plot.event) is None


def _is_short(plot: Plot) -> bool:
    return len(plot.event.split()) <= _LONG_EVENT and "," not in plot.event


def _happens(plot: Plot) -> bool:
    """Tell whether the event is something that occurs, so that `when` can introduce it."""
    if re.search(r"\b(when|while|as|after|before|until|because)\b", plot.event):
        return False
    return plot.is_act and _LASTING.search(" ".join(plot.event.split()[:9])) is None


def _sentence(*parts: str) -> str:
    text = " ".join(part for part in parts if part).replace(" ,", ",")
    return f"{text[0].upper()}{text[1:].rstrip('.')}."


def _inner(event: str) -> str:
    """Turn an event into a clause within a sentence that has named the ego."""
    event = _it(event)
    return event if event.startswith("Ego") else event[0].lower() + event[1:]


def _it(event: str) -> str:
    return re.sub(r"^(The ego vehicle|Ego)(?= )", "It", event)


def _inner_opening(opening: str) -> str:
    return re.sub(r"^(Ego|The ego vehicle)\b", "the ego vehicle", opening)


def _aside(plot: Plot) -> str:
    return f", {plot.traffic}" if plot.traffic else ""


def _after(plot: Plot, sentence: str) -> str:
    """Add the consequence to a single sentence."""
    return f"{sentence} {_sentence(plot.detail)}" if plot.detail else sentence


def _two_sentences(plot: Plot) -> str:
    first = _sentence(plot.opening, plot.where, plot.weather, _aside(plot))
    return f"{first} {_sentence(_it(plot.event))}"


def _weather_first(plot: Plot) -> str:
    opening = _inner_opening(plot.opening)
    first = _sentence(plot.weather, ",", opening, plot.where, _aside(plot))
    return f"{first} {_sentence(_it(plot.event))}"


def _stated(plot: Plot) -> str:
    first = _sentence(plot.statement, ", and", _inner_opening(plot.opening), plot.where)
    return f"{first} {_sentence(_it(plot.event))}"


def _joined(plot: Plot) -> str:
    first = _sentence(plot.opening, plot.where, plot.weather, ", and", _inner(plot.event))
    return _after(plot, first)


def _occurring(plot: Plot) -> str:
    first = _sentence(plot.opening, plot.where, plot.weather, "when", _inner(plot.event))
    return _after(plot, first)


def _place_first(plot: Plot) -> str:
    event = plot.event[0].lower() + plot.event[1:]
    return _after(plot, _sentence(plot.where, plot.weather, ",", event))


def _meanwhile(plot: Plot) -> str:
    opening = _inner_opening(plot.opening)
    return _after(plot, _sentence(plot.event, "while", opening, plot.where, plot.weather))


@dataclass(frozen=True)
class _Structure:
    build: Callable[[Plot], str]
    suits: Callable[[Plot], bool]
    names_ego: bool = True
    """Whether it has a part of its own about the ego."""


_STRUCTURES = {
    "two sentences": _Structure(_two_sentences, lambda plot: True),
    "weather first": _Structure(_weather_first, lambda plot: bool(plot.weather)),
    "two plain sentences": _Structure(_two_sentences, lambda plot: True),
    "weather stated": _Structure(_stated, lambda plot: bool(plot.statement) and not plot.traffic),
    "joined": _Structure(
        _joined, lambda plot: _starts_plainly(plot) and _is_short(plot) and not plot.traffic
    ),
    "occurring": _Structure(
        _occurring, lambda plot: _starts_plainly(plot) and _happens(plot) and not plot.traffic
    ),
    "place first": _Structure(
        _place_first,
        lambda plot: (
            _starts_plainly(plot)
            and re.search(r"\bego\b|{where}", plot.event) is not None
            and not plot.event.startswith(("The ego vehicle", "Ego"))
            and plot.where.startswith(("on ", "in ", "along "))
            and not plot.weather.startswith(plot.where.split()[0])
            and not plot.traffic
        ),
        names_ego=False,
    ),
    "meanwhile": _Structure(
        _meanwhile,
        lambda plot: (
            _starts_plainly(plot)
            and _is_short(plot)
            and not plot.event.startswith(("The ego vehicle", "Ego"))
            and re.search(r"\b(when|while|where|as|until|although)\b", plot.event) is None
            and not plot.traffic
        ),
    ),
}
