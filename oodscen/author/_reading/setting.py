"""The frame of a text by any author: its place and time, and its name for the ego vehicle.

The frame is found by grammar alone: phrases that begin with a preposition and end in a road or in
weather.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from oodscen.prompts._scenario.describe_path import plain

_ROADS = (
    r"(?:roads?|streets?|highways?|motorways?|freeways?|expressways?|interstates?|carriageway|avenues?|boulevards?|alleys?|"
    r"tunnels?|(?:over|under)?bridge|overpass|underpass|viaduct|junctions?|intersections?|roundabouts?|crossings?|"
    r"crosswalk|crossroads|t-junction|(?:on-|off-|exit |entry |slip )?ramps?|city|town|village|suburbs?|downtown|"
    r"(?:construction|work|school) zones?|parking (?:lot|area)|car park|mountain pass|desert|forest|coast|valley|"
    r"hill|slope|curves?|bend|hairpin(?: turn)?|diverge|merge(?: area| lane| zone)?|roadworks|driveway|neighbou?rhood|"
    r"(?:urban|rural|residential|suburban|industrial|city) (?:area|environment|zone|setting|district)|"
    r"(?:country|gravel|farm|dirt|merging) (?:lane|track)|countryside|grade|level crossing)"
)
_NO_ROAD = (
    r"(?![\w'\u2019]|-(?!of)|\s(?:car|cars|vehicles?|bus|traffic|workers?|users?|signs?|signals?|markings?|lights?|edges?|"
    r"side|surface|works?|blocks?|closures?|conditions?|rage|limits?|trucks?|lane|lanes|layout|pedestrian|name|has|have)\b)"
)
_WEATHER = (
    r"(?:rain(?:fall|storm)?|drizzle|downpour|snow(?:fall|storm)?|sleet|hail|fog|mist|haze|thunderstorm|storm|winds?|"
    r"crosswinds?|gusts?|weather|skies|sky|sunlight|sunshine|sun|darkness)"
)
_HOURS = (
    r"(?:night|nighttime|dusk|dawn|morning|noon|midday|afternoon|evening|midnight|sunset|sunrise|twilight|daybreak|day|"
    r"daylight|daytime|rush hour|rush-hour traffic|winter|autumn|summer)"
)
_WORD = (
    r"(?!(?:and|or|but|of|the|an?|in|on|at|as|when|while|where|who|that|which|is|are|has|have|with|near|to|from|before|"
    r"after|must|may|can|should|will|vehicles?|cars?|trucks?|pedestrians?|cyclists?|drivers?|ego|another|coming|path|"
    r"way|side|front|middle|edge|lane)\b)[\w%/.-]*\w"
)
_WHEN = re.compile(
    r"\b(?:(?:late|early) (?:at|in|on)|shortly (?:after|before)|just (?:after|before)|on|in|at|during|under|amid|amidst|"
    r"through|despite|by|after|before|around|given|with)\s"
    rf"(?:(?:an?|the|this|that)\s)?(?:(?:\w+ and )?{_WORD}\s){{0,4}}?(?:{_WEATHER}|{_HOURS}|(?<=[yt]\s)conditions)(?:\s{_HOURS})?(?:\s(?:day|drive|conditions?|"
    rf"rush hour|thunderstorm|storm))?(?:\s(?:and|in)\s(?:{_WORD}\s){{0,2}}{_WEATHER})?(?![\w'\u2019-]|\s(?:glare|sandstorm|hailstorm|light\b))",
    re.IGNORECASE,
)
_IS_SO = re.compile(
    r"\b(?:while |as |when )?(?:it is (?:raining|snowing|drizzling|foggy|dark|windy|sunny|getting dark)|night (?:falls|has fallen))\b",
    re.IGNORECASE,
)
_ALONE = re.compile(
    r"\b(?:(?:heavy|light|steady|strong|gusty|dense|thick|drizzling|pouring|torrential|falling) (?:rain(?:fall)?|drizzle|"
    r"snow(?:fall)?|fog|mist|winds?|crosswinds?)|rain|snowfall|rainfall|fog|crosswinds)\b(?![-\w])",
    re.IGNORECASE,
)
_LANES = r"(?:,? with (?:\w+ )?(?:one|two|three|four|five|single|several) lanes?(?: (?:in each direction|each way|per direction))?)?"
_NAMED = r"(?:\s(?:in|near|outside)\s(?-i:[A-Z])[\w-]+)?"
_PLACE = rf"(?:{_WORD},?\s){{0,5}}?(?:{_ROADS}\s)*{_ROADS}{_NO_ROAD}{_LANES}{_NAMED}"
_WHERE = re.compile(
    r"(?:\b(?P<prep>on|along|in|at|through|near|across|over|into|onto|down|up|inside|from|towards?|within|around|"
    r"approaching|entering|crossing|leaving|under|via|to)\s)?"
    rf"(?P<thing>\b(?:an?|the|this|my|our|your|its|another)\s{_PLACE}(?:\s(?:of|over|in|through|above) (?:an?|the) (?:{_WORD}\s?){{1,2}}(?=[,.;:]|$))?|"
    r"(?<=\bin\s)(?:downtown|town|suburbia)\b)",
    re.IGNORECASE,
)
_BARE = re.compile(
    rf"\b(?P<prep>on|along|in|at|through|near|into|approaching|entering)\s(?P<thing>{_PLACE})",
    re.IGNORECASE,
)
_STAYS = frozenset("on along in at through near inside within around under".split())
_AT = re.compile(
    r"(?:junction|intersection|roundabout|crossing|crosswalk|crossroads)s?$", re.IGNORECASE
)
_IN = re.compile(
    r"(?:tunnel|city|town|village|suburbs?|zones?|alley|lot|area|park|desert|forest|valley|environment|setting|"
    r"district|neighbou?rhood|curves?|bend|countryside|downtown|underpass|roadworks)s?$",
    re.IGNORECASE,
)
_STRANGE = re.compile(
    r"(?<![\w-])(?:blocked|closed|collapsed|collapsing|flooded|burning|broken|damaged|cracked|icy|iced|icy-slick|frozen|slippery|(?:rain-)?slick(?:ed)?|"
    r"oily|unlit|deserted|washed-out|unsignali[sz]ed)[ ,]+(?=\w)",
    re.IGNORECASE,
)
"""Adjectives that are themselves the trouble with a road."""
_GIVEN = re.compile("^(?:given|despite) ")
_VAGUE = frozenset("adverse challenging bad poor severe difficult harsh extreme".split())
_COMMON = frozenset("road street lane carriageway curve slope grade bend hill".split())
"""Roads that say little by themselves."""

_EGO = (
    r"(?:(?:the |an |our )?(?:user-controlled )?(?:ego|hero|autonomous|automated|self-driving|host|subject|av)"
    r"(?:[ -](?:vehicle|car|driver))?|my car|our car|your car|i|we|you)"
)
_GOES = (
    r"(?:(?:is |are |am )?(?:travel|driv|mov|head|proceed|cruis|roll|go|turn|approach|enter|cross|exit|leav|navigat|"
    r"descend|climb|pass|follow|merg)(?:l?ing|ing|es|s|e)?|(?:is|are) (?:making|performing|maintaining)|(?:makes|takes|performs|maintains))"
)
_ADDED = (
    r"(?:\s(?:straight(?: (?:on|ahead))?|on(?=\s*(?:[,.;]|$))|along(?=\s*(?:[,.;]|$))|left|right|slowly|steadily|normally|downhill|uphill|an? (?:left|right|u-)\s?turn|"
    r"(?:at|of|with) (?:a )?(?:constant )?(?:speed of )?\d[\d.]* ?(?:km/h|kph|mph|m/s)(?: \([^)]*\))?|"
    r"(?:at )?a constant speed|in its (?:own )?lane|in the (?:right|left|middle) lane))"
)
_RIDE = re.compile(rf"\b{_EGO}\s(?:\w+ly )?{_GOES}\b", re.IGNORECASE)
_ENDS = re.compile(r"(?=\s*(?:[,.;:]|$)|\s(?:when|while|and|as|where|with|but|must|needs?)\b)")
_SENTENCES = re.compile(r"(?<=[.!?;])\s+(?=[A-Z\d])")
_SAYS_WHO = (
    (r"\b(?:the )?ego-vehicle\b", "the ego-vehicle"),
    (r"\b(?:the )?ego vehicle\b", "the ego vehicle"),
    (r"\b(?:the )?ego car\b", "the ego car"),
    (r"\bthe ego lane\b", "the ego car"),
    (r"\bthe ego driver\b", "the ego vehicle"),
    (r"\bthe ego\b", "the ego"),
    (r"\bego\b", "ego"),
    (r"\bour (?:car|vehicle|lane)\b|\bwe\b", "we"),
    (
        r"\bmy (?:car|vehicle|lane|way|path|windscreen|windshield)\b|(?<![\w-])I(?![\w-])|\bme\b",
        "I",
    ),
    (r"\byou\b|\byour\b", "you"),
    (
        r"\b(?:autonomous|automated|self-driving|hero|host|subject) (?:vehicle|car)\b",
        "the {found}",
    ),
    (r"\bAV\b", "the AV"),
)


@dataclass(frozen=True)
class Frame:
    """The parts of a text that stay when its event is replaced."""

    before: tuple[str, ...]
    """Phrases for place and time at the beginning."""
    ride: str
    """Clause about how the ego moves; empty if there is none."""
    after: tuple[str, ...]
    """Phrases for place and time that come later."""

    @property
    def text(self) -> str:
        """The whole frame as one text, for reading its place and time."""
        return " ".join((*self.before, self.ride, *self.after))


def teller(text: str) -> str:
    """Return the name of the ego vehicle in a text; empty if the text does not mention it."""
    first: tuple[int, str] | None = None
    for pattern, name in _SAYS_WHO:
        found = re.search(pattern, text, 0 if name in ("the AV", "I") else re.IGNORECASE)
        if found is not None and (first is None or found.start() < first[0]):
            first = found.start(), name.format(found=found[0])
    return first[1] if first else ""


def framed(text: str, leave_out: frozenset[str] = frozenset()) -> Frame:
    """Return the phrases for the place and time of a text.

    Args:
        text: Any text.
        leave_out: Words of the event; a weather phrase with one of them belongs to the event.
    """
    leave_out = frozenset(word for word in leave_out if not re.fullmatch(_HOURS, word))
    before: list[str] = []
    after: list[str] = []
    ride = ""
    for sentence in _SENTENCES.split(text.strip()):
        start, end = 0, 0
        if not ride:
            start, end = _ride(sentence)
            if end:
                ride = _calm(sentence[start:end])
        for at, phrase in _phrases(sentence, leave_out):
            if end and start <= at < end:
                continue
            is_first = at == 0 or at < start or _follows(sentence, at, before)
            is_first = is_first and not after and not (ride and not end)
            (before if is_first else after).append(phrase)
    return _thinned(before, ride, after)


def _follows(sentence: str, at: int, before: list[str]) -> bool:
    """Return whether only kept phrases precede a position."""
    left = plain(sentence[:at])
    return bool(left) and left == plain(" ".join(before))


def _ride(sentence: str) -> tuple[int, int]:
    """Return the span of a sentence that says how the ego moves, and nothing more."""
    for found in _RIDE.finditer(sentence):
        start, at = found.span()
        while True:
            more = re.compile(_ADDED, re.IGNORECASE).match(sentence, at)
            if more is None:
                gap = re.compile(r"\s").match(sentence, at)
                at_word = gap.end() if gap else at
                more = next(
                    (
                        m
                        for p in (_WHERE, _BARE, _WHEN)
                        if gap and (m := p.match(sentence, at_word))
                    ),
                    None,
                )
            if more is None:
                break
            at = more.end()
        if at > found.end() or _ENDS.match(sentence, at):
            if at == found.end() and not re.search(r"(?:ing|es|s|e)$", found[0]):
                continue
            if at > found.end() or re.search(r"(?:travel|driv|mov)\w+$", found[0]):
                return start, at
    return 0, 0


def _phrases(sentence: str, leave_out: frozenset[str]) -> Iterator[tuple[int, str]]:
    """Yield the phrases for time and place in a sentence, in order."""
    found = [
        (*match.span(), _GIVEN.sub("in ", _uncapped(match[0])))
        for match in (*_WHEN.finditer(sentence), *_IS_SO.finditer(sentence))
        if not (leave_out | _VAGUE) & set(plain(match[0]).split())
    ]
    for match in _ALONE.finditer(sentence):
        is_known = any(start <= match.start() < end for start, end, _ in found)
        if not is_known and not (leave_out | _VAGUE) & set(plain(match[0]).split()):
            found.append((*match.span(), f"in {_uncapped(match[0])}"))
    for match in (*_WHERE.finditer(sentence), *_BARE.finditer(sentence)):
        if (match["prep"] or "").casefold() == "from":
            continue
        if any(start < match.end() and match.start() < end for start, end, _ in found):
            continue
        found.append((*match.span(), _placed(match["prep"] or "", match["thing"])))
    for start, _, phrase in sorted(found):
        yield start, phrase


def _placed(preposition: str, thing: str) -> str:
    """Turn a phrase that may describe a direction into one that describes a location."""
    thing = _uncapped(_calm(thing))
    preposition = preposition.casefold()
    if preposition in _STAYS:
        return f"{preposition} {thing}"
    kind = re.split(r" (?:of|over|in|through|above|with) ", thing)[0]
    return f"{'at' if _AT.search(kind) else 'in' if _IN.search(kind) else 'on'} {thing}"


def _calm(phrase: str) -> str:
    """Remove adjectives that are themselves the trouble."""
    bare = _STRANGE.sub("", phrase)
    if bare == phrase:
        return phrase
    bare = re.sub(r"\ban (?=[^aeiou\W])", "a ", bare)
    return re.sub(r"\ba (?=[aeiou])(?!uni|one|u-)", "an ", bare)


def _uncapped(phrase: str) -> str:
    return phrase[0].lower() + phrase[1:]


def _thinned(before: list[str], ride: str, after: list[str]) -> Frame:
    """Remove repetitions: of two phrases for one kind of road or time, the fuller one stays."""
    said: list[str] = [ride] if ride else []
    fuller = sorted((*before, *after), key=lambda phrase: (_is_common(phrase), -len(phrase)))
    kept: list[str] = []
    for phrase in fuller:
        head = plain(phrase).split()[-1]
        heads = {head, head.removesuffix("s"), f"{head}s"}
        known = set(plain(" ".join((*said, *kept))).split())
        is_place = re.search(_ROADS, phrase, re.IGNORECASE) is not None
        has_place = any(re.search(_ROADS, one, re.IGNORECASE) for one in (*said, *kept))
        if heads & known or (is_place and has_place and _is_common(phrase)):
            continue
        kept.append(phrase)

    def of(phrases: list[str]) -> tuple[str, ...]:
        return tuple(one for one in dict.fromkeys(phrases) if one in kept)

    first = of(before)
    return Frame(first, ride, tuple(one for one in of(after) if one not in first))


def _is_common(phrase: str) -> bool:
    words = plain(phrase).split()
    return words[-1] in _COMMON and len(words) <= 3
