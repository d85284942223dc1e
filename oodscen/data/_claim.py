"""Claims that a text makes about a scene."""

from collections.abc import Mapping
from typing import Literal

from pydantic import Field, model_validator

from oodscen.data._base import Data

Kind = Literal[
    "weather",
    "time",
    "road",
    "lanes",
    "own_lanes",
    "ego",
    "traffic",
    "thing",
    "count",
    "place",
    "distance",
    "motion",
    "state",
    "speed",
    "ego_speed",
]

VALUES: Mapping[str, Mapping[str, str]] = {
    "weather": {
        "clear": "clear or fine: no rain, snow or fog, little cloud",
        "cloudy": "much cloud",
        "dry": "neither rain nor snow",
        "rain": "rain of whatever intensity",
        "light_rain": "drizzle or light rain",
        "heavy_rain": "heavy or torrential rain",
        "snow": "falling snow",
        "light_snow": "a little snow is falling",
        "heavy_snow": "heavy snowfall, a blizzard",
        "fog": "fog",
        "thick_fog": "thick or dense fog",
        "mist": "mist or haze",
        "wet_road": "a wet road",
        "slippery_road": "ice, packed snow, or little grip for another reason",
    },
    "time": {
        "day": "daylight",
        "night": "night, darkness",
        "twilight": "dusk, dawn, about sunset or sunrise",
        "low_sun": "the sun stands low",
    },
    "road": {
        "urban": "in a city",
        "residential": "in a residential area",
        "rural": "in the country",
        "highway": "a motorway, highway or expressway",
        "junction": "there is a junction ahead",
        "t_junction": "a side street joins",
        "signalised": "a junction with traffic lights",
        "roundabout": "there is a roundabout",
        "tunnel": "in or before a tunnel",
        "bridge": "on or before a bridge",
        "hill": "a hill, slope or crest",
        "curve": "a bend",
        "one_way": "one-way",
        "two_way": "has oncoming lanes",
        "divided": "carriageways are divided",
        "shoulder": "has a hard shoulder",
        "level_crossing": "crosses a railway",
        "coastal": "by the sea",
        "mountain": "in the mountains",
    },
    "ego": {
        "left_lane": "the ego drives in the leftmost lane",
        "right_lane": "in the rightmost lane",
        "middle_lane": "in a lane between others",
        "turns_left": "the ego turns left",
        "turns_right": "the ego turns right",
    },
    "traffic": {
        "none": "nobody else is on the road",
        "dense": "heavy traffic, rush hour, a jam",
    },
    "thing": {"present": "it is there"},
    "place": {
        "ahead": "ahead of the ego",
        "behind": "behind the ego",
        "in_lane": "in the ego's lane, or in its path",
        "clear_of_lane": "beside the ego's lane or the road: the ego can pass",
        "left": "to the left of the ego's lane",
        "right": "to the right of the ego's lane",
        "left_lane": "in a lane to the left of the ego's, oncoming ones counted",
        "right_lane": "in a lane to the right of the ego's",
        "oncoming_lane": "in a lane for oncoming traffic",
    },
    "motion": {
        "stationary": "it does not move",
        "moving": "it moves, at least after a while",
        "slow": "it drives much more slowly than usual",
        "oncoming": "it moves against the ego's direction",
        "same_way": "it moves in the ego's direction",
        "crossing": "it moves across the road",
        "from_left": "it comes from the left",
        "from_right": "it comes from the right",
        "into_lane": "it gets into the ego's lane, where it was not",
        "out_of_lane": "it leaves the ego's lane",
        "reversing": "it drives backwards",
        "braking": "it slows down or stops",
    },
    "state": {
        "off": "lamps or signals are off",
        "hazard": "hazard lights are on",
        "beacon": "blue lights or a beacon are on",
        "red": "a red signal",
        "green": "a green signal",
        "amber": "an amber signal",
        "flashing": "a signal that flashes",
        "all_on": "several colours of one signal at once",
        "closed": "a gate or barrier is down",
        "open": "a gate or barrier is up",
        "lying": "a person lies",
        "sitting": "a person sits on the ground",
        "kneeling": "a person kneels",
        "crouching": "a person crouches",
        "crawling": "a person crawls",
        "waving": "a person waves",
        "stopping": "a person holds up a hand",
        "pointing": "a person points",
        "pushing": "a person pushes",
        "pulling": "a person pulls",
        "carrying": "a person holds something",
        "doors_open": "a vehicle's doors are open",
        "bonnet_open": "its bonnet is open",
        "boot_open": "its boot or rear doors are open",
        "damaged": "it is crushed",
        "dirty": "it is muddy",
    },
}
"""Allowed values of each kind of claim, and their meanings; the kinds in `NUMBERS` have none."""

NUMBERS: Mapping[str, str] = {
    "lanes": "lanes of the road in all",
    "own_lanes": "lanes in the ego's direction",
    "count": "at least so many of a thing",
    "distance": "metres from the ego to a thing",
    "speed": "km/h at which a thing moves",
    "ego_speed": "km/h at which the ego drives",
}
"""Kinds of claims with a numeric value, and the meaning of the number."""

OF_THINGS = frozenset({"thing", "count", "place", "distance", "motion", "state", "speed"})
"""Kinds of claims about a thing, which the subject names."""


class Claim(Data):
    """One thing that a text says and a scene can contradict."""

    kind: Kind
    value: str = Field(max_length=40)
    """One of `VALUES`, or a number."""
    subject: str = Field(default="", max_length=80)
    """Noun phrase of the thing that the claim is about: `cardboard box`; numbered where there are two, `car 2`."""
    quote: str = Field(default="", max_length=200)
    """The words of the text that say so."""

    @model_validator(mode="after")
    def _is_in_vocabulary(self) -> "Claim":
        if self.kind in NUMBERS:
            is_whole = self.value.isascii() and self.value.isdecimal()
            if not is_whole or not 0 < int(self.value) <= 1000:
                raise ValueError(f"{self.kind}: {self.value!r} is no whole number from 1 to 1000")
        elif self.value not in VALUES[self.kind]:
            allowed = ", ".join(VALUES[self.kind])
            raise ValueError(f"{self.kind}: {self.value!r} is not one of {allowed}")
        if (self.kind in OF_THINGS) != bool(self.subject.strip()):
            rule = "needs a subject" if self.kind in OF_THINGS else "has no subject"
            raise ValueError(f"a claim of kind {self.kind} {rule}")
        return self

    def __str__(self) -> str:
        if self.kind in NUMBERS:
            meaning = f"{NUMBERS[self.kind]}: {self.value}"
        else:
            meaning = VALUES[self.kind][self.value]
        quote = f" ({self.quote!r})" if self.quote else ""
        return f"{self.subject.strip() or self.kind}: {meaning}{quote}"


class Mismatch(Data):
    """A claim of the text that the scene contradicts."""

    claim: Claim
    found: str
    """The scene's actual content."""
    path: str = ""
    """Path of the contradiction in the scene."""

    def __str__(self) -> str:
        return f"the text says {self.claim}, but {self.found}"
