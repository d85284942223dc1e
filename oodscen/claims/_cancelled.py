"""Tells weather, hours and roads that are only mentioned, as over or in a compound noun, for every reader of texts."""

import re
from collections.abc import Iterable

from oodscen.claims._things import plural_of

_REACH = 80
"""Number of characters before a mention whose words count."""

_ADVERBS = (
    "just|finally|already|now|soon|then|long|since|all|mostly|slowly|quickly|gradually|at last"
)
_BE = "is|are|was|were|has|have|had|been|being"
_SUBJECT = (
    r"^(?: (?:and|or) (?:the )?(?:rain|snow|sleet|hail|fog|mist|haze|drizzle|ice|wind|storm|thunder)(?:fall)?)?(?: (?:bank|shower|storm|spell|cloud|fall|cover|front)s?)?"
    r"(?:,? (?:that|which))?"
)
"""Matches what may stand between weather and its verb: `fog banks that`."""
_LONGER = r"^,? (?:that|which) [^.;:!?]{1,40}?"
"""Matches a longer relative clause: `fog that hid the road`."""
_AGO = r"(?: [\w-]+){1,3} (?:ago|before|earlier)"
_CLAUSE_ENDS = (
    rf"(?=\s*(?:\Z|[^\w\s'-])|\s-|(?:{_AGO}"
    r"| (?:and|or|but|yet|so|when|while|whilst|as|before|after|since|because|though|although|until|now|again|today|already|here"
    r"|completely|entirely|altogether|at last|for (?:now|good|today)|by (?:now|then|noon|midday|dawn|the time)"
    r"|from (?:the|this|our|its|here|sight|view)))(?![\w-]))"
)
_NO_OBJECT = (
    rf"(?:{_CLAUSE_ENDS}"
    r"|(?= (?:in|on|at|by|for|from|off|over|under|near|around|along|across|with|within|during|behind|above|beyond|outside|through"
    r"|to|into|towards|between|up|away|out|down|ahead|there|just|only|once|overnight|soon|early|late|last|this|is|has|falling|\w{2,}ly)(?![\w-])))"
)
"""Matches before what is no noun phrase; any other word may be the object of a verb."""
_STOPS = (
    "stops?|stopped|ends|ended|clear(?:s|ed)|lift(?:s|ed)|passed|dried|dries|melt(?:s|ed)|thaw(?:s|ed)|dispers(?:es|ed)"
    "|dissolv(?:es|ed)|evaporat(?:es|ed)|gone (?:by|away)"
)
"""Verbs that end weather, or with an object tell what it does: `has lifted a roof`."""
_LEAVES = r"blows? (?:over|away)|blown (?:over|away)|mov(?:es|ed) (?:on|off|away)"
"""Verbs whose particle may be a preposition: `blows over the road`."""
_CEASES = (
    "ceases?|ceased|vanish(?:es|ed)|disappear(?:s|ed)|subsid(?:es|ed)|abat(?:es|ed)|eas(?:es|ed) off|lets? up|burn(?:s|ed|t)? off"
    "|drain(?:s|ed) away|d(?:ies|ied) (?:down|away)|peter(?:s|ed) out|fad(?:es|ed) away|yield(?:s|ed) to"
    r"|(?:turn(?:s|ed)?|chang(?:es|ed)|shift(?:s|ed)?) (?:in)?to(?! ice\b)|(?:gives?|gave|given|makes?|made) (?:way|place) (?:to|for)"
    "|(?:replaced|followed|succeeded|displaced) by|(?:becomes?|became) (?:rain|snow|sleet|hail|drizzle|mist|fog|sunny|clear|dry)"
)
"""Verbs that end weather whatever follows."""
_ENDED = rf"(?:(?:{_CEASES})\b|(?:{_STOPS})\b{_NO_OBJECT}|(?:{_LEAVES})\b{_CLAUSE_ENDS})"
_GONE = rf"(?:over|gone|past)\b{_CLAUSE_ENDS}"
_OVER = re.compile(
    rf"{_SUBJECT}(?: (?:{_BE}|{_ADVERBS}))* {_ENDED}"
    rf"|(?:{_SUBJECT}|{_LONGER}) (?:{_BE})(?: (?:{_BE}|{_ADVERBS}))* {_GONE}"
    rf"|{_LONGER} (?:{_BE})(?: \w+)? {_ENDED}",
    re.IGNORECASE,
)
_LONG_AGO = re.compile(
    r"^(?:(?!(?:since|began|begun|started|set)\b)[^.,;:!?]){0,40}? (?<!since )(?:yesterday|last (?:night|week|month|winter)"
    r"|earlier(?! than)|previously|formerly|the (?:night|morning|day|evening|week) before|(?:minutes?|hours?|days?|weeks?) ago)\b",
    re.IGNORECASE,
)
_GOVERNED = re.compile(
    r"\b(?:in|amid|under|through|during|despite|at|by) (?:(?:the|an?|this|such) )?(?:(?!(?:the|an?|this|such)\b)[\w-]+ )?$",
    re.IGNORECASE,
)
"""Matches what makes weather a circumstance, so that it is no subject: `in heavy rain stopped cars ...`."""

_ANNOUNCED = re.compile(r"^ (?:warning|forecast)\b", re.IGNORECASE)
_DETERMINER = "the|an?|every|each|its|this|these|those|our|their|his|her|several|many|most|some|all|both|two|three"
_ACTS = rf"up|{_DETERMINER}|traffic|everything|everyone|(?!across\b)[\w-]*\w\ws"
"""Words after `lights` that make it a verb; those after a plural noun do not end with an s, as verbs go."""
_DEVICES = "detect sens collect project generat simulat indicat visualis visualiz monit".split()
_MACHINES = "radars? cameras? alarms? alerts? beacons? sirens? machines? cannons? guns? makers? signs? signals? stations? apps? maps?".split()
_THINGS = (
    "mode vision shifts? school services? market club shelters? gear suits? hats? hoods? capes? canopy canopies goggles gloves"
    " visors? pants trousers umbrellas? wipers? shovels? scrapers? brush(?:es)? gritters? fighters? globes? angels? leopards? goose geese"
    " pipes? gutters? drains? dances? clerk cream"
).split()
_IN_A_NAME = re.compile(
    rf"^[ -](?:(?:[\w-]+ )?(?:(?:{'|'.join(_DEVICES)})ors?|{'|'.join(_MACHINES)})|{'|'.join(_THINGS)})(?![\w-])",
    re.IGNORECASE,
)
_USED_IN_WEATHER = re.compile(
    rf"^[ -](?:t[iy]res?|boots|ploughs?|plows?|chains?|blowers?|lamps?|horns?"
    rf"|(?:coat|fence|light|cover|line)\b(?! (?:up|{_DETERMINER})\b)"
    rf"|(?:coats|fences|lights)\b(?! (?:{_ACTS})(?![\w-])))\b",
    re.IGNORECASE,
)
_OBJECTS = "barrels? butts? jackets? gauges? ponchos? lamp shifts? clubs? express".split()
_NAMED_AFTER = "sign signpost poster map model bus taxi train tram owl watchman guard porter nurse patrol crew".split()
"""Nouns that a road, an hour or weather before them describes."""
_SERVING = "vehicle car van lorry truck train boat engine helicopter convoy drone robot team crew gang party unit worker".split()
"""Nouns for those that maintain, inspect, survey or clean a road, or rescue people there."""


def _noun_pattern(nouns: Iterable[str], serving: Iterable[str], end: str) -> re.Pattern[str]:
    """Return a pattern of nouns right after a mention, such as ` watchman` or ` rescue team`."""
    services = "maintenance|inspection|rescue|survey|cleaning"
    return re.compile(
        rf"^[ -](?:{'|'.join(nouns)}|(?:{services}) (?:{'|'.join(serving)})){end}(?![\w-])",
        re.IGNORECASE,
    )


_DESCRIBED = _noun_pattern([*_OBJECTS, *_NAMED_AFTER], _SERVING, "")
_DESCRIBED_PLURAL = _noun_pattern(map(plural_of, _NAMED_AFTER), map(plural_of, _SERVING), "")
_DESCRIBED_WITH_MORE = _noun_pattern(_NAMED_AFTER, _SERVING, r" [\w-]*\w\ws")
_AT_AN_HOUR = re.compile(
    r"\bat (?:night|nightfall|midnight|dusk|dawn|daybreak|noon|midday|sunset|sunrise)$",
    re.IGNORECASE,
)
"""Matches an hour before which no noun stands without an article: at night is not at a night bus."""
_CIRCUMSTANCE = re.compile(
    r"\b(?:at|by|in|on|under|during|through|amid|despite)(?: (?!with\b|of\b)[\w-]+){1,3}$",
    re.IGNORECASE,
)


def is_over(mention: re.Match[str]) -> bool:
    """Return whether the weather or hour in a text is over, by the words after it."""
    return not _is_governed(mention) and _OVER.match(_after(mention)) is not None


def is_weather_cancelled(mention: re.Match[str]) -> bool:
    """Return whether weather in a text is over, announced, or only names a thing: `snow plough`."""
    after = _after(mention)
    if _LONG_AGO.match(after) or _USED_IN_WEATHER.match(after) or names_thing(mention):
        return True
    return is_over(mention) or (bool(_ANNOUNCED.match(after)) and not _is_governed(mention))


def names_thing(mention: re.Match[str]) -> bool:
    """Return whether weather or an hour names the thing that follows: `night vision`, `rain sensor`."""
    return _IN_A_NAME.match(_after(mention)) is not None


def describes_noun(mention: re.Match[str]) -> bool:
    """Return whether weather, a road or an hour only describes the next noun: `night watchman`."""
    after = _after(mention)
    is_described = _DESCRIBED.match(after) or _DESCRIBED_PLURAL.match(after)
    return bool(is_described) and not precedes_subject(mention)


def precedes_subject(mention: re.Match[str]) -> bool:
    """Return whether the noun after a circumstance is the subject of the clause: "At night crew members cross here"."""
    circumstance = (_before(mention) + mention[0])[-_REACH:]
    if _AT_AN_HOUR.search(circumstance):
        return True
    after = _after(mention)
    is_plural = _DESCRIBED_PLURAL.match(after) or _DESCRIBED_WITH_MORE.match(after)
    return bool(is_plural and _CIRCUMSTANCE.search(circumstance))


def _is_governed(mention: re.Match[str]) -> bool:
    return _GOVERNED.search(_before(mention)) is not None


def _before(mention: re.Match[str]) -> str:
    return mention.string[max(0, mention.start() - _REACH) : mention.start()]


def _after(mention: re.Match[str]) -> str:
    return mention.string[mention.end() :]
