"""Constructions that turn place, weather, traffic and event into one to four sentences, by style."""

import re
from collections.abc import Callable
from dataclasses import dataclass

from oodscen.author._knowledge.base import Conditions, RoadKind
from oodscen.author._writing.headline import headline
from oodscen.prompts._scenario.describe_path import Style

_LONG_EVENT = 17
"""Number of words above which an event becomes a separate sentence."""

KEEPS_ON = "keeps to its lane at the usual speed"
"""The ego's behaviour before anything happens, in a full account."""


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
    match = _NOUN.fullmatch(where)
    return match[1] if match else ""


def standing(where: str) -> str:
    """Return the place as a static location, such as `on a coast road` for `along a coast road`."""
    return re.sub(r"^along (?=an? )", "on ", where)


@dataclass(frozen=True)
class Plot:
    """The content of a text, before it is worded."""

    event: str
    """The event, with its placeholder until the construction is chosen."""
    place: RoadKind
    where: str
    """Phrase for the place."""
    condition: Conditions | None = None
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

    @property
    def at(self) -> str:
        """The place as the location of something that need not move along it."""
        return standing(self.where)

    @property
    def noun(self) -> str:
        return nominal(self.where)

    @property
    def heading(self) -> str:
        """The place as in a heading, without an article."""
        return re.sub(r"^(?:an?|the) ", "", self.noun) or self.where

    @property
    def headline(self) -> str:
        """The event without the words that a headline omits."""
        return headline(_clause(re.sub(r"(?<=\d) metres\b", " m", self.event)))

    @property
    def clause(self) -> str:
        return _clause(self.event)

    @property
    def event_of_it(self) -> str:
        """The event, with `it` for an ego that was named right before."""
        if not self.has_pronoun or self.traffic:
            return self.event
        return re.sub(r"^The ego vehicle(?= )", "It", self.event)

    @property
    def clause_of_it(self) -> str:
        return _clause(self.event_of_it)

    @property
    def later_opening(self) -> str:
        return _clause(self.opening)

    @property
    def statement_clause(self) -> str:
        return _clause(self.statement)

    @property
    def aside(self) -> str:
        return f", {self.traffic}" if self.traffic else ""

    @property
    def routine(self) -> str:
        """The ego's behaviour before anything happens."""
        if not self.has_pronoun:
            return ""
        return f"{'The ego vehicle' if self.traffic else 'It'} {KEEPS_ON}"

    @property
    def starts_plainly(self) -> bool:
        """True if the event begins with its subject."""
        if _PLAIN.match(self.event) is not None:
            return True
        return not self.is_act and _ADVERBIAL.match(self.event) is None

    @property
    def starts_with_ego(self) -> bool:
        return self.event.startswith("The ego vehicle")

    @property
    def is_short(self) -> bool:
        """True if the event fits into a sentence with the place."""
        return len(self.event.split()) <= _LONG_EVENT and "," not in self.event

    @property
    def happens(self) -> bool:
        """True if the event is an occurrence, so that `when` can introduce it."""
        if re.search(r"\b(when|while|as|after|before|until|because)\b", self.event):
            return False
        return self.is_act and _LASTING.search(" ".join(self.event.split()[:9])) is None

    @property
    def names_ego(self) -> bool:
        """True if the event, or its location, names the ego."""
        return re.search(r"\bego\b|(?<!from )\{where\}", self.event) is not None

    @property
    def leads(self) -> bool:
        """True if the place can come first, followed by the event as its clause."""
        return (
            self.starts_plainly
            and self.names_ego
            and not self.starts_with_ego
            and self.where.startswith(("on ", "in ", "along "))
            and not self.traffic
        )

    @property
    def introduces(self) -> bool:
        """True if the event can precede the place, because it does not presuppose it."""
        event = f" {self.event.casefold()} "
        return not any(f" the {word} " in event for word in " ".join(self.place.words).split())

    @property
    def fits_weather(self) -> bool:
        """True if weather can precede the place without repeating its preposition."""
        return bool(self.weather) and self.weather.split()[0] != self.at.split()[0]

    @property
    def can_be_noted(self) -> bool:
        """True if the place can be a sentence without a verb."""
        return bool(self.noun) and self.names_ego and not self.traffic


def _clause(event: str) -> str:
    return event[:1].lower() + event[1:]


@dataclass(frozen=True)
class Construction:
    """One way to word a plot."""

    sentences: tuple[str, ...]
    """Templates of its sentences, with properties of the plot; one that comes out empty is left out."""
    suits: Callable[[Plot], bool] = lambda plot: True
    names_ego: bool = True
    """True if it has a separate part about the ego."""
    is_apart: bool = False
    """True if the event is a separate sentence, whose parts may be reordered."""
    is_line: bool = False
    """True if it is a single line, as in a test catalogue."""

    def build(self, plot: Plot) -> str:
        words = (" ".join(sentence.format(plot).split()) for sentence in self.sentences)
        return " ".join(_sentence(text) for text in words if text)


def _sentence(text: str) -> str:
    text = text.replace(" ,", ",").replace(" :", ":")
    return f"{text[0].upper()}{text[1:].rstrip('.')}."


_DETAIL = "{0.detail}"
_TWO = Construction(
    ("{0.opening} {0.where} {0.weather} {0.aside}", "{0.event_of_it}"), is_apart=True
)
_WEATHER_FIRST = Construction(
    ("{0.weather} , {0.later_opening} {0.where} {0.aside}", "{0.event_of_it}"),
    lambda plot: bool(plot.weather),
    is_apart=True,
)
_STATED = Construction(
    ("{0.statement} , and {0.later_opening} {0.where}", "{0.event_of_it}"),
    lambda plot: bool(plot.statement) and not plot.traffic,
    is_apart=True,
)
_JOINED = Construction(
    ("{0.opening} {0.where} {0.weather} , and {0.clause_of_it}", _DETAIL),
    lambda plot: plot.starts_plainly and plot.is_short and not plot.traffic,
)
_OCCURRING = Construction(
    ("{0.opening} {0.where} {0.weather} when {0.clause_of_it}", _DETAIL),
    lambda plot: plot.starts_plainly and plot.happens and not plot.traffic,
)
_MEANWHILE = Construction(
    ("{0.event} while {0.later_opening} {0.where} {0.weather}", _DETAIL),
    lambda plot: (
        plot.starts_plainly
        and plot.is_short
        and not plot.starts_with_ego
        and re.search(r"\b(when|while|where|as|until|although)\b", plot.event) is None
        and not plot.traffic
        and plot.introduces
    ),
)
_PLACE_FIRST = Construction(
    ("{0.at} {0.weather} , {0.clause}", _DETAIL),
    lambda plot: plot.leads and (not plot.weather or plot.fits_weather),
    names_ego=False,
)
_PLACE_ALONE = Construction(
    ("{0.at} , {0.clause}", _DETAIL), lambda plot: plot.leads, names_ego=False
)
_WEATHER_AND_PLACE = Construction(
    ("{0.weather} {0.at} , {0.clause}", _DETAIL),
    lambda plot: plot.leads and plot.fits_weather and "," not in plot.weather,
    names_ego=False,
)
_STATED_PLACE = Construction(
    ("{0.statement}", "{0.at} , {0.clause}"),
    lambda plot: plot.leads and bool(plot.statement),
    names_ego=False,
)
_STATED_LAST = Construction(
    ("{0.at} , {0.clause}", "{0.statement}"),
    lambda plot: plot.leads and bool(plot.statement),
    names_ego=False,
)
_NOTED = Construction(
    ("{0.noun} {0.weather}", "{0.event}"),
    lambda plot: plot.can_be_noted and bool(plot.weather),
    names_ego=False,
    is_apart=True,
)
_NOTED_AS_STATED = Construction(
    ("{0.noun}; {0.statement_clause}", "{0.event}"),
    lambda plot: plot.can_be_noted and bool(plot.statement),
    names_ego=False,
    is_apart=True,
)
_EVENT_FIRST = Construction(
    ("{0.event}", "{0.opening} {0.where} {0.weather}"),
    lambda plot: not plot.traffic and "ego vehicle" not in plot.event and plot.introduces,
    is_apart=True,
)
_EVENT_THEN_PLACE = Construction(
    ("{0.event}", "it happens {0.where} {0.weather}"),
    lambda plot: (
        plot.is_act
        and plot.names_ego
        and not plot.traffic
        and plot.where.startswith(("on ", "in "))
        and plot.introduces
    ),
    names_ego=False,
    is_apart=True,
)
_DOING = Construction(
    ("driving {0.where} {0.weather} , {0.clause}", _DETAIL),
    lambda plot: plot.starts_with_ego and not plot.traffic,
)
_LINE = Construction(("{0.heading} {0.weather} : {0.headline}",), names_ego=False, is_line=True)
_ACCOUNT = Construction(
    (
        "{0.opening} {0.where} {0.aside}",
        "{0.routine}",
        "{0.statement}",
        "{0.event_of_it}",
        _DETAIL,
    ),
    is_apart=True,
)

_WITHOUT_EGO = (
    *3 * (_PLACE_FIRST,),
    *2 * (_PLACE_ALONE,),
    *3 * (_WEATHER_AND_PLACE,),
    _STATED_PLACE,
    *2 * (_STATED_LAST,),
    *2 * (_NOTED,),
    *2 * (_NOTED_AS_STATED,),
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
