"""Signs that a text describes something impossible, or more than one event.

They are patterns and not understanding: what they flag is nearly always so, and much that is impossible is not flagged.
`docs/rarity.md` has the rates.
"""

import re
from typing import Final

_BEINGS: Final = (
    r"aliens?(?!-| (?:plants?|species|trees?)\b)|ghosts?(?! (?:drivers?|riders?|bikes?|cars?|islands?|towns?|(?:(?:lane|road) )?(?:lines?|markings?)|"
    r"brak(?:es|ing)|detections?|objects?)\b)|unicorns?|dragons?(?!['’]| (?:boats?|danc\w+|kites?|streets?)\b)|zombies?|wizards?|witch(?:es)?(?! hazels?\b)|"
    r"mermaids?|werewol(?:f|ves)|vampires?(?! bats?\b)|"
    r"godzilla|sorcerers?|dinosaurs?|woolly mammoths?|mammoths|centaurs?|trolls?|goblins?|spaceships?|starships?|ufos?|flying saucers?"
)
_READ = 20_000
"""Characters of a text that are searched."""
_DISPLAYED = re.compile(
    r"\b(?:costumes?|dressed|masks?|posters?|billboards?|inflatables?|balloons?|statues?|floats?|toys?|painted|"
    r"printed|models?|mascots?|carnival|halloween|film|movie|sculptures?|replicas?|cardboard|animatronics?|skeletons?|fossils?|exhibits?|murals?|"
    r"stickers?|adverts?|advertisements?|message boards?|reads)\b"
)
"""Words of what only shows a being."""
_GROUND: Final = (
    r"(?:cars?|trucks?|lorr(?:y|ies)|bus(?:es)?|vans?|vehicles?|trams?|bicycles?|pedestrians?|houses?|bridges?|trees?|"
    r"cows?|horses?|elephants?|traffic lights?|road|street|lane|buildings?|people|man|woman|child|ego)"
)
_HEAVY: Final = r"(?:cars?|trucks?|lorr(?:y|ies)|bus(?:es)?|vans?|vehicles?|trams?|trains?|bicycles?|pedestrians?|houses?|cows?|horses?|elephants?)"
_ROOTED: Final = (
    r"(?:trees?|traffic lights?|houses?|buildings?|lamp posts?|bridges?|hydrants?|walls?)"
)
_BEING = re.compile(
    rf"(?<!like a )(?<!like an )(?<!illegal )(?<!komodo )(?<!bearded )\b(?:{_BEINGS})\b"
)
_IMPOSSIBLE = tuple(
    re.compile(pattern)
    for pattern in (
        r"\b(?:teleport|levitat|dematerial|antigravit|time ?warp|time[- ]travel)\w*",
        rf"\b{_GROUND} (?:\w+ )?(?:flies|is flying|hovers|floats) (?:\w+ ){{0,2}}(?:over|above|through|in) (?:the |mid-?)?"
        r"(?:air|sky|clouds?|roofs?|city|rooftops?)\b",
        rf"\b(?:flying|hovering) {_HEAVY}\b(?! (?:bod(?:y|ies)|bonnets?|bridges?|bumpers?|debris|doors?|hoods?|mirrors?|(?:number )?plates?|parts?|pieces?|roofs?|"
        r"shelters?|stunts?|tires?|tyres?|wheels?))",
        rf"\b{_GROUND} (?:\w+ )?(?:vanish(?:es)?|disappears?|dissolves?|evaporates?) (?:into (?:thin air|nothing)|in mid-?air)\b",
        r"\b(?:passes|walks|goes|runs) (?:straight |right )?through (?:a |the )?(?:solid |brick |concrete )?"
        r"(?:walls?|other cars?|the truck|solid rock)\b(?! opening| gap| of (?:dust|fire|flames|fog|heat|mist|people|rain|sand|smoke|snow|spray|steam|water)\b)",
        r"\b(?:gravity|time) (?:\w+ly )?(?:reverses?|stops|stands still|runs backwards?|is switched off|no longer)\b",
        r"\b(?:moon (?:\w+ )?(?:falls|lands|crashes)|(?:sun|moon) (?:\w+ )?(?:explodes|goes out))\b",
        rf"\b{_ROOTED} (?:\w+ )?(?:walks?|jumps?(?! (?:from|to) (?:amber|green|red|yellow)\b)|dances?|drives?|speaks?|talks?|sings?|chases?|swims?)\b",
        rf"\b{_GROUND} (?:\w+ )?(?:transforms|morphs) into\b",
        rf"\b{_GROUND} (?:\w+ )?(?:turns|changes) into (?:a |an )?(?:swan|bird|frog|dog|cat|horse|cow|elephant|snake|fish|"
        r"monster|robot|pumpkin|boat|plane|house|cloud|stone|gold)\b(?! (?:trailers?|vans?|box(?:es)?|transporters?|farms?|yards?|drives?|driveways?|parks?|"
        r"streets?|roads?))",
        r"\b(?:road|street|lane)s? (?:suddenly )?(?:comes alive|bends upwards into|becomes (?:lava|glass|water|vertical))\b",
    )
)
_WHOLE: Final = r"(?<![\w.,])([1-9]\d{0,2}(?:[%s\s]\d{3}){1,4}|\d+)(?:[.,]\d+)?[\s-]*"
"""A number whose groups of three digits these signs part; the digit of a road such as A9 is none of it."""
_AN_HOUR, _A_SECOND = r"\s?(?:/|per|an)\s?h(?:our)?", r"\s?(?:/|per)\s?s(?:ec(?:ond)?)?"
_FASTEST_KMH: Final = 500.0
"""Greatest speed of a road vehicle, km/h."""
_SPEEDS: Final = tuple(
    (re.compile(rf"{_WHOLE % separators}(?:{units})\b"), kmh)
    for units, separators, kmh in (
        (rf"k(?:ilo)?m(?:et(?:re|er)s?)?{_AN_HOUR}|km?ph|kmh", ",.'’", 1.0),
        (rf"mi(?:les?)?{_AN_HOUR}|mph", ",.'’", 1.609344),
        ("knots?|kts", ",.'’", 1.852),
        # Slow speeds have three decimals in these.
        (rf"m(?:et(?:re|er)s?)?{_A_SECOND}", ",'’", 3.6),
        (rf"f(?:ee|oo)?t{_A_SECOND}", ",'’", 1.09728),
    )
)
"""Speeds by their units, and a unit's km/h."""

_EVENT = re.compile(
    r"\b(?:(?:explod|collaps(?!ibl)|burst|erupt|overturn|derail|ignit(?!ion)|capsiz|jackknif)\w*|faint(?:s|ed|ing)\b|(?:run(?:s|ning)?|ran) loose\b)"
)
_ENTERS = re.compile(
    r"\W*(?:an?|another|two|three|some|several)\b.{0,60}?\b(?:jump|leap|dart|bolt|fall|drop|crash|collid|skid|swerv|roll|spin|"
    r"tumbl|topple|slid|plung|slam|rush|burst|escap|break|explod|collaps|run|land)(?:s|es)?\b"
)
"""A thing that a part is the first to mention, and that does something sudden."""
_PART_BREAK = re.compile(
    r"(?<=[.!?;])\s+|(?:,|(?<!\s))\s+(?:and then|then|while|just as|at the same time|meanwhile|moments later|after which)\s+"
)


def is_impossible(text: str) -> bool:
    """Return whether a text names a thing, an act or a speed that does not exist."""
    lower = text[:_READ].lower()
    if _BEING.search(lower) and not _DISPLAYED.search(lower):
        return True
    if any(pattern.search(lower) for pattern in _IMPOSSIBLE):
        return True
    return any(
        kmh * float(re.sub(r"\D", "", number)) > _FASTEST_KMH
        for speed, kmh in _SPEEDS
        for number in speed.findall(lower)
    )


def parts(text: str) -> list[str]:
    """Return the sentences and joined clauses of a text that have three words or more."""
    return [part for part in _PART_BREAK.split(text[:_READ]) if part and len(part.split()) > 2]


def names_event(part: str) -> bool:
    """Return whether a part of a text names a sudden event, which the head may take for common."""
    lower = part.lower()
    return _EVENT.search(lower) is not None or _ENTERS.match(lower) is not None
