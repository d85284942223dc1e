"""Selection of claims: those that do not give way to a more specific or a more certain one."""

from collections.abc import Iterator, Mapping

from oodscen.author._reading import phrases
from oodscen.data._claim import Claim, Kind

SIDES = frozenset({"from_left", "from_right"})
"""Motions that come from a side."""
CLEARING_PLACES = ("behind", "oncoming_lane", "left_lane", "right_lane", "clear_of_lane")
"""Places other than the ego's lane ahead."""
_STRONGER = {
    "rain": ("heavy_rain", "light_rain"),
    "snow": ("heavy_snow", "light_snow"),
    "fog": ("thick_fog",),
    "mist": ("fog", "thick_fog"),
    "wet_road": ("rain", "heavy_rain", "light_rain"),
    "junction": ("t_junction",),
    "day": ("night", "twilight"),
    "twilight": ("night",),
    "moving": ("crossing", "oncoming", "reversing", "slow", "into_lane", "from_left", "from_right"),
    "ahead": ("behind",),
    "red": ("all_on",),
    "green": ("all_on",),
}
"""Values that are not claimed beside a more specific value, or one that contradicts them and is more certain."""
_CROSSING = frozenset({"crossing", "into_lane", *SIDES})
"""Motions that lead through the ego's lane."""


def consistent(claims: Mapping[tuple[Kind, str, str], Claim]) -> Iterator[Claim]:
    """Yield the claims that go together, in order.

    Args:
        claims: All claims of a text, by kind, value and subject.
    """
    values = {(claim.subject, claim.value) for claim in claims.values()}
    crossing = {subject for subject, value in values if value in _CROSSING}
    present = {subject for kind, _, subject in claims if kind == "thing"}
    for claim in claims.values():
        subject = claim.subject
        if subject and subject not in present:
            continue
        if any((subject, value) in values for value in _STRONGER.get(claim.value, ())):
            continue
        if claim.value == "clear_of_lane":
            moving = claims.get(("motion", "moving", subject))
            leaves = moving is not None and phrases.context("leaves").match(moving.quote)
            if leaves or subject in crossing or (subject, "in_lane") in values:
                continue
        yield claim
