"""Words after weather, an hour or a road that take it back, for readers of claims and of open answers."""

import re

ENDED = re.compile(
    r"^ (?:\w+ )?(?:has|have|had) (?:just |finally |already |now )?(?:stopped|ceased|ended|passed|lifted|cleared|gone|let up)"
    r"|^ (?:stopped|ceased|(?:is|are) (?:over|gone)|earlier|of the (?:night|day) before|warning|forecast)\b"
    r"|^[ -](?:tyres?|coats?|boots|plou?ghs?|plows?|chains?|blowers?|fences?|lamps?|lights?(?! up)|horns?)\b",
    re.IGNORECASE,
)
"""Matches words after weather that mean that it is over, or only describes a thing: `snow plough`."""

_DESCRIBED = (
    "barrels? butts? jackets? gauges? ponchos? lamp watchm[ae]n bus taxi train tram shifts? clubs? owls? express guard"
    " porter nurse patrol crew"
)
IN_A_NAME = re.compile(
    rf"^[ -](?:{'|'.join(_DESCRIBED.split())}"
    r"|(?:maintenance|inspection|rescue|survey|cleaning) (?!is\b|has\b|goes\b)[\w-]+)(?![\w-])",
    re.IGNORECASE,
)
"""Matches nouns after weather, a road or an hour that it only describes: `night watchman`, `rain barrel`."""
