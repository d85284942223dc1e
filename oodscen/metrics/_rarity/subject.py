"""Signs that a text is not about driving on a road."""

import re
from functools import cache
from typing import Final

from oodscen.metrics._rarity.words import stems

_ROAD: Final = """
accident ahead alley ambulance asphalt autobahn avenue barrier bend bicycle bike bollard bonnet brake bridge bumper bus bypass campervan
car caravan carriageway coach collide collision cone convoy crash crossing crossroads crosswalk curb cycle cyclist dashboard drive
driver driveway drove ego engine estate exit expressway flyover footbridge footpath footway freeway gantry garage green guardrail
hatchback headlamp headlight hearse highway indicator intersection interstate jaywalker jeep junction kerb kilometre km lamp lane level
light lorry minibus minivan mirror moped motorbike motorcycle motorhome motorist motorway oncoming onramp overpass overtake park pass
pavement pedestrian petrol pickup police pothole queue rail railway ramp red rickshaw rider road roadblock roadkill roadside roadway
roadworks roundabout saloon scooter sedan shoulder sidewalk signal skateboard slip snowplough snowplow speed steer street streetcar suv
swerve tanker tarmac taxi tire toll tractor traffic trailer train tram tricycle trolley truck tunnel turnpike tyre underpass van vehicle
verge viaduct wagon walk wheel wheelchair windscreen windshield wiper zebra
"""
_FEWEST = 6
"""Words from which a text must name something of the road: a shorter one may be the label of a kind."""
_READ = 1_000
"""Characters of a text that are searched for numbers and repeated words."""
_WORD = re.compile(r"[^\W\d_]+")
_TOKEN = re.compile(r"\d+|[^\W\d_]+")
_NUMBERS: Final = frozenset(
    "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen seventeen eighteen nineteen "
    "twenty thirty forty fifty sixty seventy eighty ninety hundred hundreds thousand thousands million millions billion billions "
    "and a about once in every per point half minus percent "
    "km kilometre kilometres kilometer kilometers mile miles metre metres meter meters centimetre centimetres foot feet yard yards "
    "second seconds minute minutes hour hours day days week weeks month months year years kmh kph mph "
    "kg kilogram kilograms ton tons tonne tonnes pound pounds degree degrees".split()
)

_EMPHATIC: Final = frozenset("far long many no really so too very".split())
"""Words that a sentence may repeat for emphasis."""


def is_number(text: str) -> bool:
    """Return whether a text says nothing but numbers and units, or has more numbers than words."""
    tokens = _TOKEN.findall(text[:_READ].lower())
    words = [token for token in tokens if not token.isdecimal() and token not in _NUMBERS]
    numbers = sum(token.isdecimal() for token in tokens)
    return not words or len(words) < numbers


def repeats_word(text: str) -> bool:
    """Return whether a text has one word three times in a row, as no sentence does but for emphasis."""
    words = _WORD.findall(text[:_READ].lower())
    in_a_row = zip(words, words[1:], words[2:], strict=False)
    thrice = {first for first, second, third in in_a_row if first == second == third}
    if thrice - _EMPHATIC:
        return True
    return bool(thrice) and len(set(words)) == 1


def names_road(text: str) -> bool:
    """Return whether a text names a road, a vehicle or one who uses them, or is too short to have to."""
    text_stems = stems(text)
    return len(text_stems) < _FEWEST or not _road_stems().isdisjoint(text_stems)


@cache
def _road_stems() -> frozenset[str]:
    return frozenset(stems(_ROAD))
