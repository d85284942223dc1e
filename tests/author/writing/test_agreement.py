"""Texts and their ordinary twins agree with themselves in weather, light, road and surface."""

import re
from collections.abc import Iterator

import pytest

from oodscen._seeding import stream
from oodscen.author._knowledge.base import Clash, Knowledge, RoadKind, Wording
from oodscen.author._reading.claim_extraction import read_claims
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._writing.agreement import Agreement, PlaceAndTime
from oodscen.author._writing.compose import Composer
from oodscen.author._writing.ordinary_road_user import _LARGE, _SMALL
from oodscen.author._writing.ordinary_twin import OrdinaryAuthor
from oodscen.prompts._scenario.describe_path import STYLES

WORDING = Wording(openings=("x",), near=("x",), metres=("x",), near_ego=("x",), metres_ego=("x",))

APART = {
    "time": ({"day", "low_sun"}, {"twilight"}, {"night"}),
    "weather": (
        {"clear"},
        {"rain", "light_rain", "heavy_rain", "wet_road"},
        {"snow", "light_snow", "heavy_snow"},
        {"thick_fog", "fog", "mist"},
    ),
    "road": (
        {"residential"},
        {"urban", "signalised"},
        {"highway", "shoulder"},
        {"rural", "hill"},
        {"tunnel"},
        {"bridge"},
        {"coastal"},
        {"mountain"},
    ),
}
"""Of each kind, what cannot be claimed by one text together."""
AT_ODDS = (
    (r"rain\w*|drizzl\w*|wet (?:road|afternoon|night)", r"dry|sunny|blue sky|clear sky"),
    (r"snow(?:ing|flakes)|snowy|snow is falling", r"sunny|blue sky|green|dry"),
    (r"night|midnight|after dark", r"sunny|daylight|midday|blue sky|sunlight|green verges"),
    (r"mist|misty|light fog", r"from afar|far ahead|sunny|clear air|air is clear"),
    (r"windy?|gusty|gusts|blustery", r"still air|air is still|calm sea"),
    (r"motorway|highway|dual carriageway", r"pavement|kerb|houses|zebra|garden\w*|junction"),
    (r"country road|rural|farmland|countryside", r"pavement|kerb|zebra|bus stop|hard shoulder"),
    (r"residential|housing estate|terraced", r"ploughed|pasture|hard shoulder|farm\w*"),
    (r"one-way", r"oncoming lane|opposite lane|the other way|centre line"),
    (r"tunnel", r"verge|rain\w*|sunny|fields?|pavement"),
    (r"(?:road|river|two-lane) bridge|viaduct", r"verge|ploughed|beside the road"),
    (
        r"(?:one|a single) lane (?:each way|in each direction)|two-lane (?:rural|residential|country|suburban) \w+|"
        r"two-lane (?:road tunnel|tunnel|bridge|viaduct)",
        r"(?:next|neighbouring|adjacent|middle|overtaking|leftmost|fast|(?:left|right)(?:-hand)?) lane",
    ),
    (r"motorway|highway|dual carriageway", r"hedge|driveway|letterbox|parked cars?|centre line"),
    (r"motorway|highway|dual carriageway", r"oncoming (?:lorry|van|truck|traffic)"),
    (r"city street|avenue|boulevard|urban road", r"verge|meadow|pasture|barn|ditch"),
    (
        r"snow(?:ing|flakes)|snowy|snow is falling|falling snow",
        r"aquaplan\w*|umbrella|dust|hot day",
    ),
    (r"in fine weather|sunny|blue sky|overcast|at dusk|night", r"aquaplan\w*"),
    (r"(?:at|late at|after|it is|clear) night", r"night air"),
    (r"no other \w+ (?:nearby|in sight)|otherwise empty", r"a car|a van|lorry|the traffic|drivers"),
)
"""Words of one text of which the first rule out the second."""
BESIDES = re.compile(
    r"(?:from|on) a bridge|bridge above (?:the )?road|railway bridge|no other \w+ will|after a frosty night",
    re.IGNORECASE,
)
"""What names a place or a time at which the text does not happen."""


def contradictions(text: str) -> Iterator[str]:
    text = BESIDES.sub("", text)
    for word in ("night", "dusk", "dawn", "rain", "snow is falling", "clear"):
        if len(re.findall(rf"\b{word}\b", text, re.IGNORECASE)) > 1:
            yield f"{word} is said twice"
    said: dict[str, set[str]] = {}
    for claim in read_claims(text):
        said.setdefault(claim.kind, set()).add(claim.value)
    for kind, groups in APART.items():
        told = [group & said.get(kind, set()) for group in groups]
        if sum(map(bool, told)) > 1:
            yield f"{kind}: {' and '.join(sorted(set().union(*told)))}"
    for first, second in AT_ODDS:
        one = re.search(rf"\b(?:{first})\b", text, re.IGNORECASE)
        other = one and re.search(rf"\b(?:{second})\b", text, re.IGNORECASE)
        if one and other:
            yield f"{one[0]!r} and {other[0]!r}"


@pytest.fixture(scope="module")
def pairs(knowledge: Knowledge, recogniser: Recogniser) -> list[tuple[str, str]]:
    """Texts of all kinds and styles, each with its twin."""
    found = []
    composer, twins = Composer(knowledge), OrdinaryAuthor(knowledge, recogniser)
    for number, hazard in enumerate(knowledge.hazards):
        for turn, style in enumerate((STYLES[number % len(STYLES)], "natural")):
            text = composer.text(hazard, stream(turn, hazard.id), style)
            found.append((text, twins.twin(text, hazard.label, stream(turn, text))))
    return found


def test_no_text_and_no_twin_contradicts_itself(pairs: list[tuple[str, str]]) -> None:
    texts = [text for pair in pairs for text in pair]
    assert len(texts) >= 1_000
    assert [(found, text) for text in texts for found in contradictions(text)] == []


@pytest.mark.parametrize(
    ("text", "is_at_odds"),
    [
        ("In a steady drizzle on a two-lane rural road, the lane ahead is clear and dry.", True),
        ("It is a clear night. On a sunny day, ego drives on.", True),
        ("On a motorway with two lanes per direction, a cat sits on the pavement.", True),
        ("With no other vehicle in sight, a car drives ahead.", True),
        ("Late at night the night air is clear.", True),
        ("On a dual carriageway, an oncoming lorry drifts over the centre line.", True),
        ("On a bridge with one lane each way, a rider falls in the next lane.", True),
        ("On a four-lane boulevard in steady rain, a car drives ahead.", False),
    ],
)
def test_contradictions_are_seen(text: str, is_at_odds: bool) -> None:
    assert bool(list(contradictions(text))) is is_at_odds


def test_twins_say_where_their_texts_are(
    pairs: list[tuple[str, str]], recogniser: Recogniser
) -> None:
    for text, twin in pairs:
        place, weather = recogniser.place(text), recogniser.conditions(text)
        if any(phrase.casefold() in text.casefold() for phrase in _told(place)):
            assert recogniser.place(twin) == place, (text, twin)
        stated = {c.key for c in weather if any(p in text for p in (*c.phrases, *c.statements))}
        assert stated <= {c.key for c in recogniser.conditions(twin)}, (text, twin)


def test_twins_vary(knowledge: Knowledge, pairs: list[tuple[str, str]]) -> None:
    told = [twin.casefold() for _, twin in pairs]
    phrases = [phrase for driving in knowledge.driving for phrase in driving.phrases]
    ends = [phrase.removeprefix("the ego vehicle ") for phrase in phrases]
    assert len(phrases) >= 40
    assert sum(any(end.casefold() in one for one in told) for end in ends) >= 30
    assert all(any(vehicle.clause in one for one in told) for vehicle in (*_LARGE, *_SMALL))


def test_words_clash_with_settings_only_where_they_do_not_belong() -> None:
    clash = Clash(words=("kerb*", "dry"), places=("highway",), conditions=("rain",), why="so")
    agreement = Agreement(
        Knowledge(clash=(clash,), hazards=(), places=(), conditions=(), wording=WORDING)
    )
    assert agreement.clashes("A kerbside van", PlaceAndTime(place="highway")) == ["'kerbside': so"]
    assert agreement.clashes("A dry road", PlaceAndTime(conditions=("night", "rain")))
    assert agreement.suits("Laundry is drying", PlaceAndTime(conditions=("rain",)))
    assert agreement.suits("A dry road", PlaceAndTime())
    assert agreement.suiting(["a dry road", "a road"], PlaceAndTime(conditions=("rain",))) == [
        "a road"
    ]


def _told(place: RoadKind | None) -> tuple[str, ...]:
    return place.phrases if place is not None else ()
