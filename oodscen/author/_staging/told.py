"""The content of a text, as far as staging heeds it."""

import re
from collections import Counter
from dataclasses import dataclass
from functools import cached_property

from oodscen._words.text import folded_words
from oodscen.author._knowledge.base import (
    BackgroundTraffic,
    Conditions,
    HazardKind,
    Recipe,
    RoadKind,
)
from oodscen.claims._things import Thing, mentions
from oodscen.data._claim import Claim

_DISTANCE = re.compile(r"(?<![\d.,])(\d{1,3}(?:\.\d{1,9})?)\s?(?:m|metres?|meters?)\b")


@dataclass(frozen=True)
class Told:
    """A text as it was understood."""

    text: str
    hazard: HazardKind
    recipe: Recipe
    """The recipe of the hazard."""
    place: RoadKind | None
    conditions: tuple[Conditions, ...]
    traffic: BackgroundTraffic | None
    claims: tuple[Claim, ...]

    @property
    def distance_m(self) -> float | None:
        """The first distance in the text, m."""
        match = _DISTANCE.search(self.text)
        return float(match.group(1)) if match else None

    @property
    def is_quiet(self) -> bool:
        """True if the text says that there is no other traffic."""
        return self.traffic is not None and self.traffic.key == "quiet"

    @property
    def is_followed(self) -> bool:
        """True if the text mentions a vehicle behind the ego."""
        return self.traffic is not None and self.traffic.key == "follower"

    @property
    def is_dense(self) -> bool:
        """True if the text asks for more road users than a recipe has."""
        return any(
            (claim.kind == "count" and claim.subject in ("vehicle", "car"))
            or (claim.kind == "traffic" and claim.value == "dense")
            for claim in self.claims
        )

    @cached_property
    def of_traffic(self) -> tuple[Thing, ...]:
        """The things that the text names as ordinary traffic."""
        phrases = self.traffic.phrases if self.traffic else ()
        words = folded_words(self.text)
        phrase = next((phrase for phrase in phrases if folded_words(phrase) in words), "")
        return tuple({mention.thing for mention in mentions(phrase)})

    @property
    def named(self) -> tuple[Thing, ...]:
        """The things that the text names, without those that it names only as ordinary traffic."""
        quotes = [claim.quote for claim in self.claims if claim.kind == "thing"]
        counts = Counter(mention.thing for quote in quotes for mention in mentions(quote))
        ordinary = self.of_traffic
        return tuple(thing for thing in counts if thing not in ordinary or counts[thing] > 1)
