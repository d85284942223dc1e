"""Checks of an actor's details against the asset, the things and the poses of a simulator."""

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING

from oodscen._words.text import first_few
from oodscen.data._base import ROUNDING
from oodscen.data._category import Category
from oodscen.data._details import AssetDetails, DetailKinds, Details, Size, posed
from oodscen.errors import Issue, close_matches

if TYPE_CHECKING:
    from oodscen.data._catalogue import Asset
    from oodscen.data._designs.prop import Prop

HELD_M: Size = (3.3, 2.2, 2.2)
"""Greatest length, width and height of what a person can hold, m; the length is the longer side."""
HELD_KG = 60.0
"""Greatest mass of a thing made to order that a person can hold, kg."""
LOADABLE: frozenset[Category] = frozenset({"object", "work_zone", "vegetation"})
"""Categories of what can be held or loaded; what moves by itself is an actor of its own."""
_LOADABLE_WORDS = "things that do not move by themselves"
LOAD_HEIGHT_M = 3.0
"""Greatest height of a load, m."""
_MOST_NAMED = 40
"""Number of names up to which a message lists all of them."""


def check_details(
    details: Details,
    asset: "Asset",
    behaviour: str,
    things: "Mapping[str, Asset]",
    kinds: DetailKinds,
    made: "Mapping[str, Prop]",
) -> list[Issue]:
    """Return an issue for every detail that an asset cannot show.

    Args:
        details: The details of an actor.
        asset: Its asset.
        behaviour: The built-in behaviour that it has, or that stands in for its own.
        things: All assets by id, with those made to order.
        kinds: The poses and parts of the simulator.
        made: The things made to order, by id.
    """
    offers = asset.offers or AssetDetails()
    holding = [kind.id for kind in kinds.poses if kind.grip and kind.id in offers.poses]
    can_show = {
        "pose": bool(offers.poses),
        "holds": bool(holding),
        "parts": bool(offers.parts),
        "colour": offers.is_painted,
        "cargo": offers.bed is not None,
        "text": offers.has_text,
    }
    issues = [
        Issue(name, f"{asset.id!r} cannot show it; {_offers(can_show)}")
        for name in details.given()
        if not can_show[name]
    ]
    if can_show["pose"]:
        issues += _pose_issues(details, offers, behaviour, kinds, holding)
    if can_show["parts"]:
        issues += [
            Issue(f"parts[{index}]", unknown_words("part", name, offers.parts))
            for index, name in enumerate(details.parts)
            if name not in offers.parts
        ]
    if details.holds and can_show["holds"]:
        issues += _thing_issues("holds", details.holds, things, HELD_M, made)
    if details.cargo and offers.bed is not None:
        room = (offers.bed.length, offers.bed.width, LOAD_HEIGHT_M)
        issues += _thing_issues("cargo", details.cargo, things, room, {})
    return issues


def _pose_issues(
    details: Details,
    offers: AssetDetails,
    behaviour: str,
    kinds: DetailKinds,
    holding: Collection[str],
) -> Iterator[Issue]:
    """Yield the faults of a person's pose; `holding` are the poses in which it can hold a thing."""
    name = posed(details)
    if details.pose and name not in offers.poses:
        yield Issue("pose", unknown_words("pose", name, offers.poses))
        return
    pose = kinds.pose(name)
    if pose is not None and pose.is_still and behaviour not in ("stand", "fall"):
        message = f"a person in the pose {name!r} stays in place: the behaviour must be 'stand'"
        yield Issue("pose", message)
    if details.holds and holding and name not in holding:
        message = f"things are held in the poses {', '.join(holding)}, not in {name!r}"
        yield Issue("holds", message)


def _thing_issues(
    path: str, name: str, things: "Mapping[str, Asset]", room: Size, made: "Mapping[str, Prop]"
) -> Iterator[Issue]:
    """Yield the faults of a thing that is held or loaded: its kind, size and mass."""
    thing = things.get(name)
    if thing is None:
        loadable = [other.id for other in things.values() if other.category in LOADABLE]
        yield Issue(path, unknown_words("asset", name, loadable))
        return
    if thing.category not in LOADABLE:
        message = f"{name!r} is of the category {thing.category}, an actor of its own; this is for {_LOADABLE_WORDS}"
        yield Issue(path, message)
    width, length = sorted((thing.length, thing.width))
    extents = (length, width, thing.height)
    if any(extent > most + ROUNDING for extent, most in zip(extents, room, strict=True)):
        size, limits = (f"{a:g} x {b:g} x {c:g} m" for a, b, c in (extents, room))
        yield Issue(path, f"{name!r} is {size}, at most {limits} fit")
    prop = made.get(name)
    if prop is not None and prop.mass_kg > HELD_KG:
        yield Issue(path, f"{name!r} has {prop.mass_kg:g} kg, and a person holds {HELD_KG:g} kg")


def _offers(can_show: Mapping[str, bool]) -> str:
    """Return the details that an asset can show, for a message."""
    offered = [name for name, is_offered in can_show.items() if is_offered]
    return f"it can show: {', '.join(offered)}" if offered else "it has one look"


def unknown_words(noun: str, name: str, allowed: Collection[str]) -> str:
    """Return the message about an unknown name, with close matches or the names that are allowed, a few of many."""
    hint = "there are none"
    if matches := close_matches(name, allowed):
        hint = f"did you mean {' or '.join(matches)}?"
    elif len(allowed) > _MOST_NAMED:
        hint = f"known are {len(allowed)}: {first_few(list(allowed))}"
    elif allowed:
        hint = f"known: {', '.join(allowed)}"
    return f"unknown {noun} {name!r}; {hint}"
