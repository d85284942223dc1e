"""Words that follow a mention of weather, an hour or a road and cancel it, for readers of claims and of open answers."""

import re
from collections.abc import Iterable

from oodscen.claims._things import plural_of

_AFTER_WEATHER = "storms?|showers?|clouds?|banks?|falls?|covers?|spells?|fronts?|that|which|just|finally|already|now"
_DETERMINER = "the|an?|every|each|its|this|these|those|our|their|his|her|several|many|most"
_ON_ROADS = "(?:road|street|lane|bridge|pavement|roof|tree|sign|car|lorr|truck|bus|train|driver|cyclist)(?:s|es|ies)|traffic|everything|everyone"
_AGO = r"(?: [\w-]+){1,3} (?:ago|before|earlier)\b"
_WITHOUT_OBJECT = rf"(?:(?={_AGO})|(?! (?:{_DETERMINER}|{_ON_ROADS})\b))"
"""Matches where no object of a verb follows, such as `the road` or `traffic`; `a while ago` is none."""
_ENDED = re.compile(
    rf"^ (?:(?:{_AFTER_WEATHER}) )?(?:has|have|had) (?:just |finally |already |now )?"
    rf"(?:stopped\b{_WITHOUT_OBJECT}|ceased|ended|passed|lifted|cleared|gone(?! on\b)|let up)\b"
    rf"|^ (?:stopped\b{_WITHOUT_OBJECT}|ceased|(?:is|are) (?:just |finally |already |now )?(?:over|gone)|earlier"
    r"|of the (?:night|day) before|warning|forecast)\b",
    re.IGNORECASE,
)
_USED_IN_WEATHER = re.compile(
    rf"^[ -](?:t[iy]res?|boots|ploughs?|plows?|chains?|blowers?|lamps?|horns?"
    rf"|(?:coats?|fences?|lights?)\b(?! up){_WITHOUT_OBJECT})\b",
    re.IGNORECASE,
)
_OBJECTS = "barrels? butts? jackets? gauges? ponchos? lamp shifts? clubs? express".split()
_ACTORS = "bus taxi train tram owl watchman guard porter nurse patrol crew".split()
_SERVING = "vehicle car van lorry truck train boat engine helicopter convoy drone robot team crew gang party unit worker".split()
"""Nouns for those that maintain, inspect, survey or clean a road, or rescue people there."""


def _noun_pattern(nouns: Iterable[str], serving: Iterable[str]) -> re.Pattern[str]:
    """Return a pattern of nouns right after a position, such as ` watchman` or ` rescue team`."""
    services = "maintenance|inspection|rescue|survey|cleaning"
    return re.compile(
        rf"^[ -](?:{'|'.join(nouns)}|(?:{services}) (?:{'|'.join(serving)}))(?![\w-])",
        re.IGNORECASE,
    )


_DESCRIBED_NOUN = _noun_pattern([*_OBJECTS, *_ACTORS], _SERVING)
_DESCRIBED_PLURAL = _noun_pattern(map(plural_of, _ACTORS), map(plural_of, _SERVING))
_CIRCUMSTANCE = re.compile(
    r"\b(?:at|by|in|on|under|during|through|amid|despite)(?: (?!with\b|of\b)[\w-]+){1,3}$",
    re.IGNORECASE,
)
_CIRCUMSTANCE_LENGTH = 80
"""Number of characters before a position that may hold a circumstance such as `during the night`."""


def is_weather_cancelled(after: str) -> bool:
    """Return whether weather is over, announced, or names a thing used in it, by the words after it: `snow plough`."""
    return bool(_ENDED.match(after) or _USED_IN_WEATHER.match(after))


def describes_noun(text: str, end: int) -> bool:
    """Return whether the weather, road or hour up to a position only describes the next noun: `night watchman`.

    Several who act may also be the subject of a clause of their own, as in "At night buses stop here".
    """
    after = text[end:]
    if _DESCRIBED_NOUN.match(after):
        return True
    is_circumstance = bool(_CIRCUMSTANCE.search(text[max(0, end - _CIRCUMSTANCE_LENGTH) : end]))
    return bool(_DESCRIBED_PLURAL.match(after)) and not is_circumstance
