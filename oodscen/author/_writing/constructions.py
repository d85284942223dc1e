"""Constructions that turn place, weather, traffic and event into one to four sentences, by style."""

import re
from collections.abc import Callable
from dataclasses import dataclass

from oodscen.author._knowledge.base import Condition, RoadKind
from oodscen.author._writing.headline import headline
from oodscen.prompts._scenario.describe_path import Style

_LONG_EVENT = 17
"""Number of words above which an event becomes a separate sentence."""

KEEPS_ON = "keeps to its lane at the usual speed"
"""The ego's behaviour before anything happens, in a full account."""


@dataclass(frozen=True)
class Plot:
    """The content of a text, before it is worded."""

    event: str
    """The event, with its placeholder until the construction is chosen."""
    place: RoadKind
    where: str
    """Phrase for the place."""
    condition: Condition | None = None
    weather: str = ""
    """Phrase for the condition."""
    statement: str = ""
    """Clause for the condition."""
    is_act: bool = False
    """True if an actor does something unusual."""
    traffic: str = ""
    opening: str = ""
    detail: str = ""
    has_pronoun: bool = True
    """True if `it` may refer to the ego vehicle."""


@dataclass(frozen=True)
class Construction:
    """One way to word a plot."""

    build: Callable[[Plot], str]
    suits: Callable[[Plot], bool] = lambda plot: True
    names_ego: bool = True
    """True if it has a separate part about the ego."""
    is_apart: bool = False
    """True if the event is a separate sentence, whose parts may be reordered."""
    is_line: bool = False
    """True if it is a single line, as in a test catalogue."""


_ADVERBIAL = re.compile(
    r"(On|In|At|Late|By|Within|From|Behind|Without|After|Since|Towards?|Between|While|Under|Beneath|"
    r"Beyond|Although|Coming|Instead|It|Over|Across|Along|Beside|Before|Near|Once|As|With|Every|"
    r"Ahead|Around|Against|Halfway|Suddenly|Seconds|Moments|Just|Only|Where|When|Having|For|"
    r"Busy|Parcels|Trusting|Standing|What|Out|To|Long|Through|Amid|Inside|Nobody|Nothing|Both)\b"
)
_PLAIN = re.compile(
    r"(An?|The|Two|Three|Four|Five|Six|Several|Some|Somebody|Someone|Another|Dozens|Thousands)\b"
)
_LASTING = re.compile(
    r"\b(is|are|was|has|have|had|stands?|lies?|sits?|blocks?|holds?|keeps?|occup\w+|remains?|waits?|"
    r"stays?|hangs?|covers?|fills?|travels?|moves|drives?|walks?|rides?|leads?)\b"
)
_NOUN = re.compile(r"(?:on|along|in) (an? .+)")


def nominal(where: str) -> str:
    """Return the noun phrase of a place, such as `a rural road` for `along a rural road`, or an empty string."""
    found = _NOUN.fullmatch(where)
    return found[1] if found else ""


def standing(where: str) -> str:
    """Return the place as a static location, such as `on a coast road` for `along a coast road`."""
    return re.sub(r"^along (?=an? )", "on ", where)


def starts_plainly(plot: Plot) -> bool:
    """Return whether the event begins with its subject."""
    if _PLAIN.match(plot.event) is not None:
        return True
    return not plot.is_act and _ADVERBIAL.match(plot.event) is None


def _starts_with_ego(plot: Plot) -> bool:
    return plot.event.startswith(("The ego vehicle", "Ego"))


def _is_short(plot: Plot) -> bool:
    return len(plot.event.split()) <= _LONG_EVENT and "," not in plot.event


def _happens(plot: Plot) -> bool:
    """Return whether the event is an occurrence, so that `when` can introduce it."""
    if re.search(r"\b(when|while|as|after|before|until|because)\b", plot.event):
        return False
    return plot.is_act and _LASTING.search(" ".join(plot.event.split()[:9])) is None


def _names_ego(plot: Plot) -> bool:
    return re.search(r"\bego\b|(?<!from )\{where\}", plot.event) is not None


def _leads(plot: Plot) -> bool:
    """Return whether the place can come first, followed by the event as its clause."""
    return (
        starts_plainly(plot)
        and _names_ego(plot)
        and not _starts_with_ego(plot)
        and plot.where.startswith(("on ", "in ", "along "))
        and not plot.traffic
    )


def _introduces(plot: Plot) -> bool:
    """Return whether the event can precede the place, because it does not presuppose it."""
    event = f" {plot.event.casefold()} "
    words = " ".join(plot.place.words).split()
    return not any(f" the {word} " in event for word in words)


def _fits_weather(plot: Plot) -> bool:
    """Return whether weather can precede the place without repeating its preposition."""
    return bool(plot.weather) and plot.weather.split()[0] != standing(plot.where).split()[0]


# ------------------------------------------------------------------ parts of sentences


def _sentence(*parts: str) -> str:
    text = " ".join(part for part in parts if part).replace(" ,", ",").replace(" :", ":")
    return f"{text[0].upper()}{text[1:].rstrip('.')}."


def _it(plot: Plot) -> str:
    if not plot.has_pronoun or plot.traffic:
        return plot.event
    return re.sub(r"^(The ego vehicle|Ego)(?= )", "It", plot.event)


def _clause(event: str) -> str:
    return event if event.startswith("Ego") else event[0].lower() + event[1:]


def _at(plot: Plot) -> str:
    """Return the place as the location of something that need not move along it."""
    return standing(plot.where)


def _opening(plot: Plot) -> str:
    return re.sub(r"^(Ego|The ego vehicle)\b", "the ego vehicle", plot.opening)


def _aside(plot: Plot) -> str:
    return f", {plot.traffic}" if plot.traffic else ""


def _after(plot: Plot, text: str) -> str:
    """Append the consequence to a single sentence."""
    return f"{text} {_sentence(plot.detail)}" if plot.detail else text


# ------------------------------------------------------------------ constructions


def _two_sentences(plot: Plot) -> str:
    first = _sentence(plot.opening, plot.where, plot.weather, _aside(plot))
    return f"{first} {_sentence(_it(plot))}"


def _weather_first(plot: Plot) -> str:
    first = _sentence(plot.weather, ",", _opening(plot), plot.where, _aside(plot))
    return f"{first} {_sentence(_it(plot))}"


def _stated(plot: Plot) -> str:
    first = _sentence(plot.statement, ", and", _opening(plot), plot.where)
    return f"{first} {_sentence(_it(plot))}"


def _joined(plot: Plot) -> str:
    event = _clause(_it(plot))
    return _after(plot, _sentence(plot.opening, plot.where, plot.weather, ", and", event))


def _occurring(plot: Plot) -> str:
    event = _clause(_it(plot))
    return _after(plot, _sentence(plot.opening, plot.where, plot.weather, "when", event))


def _place_first(plot: Plot) -> str:
    return _after(plot, _sentence(_at(plot), plot.weather, ",", _clause(plot.event)))


def _place_alone(plot: Plot) -> str:
    return _after(plot, _sentence(_at(plot), ",", _clause(plot.event)))


def _weather_and_place(plot: Plot) -> str:
    return _after(plot, _sentence(plot.weather, _at(plot), ",", _clause(plot.event)))


def _stated_place(plot: Plot) -> str:
    return f"{_sentence(plot.statement)} {_sentence(_at(plot), ',', _clause(plot.event))}"


def _stated_last(plot: Plot) -> str:
    return f"{_sentence(_at(plot), ',', _clause(plot.event))} {_sentence(plot.statement)}"


def _meanwhile(plot: Plot) -> str:
    return _after(plot, _sentence(plot.event, "while", _opening(plot), plot.where, plot.weather))


def _noted(plot: Plot) -> str:
    return f"{_sentence(nominal(plot.where), plot.weather)} {_sentence(plot.event)}"


def _noted_as_stated(plot: Plot) -> str:
    place = _sentence(f"{nominal(plot.where)};", _clause(plot.statement))
    return f"{place} {_sentence(plot.event)}"


def _event_first(plot: Plot) -> str:
    return f"{_sentence(plot.event)} {_sentence(plot.opening, plot.where, plot.weather)}"


def _event_then_place(plot: Plot) -> str:
    return f"{_sentence(plot.event)} {_sentence('it happens', plot.where, plot.weather)}"


def _doing(plot: Plot) -> str:
    rest = re.sub(r"^(The ego vehicle|Ego) ", "the ego vehicle ", plot.event)
    return _after(plot, _sentence("driving", plot.where, plot.weather, ",", rest))


def _line(plot: Plot) -> str:
    noun = re.sub(r"^(?:an?|the) ", "", nominal(plot.where)) or plot.where
    event = re.sub(r"(?<=\d) metres\b", " m", plot.event)
    return _sentence(noun, plot.weather, ":", headline(_clause(event)))


def _account(plot: Plot) -> str:
    first = _sentence(plot.opening, plot.where, _aside(plot))
    if plot.has_pronoun:
        subject = "The ego vehicle" if plot.traffic else "It"
        first += f" {subject} {KEEPS_ON}."
    second = _sentence(plot.statement) if plot.statement else ""
    last = _sentence(plot.detail) if plot.detail else ""
    return " ".join(part for part in (first, second, _sentence(_it(plot)), last) if part)


_TWO = Construction(_two_sentences, is_apart=True)
_WEATHER_FIRST = Construction(_weather_first, lambda plot: bool(plot.weather), is_apart=True)
_STATED = Construction(
    _stated, lambda plot: bool(plot.statement) and not plot.traffic, is_apart=True
)
_JOINED = Construction(
    _joined, lambda plot: starts_plainly(plot) and _is_short(plot) and not plot.traffic
)
_OCCURRING = Construction(
    _occurring, lambda plot: starts_plainly(plot) and _happens(plot) and not plot.traffic
)
_MEANWHILE = Construction(
    _meanwhile,
    lambda plot: (
        starts_plainly(plot)
        and _is_short(plot)
        and not _starts_with_ego(plot)
        and re.search(r"\b(when|while|where|as|until|although)\b", plot.event) is None
        and not plot.traffic
        and _introduces(plot)
    ),
)
_PLACE_FIRST = Construction(
    _place_first,
    lambda plot: _leads(plot) and (not plot.weather or _fits_weather(plot)),
    names_ego=False,
)
_PLACE_ALONE = Construction(_place_alone, _leads, names_ego=False)
_WEATHER_AND_PLACE = Construction(
    _weather_and_place,
    lambda plot: _leads(plot) and _fits_weather(plot) and "," not in plot.weather,
    names_ego=False,
)
_STATED_PLACE = Construction(
    _stated_place, lambda plot: _leads(plot) and bool(plot.statement), names_ego=False
)
_STATED_LAST = Construction(
    _stated_last, lambda plot: _leads(plot) and bool(plot.statement), names_ego=False
)


def _can_be_noted(plot: Plot) -> bool:
    return bool(nominal(plot.where)) and _names_ego(plot) and not plot.traffic


_NOTED = Construction(
    _noted,
    lambda plot: _can_be_noted(plot) and bool(plot.weather),
    names_ego=False,
    is_apart=True,
)
_NOTED_AS_STATED = Construction(
    _noted_as_stated,
    lambda plot: _can_be_noted(plot) and bool(plot.statement),
    names_ego=False,
    is_apart=True,
)
_EVENT_FIRST = Construction(
    _event_first,
    lambda plot: not plot.traffic and "ego vehicle" not in plot.event and _introduces(plot),
    is_apart=True,
)
_EVENT_THEN_PLACE = Construction(
    _event_then_place,
    lambda plot: (
        plot.is_act
        and _names_ego(plot)
        and not plot.traffic
        and plot.where.startswith(("on ", "in "))
        and _introduces(plot)
    ),
    names_ego=False,
    is_apart=True,
)
_DOING = Construction(_doing, lambda plot: _starts_with_ego(plot) and not plot.traffic)
_LINE = Construction(_line, names_ego=False, is_line=True)
_ACCOUNT = Construction(_account, is_apart=True)

_WITHOUT_EGO = (
    _PLACE_FIRST,
    _PLACE_FIRST,
    _PLACE_FIRST,
    _PLACE_ALONE,
    _PLACE_ALONE,
    _WEATHER_AND_PLACE,
    _WEATHER_AND_PLACE,
    _WEATHER_AND_PLACE,
    _STATED_PLACE,
    _STATED_LAST,
    _STATED_LAST,
    _NOTED,
    _NOTED,
    _NOTED_AS_STATED,
    _NOTED_AS_STATED,
    _EVENT_THEN_PLACE,
)
"""Constructions of place and event that say nothing about the ego beyond the event."""

FALLBACK = _TWO
"""The construction that suits every plot."""

CONSTRUCTIONS: dict[Style, tuple[Construction, ...]] = {
    "natural": (
        *_WITHOUT_EGO,
        *_WITHOUT_EGO,
        _EVENT_FIRST,
        _DOING,
        _DOING,
        _OCCURRING,
        _MEANWHILE,
        _JOINED,
        _WEATHER_FIRST,
        _STATED,
    ),
    "paper": (_TWO, _TWO, _WEATHER_FIRST, _STATED, _JOINED, _OCCURRING, _PLACE_FIRST, _MEANWHILE),
    "terse": (_LINE,),
    "verbose": (_ACCOUNT,),
    "first-person": (
        _PLACE_FIRST,
        _WEATHER_AND_PLACE,
        _STATED,
        _EVENT_FIRST,
        _OCCURRING,
        _MEANWHILE,
        _JOINED,
        _TWO,
        _WEATHER_FIRST,
        _STATED_PLACE,
    ),
}
"""Constructions that take turns in each style; one that does not suit a plot yields its turn to the
next that does."""
