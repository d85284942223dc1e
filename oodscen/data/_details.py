"""Details of an actor: the pose of a person and what it holds; the parts, colour and load of a vehicle."""

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import (
    AfterValidator,
    Field,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
)

from oodscen.data._base import ROUNDING, Data, LeanData
from oodscen.data._category import Category
from oodscen.data._colours import LIT, rgb_of, unknown_colour
from oodscen.errors import Issue, close_matches

if TYPE_CHECKING:
    from oodscen.data._catalogue import Asset
    from oodscen.data._prop import Prop

Size = tuple[float, float, float]
"""Length, width and height, m."""
Extent = Annotated[float, Field(gt=0, le=30)]
Word = Annotated[str, Field(pattern=r"^([a-z][a-z0-9_]{0,39})?$")]

HELD_M: Size = (2.2, 3.3, 2.2)
"""Greatest lesser and greater extent along the ground, and height, of what a person can hold, m."""
HELD_KG = 60.0
"""Greatest mass of a thing made to order that a person can hold, kg."""
LOADABLE: frozenset[Category] = frozenset({"object", "work_zone", "vegetation"})
"""Categories of what can be held or loaded; what moves by itself is an actor of its own."""
_LOADABLE_WORDS = "things that do not move by themselves"
_LOW_M = 0.12
"""Least height of a held thing above the ground, m."""
_TALL_M = 1.0
"""Height from which a thing is held at its middle, m."""


def _known_colour(name: str) -> str:
    if name and (rgb_of(name) is None or name.startswith(LIT)):
        raise unknown_colour(name)
    return name


class Details(LeanData):
    """The look of one actor beyond its asset and state; what is empty is as usual."""

    _left_out: ClassVar = ("pose", "holds", "parts", "colour", "cargo", "text")

    pose: Word = ""
    """A pose of a person, such as `kneel`."""
    holds: Word = ""
    """Id of the asset, or of the thing made to order, in a person's hands."""
    parts: tuple[Word, ...] = Field(default=(), max_length=6)
    """States of parts of a vehicle, such as `bonnet_open`."""
    colour: Annotated[str, Field(max_length=20), AfterValidator(_known_colour)] = ""
    """Paint of a vehicle: a name or `#rrggbb`."""
    cargo: Word = ""
    """Id of the asset, or of the thing made to order, on a vehicle's roof or bed."""
    text: str = Field(default="", max_length=16, pattern=r"^([A-Z0-9][A-Z0-9 .!?-]*)?$")
    """Capitals on both sides of a vehicle."""

    @field_validator("parts")
    @classmethod
    def _sorted(cls, parts: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(sorted(set(parts) - {""}))

    def __bool__(self) -> bool:
        return bool(self.words())

    def given(self) -> Iterator[str]:
        """Yield the names of the details that are not as usual."""
        return (name for name in self._left_out if getattr(self, name))

    def words(self) -> tuple[str, ...]:
        """Return the details in the order of the fields, each as it is given."""
        one = (self.pose, self.holds, *self.parts, self.colour, self.cargo, self.text)
        return tuple(word for word in one if word)


class Grip(Data):
    """The hands of a pose: where they are, and how they hold a thing."""

    how: Literal["before", "above", "beside"]
    """`before` the body in both hands, `above` the head in both, or hanging `beside` from the right."""
    at: tuple[float, float, float]
    """Middle of the hands of an adult, m: x forward and y left of the pose's box's middle, z up."""


class PoseKind(Data):
    """A pose or a gesture of people."""

    id: Word
    doing: str
    """The visible activity: `waving traffic on`."""
    tags: tuple[str, ...] = ()
    """Words by which a person in this pose is known: `lying` ..."""
    is_still: bool = False
    """True if who is in it does not move along."""
    is_aside: bool = False
    """True if it is seen best from the side, and not from ahead."""
    is_backwards: bool = False
    """True if the person faces the way that it comes from."""
    grip: Grip | None = None
    """Left out if the hands hold nothing."""


class PartKind(Data):
    """A state of a vehicle's part."""

    id: Word
    seen: str
    """The visible state: `with its bonnet open`."""
    tags: tuple[str, ...] = ()
    is_ahead: bool = False
    """True if it is seen from ahead of the vehicle, and not from behind."""


class DetailKinds(Data):
    """The poses and states of parts that a simulator can draw."""

    poses: tuple[PoseKind, ...] = ()
    parts: tuple[PartKind, ...] = ()

    def pose(self, name: str) -> PoseKind | None:
        """Return a pose by id, `None` if it is unknown."""
        return next((pose for pose in self.poses if pose.id == name), None)


class Bed(Data):
    """The roof or bed of a vehicle that carries a load."""

    at: tuple[float, float]
    """x and z of the middle of the load's underside, m."""
    length: Extent
    """Greatest length of a load, m."""
    width: Extent


class AssetDetails(Data):
    """The details that one asset can show."""

    poses: dict[Word, tuple[Extent, Extent, Extent]] = {}
    """Length, width and height of the body in each pose, m."""
    scale: float = Field(default=1.0, gt=0.2, le=2)
    """Size against an adult, for the place of the hands."""
    parts: dict[Word, tuple[Extent, Extent, Extent]] = {}
    """Length, width and height with the part in each state, m."""
    is_painted: bool = False
    """True if its colour can be chosen."""
    bed: Bed | None = None
    """Left out if it carries no load."""
    has_text: bool = False
    """True if its sides can carry a text."""

    @model_serializer(mode="wrap")
    def _lean(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        value: dict[str, Any] = serialise(self)
        usual = {name: field.default for name, field in type(self).model_fields.items()}
        return {name: one for name, one in value.items() if one != usual[name]}


class Held(Data):
    """The place of a held thing in the frame of a person's box."""

    noun: ClassVar[str] = "held thing"

    at: tuple[float, float, float]
    """Middle of the thing's underside, m."""
    is_turned: bool
    """True if the thing is turned by a quarter, so that it is held by its long side."""


def held_place(grip: Grip, scale: float, size: Size) -> Held:
    """Return the place of a thing in a person's hands.

    Args:
        grip: The hands.
        scale: The size of the person against an adult.
        size: Length, width and height of the thing, m.
    """
    length, width, height = size
    x, y, z = (scale * value for value in grip.at)
    if grip.how == "beside":
        low = max(_LOW_M, z - height) if height <= _TALL_M else _LOW_M
        return Held(at=(x, y - 0.3 * min(length, width), low), is_turned=width > length)
    thin = min(length, width)
    if grip.how == "above":
        return Held(at=(x, y, z), is_turned=length > width)
    low = max(_LOW_M, z - height / 2) if height > _TALL_M else z - 0.04
    return Held(at=(x + thin / 2 - 0.02, y, low), is_turned=length > width)


def shown_as(
    asset: "Asset", details: Details, things: "Mapping[str, Asset]", kinds: DetailKinds
) -> "Asset":
    """Return an asset with the size and the words that it has with its details.

    Args:
        asset: The asset of the actor.
        details: The actor's details; those that the asset does not offer are ignored.
        things: Assets by id, for what is held or loaded.
        kinds: The poses and parts of the simulator.
    """
    offers = asset.offers or AssetDetails()
    pose = kinds.pose(posed(details))
    size = _own_size(asset, offers, details, pose)
    held, load = things.get(details.holds), things.get(details.cargo)
    if held is not None and pose is not None and pose.grip is not None:
        size = _with_held(size, held, pose.grip, offers.scale)
    if load is not None and offers.bed is not None:
        size = _with_load(size, load, offers.bed)
    length, width, height = size
    told = [] if pose is None else [pose.id, *pose.tags]
    for part in kinds.parts:
        if part.id in details.parts:
            told += [part.id, *part.tags]
    return asset.model_copy(
        update={
            "length": round(length, 2),
            "width": round(width, 2),
            "height": round(height, 2),
            "tags": tuple(dict.fromkeys((*asset.tags, *told))),
            "description": described(asset.description, details, things, kinds),
        }
    )


def _own_size(
    asset: "Asset", offers: AssetDetails, details: Details, pose: PoseKind | None
) -> Size:
    """Return the size of an actor in its pose, with its parts in their states."""
    sizes = [(asset.length, asset.width, asset.height)]
    if pose is not None and pose.id in offers.poses:
        sizes = [offers.poses[pose.id]]
    sizes += [offers.parts[name] for name in details.parts if name in offers.parts]
    length, width, height = map(max, zip(*sizes, strict=True))
    return length, width, height


def _with_held(size: Size, held: "Asset", grip: Grip, scale: float) -> Size:
    """Return the size of a person's box, grown around a thing in the hands."""
    length, width, height = size
    place = held_place(grip, scale, (held.length, held.width, held.height))
    x, y, z = place.at
    deep, wide = (held.width, held.length) if place.is_turned else (held.length, held.width)
    return (
        max(length / 2, x + deep / 2) + max(length / 2, deep / 2 - x),
        2 * max(width / 2, abs(y) + wide / 2),
        max(height, z + held.height),
    )


def _with_load(size: Size, load: "Asset", bed: Bed) -> Size:
    length, width, height = size
    return (
        length,
        max(width, min(load.length, load.width)),
        max(height, bed.at[1] + load.height),
    )


def posed(details: Details) -> str:
    """Return the pose of a person: who holds something and has none carries it before the body."""
    return details.pose or ("carry" if details.holds else "")


def described(
    description: str, details: Details, things: "Mapping[str, Asset]", kinds: DetailKinds
) -> str:
    """Return a description of an asset together with its details."""
    told = [description]
    pose = kinds.pose(details.pose)
    if pose is not None:
        told.append(pose.doing)
    if details.holds in things:
        told.append(f"holding {things[details.holds].description}")
    if details.colour:
        told.append(f"painted {details.colour.replace('_', ' ')}")
    told += [part.seen for part in kinds.parts if part.id in details.parts]
    if details.cargo in things:
        told.append(f"carrying {things[details.cargo].description}")
    if details.text:
        told.append(f"with {details.text} written on its sides")
    return ", ".join(told)


# ---------------------------------------------------------------------- checks


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
    able = {
        "pose": bool(offers.poses),
        "holds": bool(offers.poses),
        "parts": bool(offers.parts),
        "colour": offers.is_painted,
        "cargo": offers.bed is not None,
        "text": offers.has_text,
    }
    issues = [
        Issue(name, f"{asset.id!r} cannot show it; {_able(able)}")
        for name in details.given()
        if not able[name]
    ]
    if able["pose"]:
        issues += _pose_issues(details, offers, behaviour, kinds)
    if able["parts"]:
        issues += [
            Issue(f"parts[{index}]", unknown_words("part", name, offers.parts))
            for index, name in enumerate(details.parts)
            if name not in offers.parts
        ]
    if details.holds and able["holds"]:
        issues += _thing_issues("holds", details.holds, things, HELD_M, made)
    if details.cargo and offers.bed is not None:
        room = (offers.bed.width, offers.bed.length, 3.0)
        issues += _thing_issues("cargo", details.cargo, things, room, {})
    return issues


def _pose_issues(
    details: Details, offers: AssetDetails, behaviour: str, kinds: DetailKinds
) -> Iterator[Issue]:
    name = posed(details)
    if name and name not in offers.poses:
        yield Issue("pose", unknown_words("pose", name, offers.poses))
        return
    pose = kinds.pose(name)
    if pose is None:
        return
    if pose.is_still and behaviour not in ("stand", "fall"):
        yield Issue("pose", f"who is in the pose {name!r} stays in place: the behaviour is 'stand'")
    if details.holds and pose.grip is None:
        able = ", ".join(kind.id for kind in kinds.poses if kind.grip and kind.id in offers.poses)
        yield Issue("holds", f"the hands are not free in the pose {name!r}, but in: {able}")


def _thing_issues(
    path: str, name: str, things: "Mapping[str, Asset]", room: Size, made: "Mapping[str, Prop]"
) -> Iterator[Issue]:
    thing = things.get(name)
    if thing is None:
        yield Issue(path, unknown_words("asset", name, things))
        return
    if thing.category not in LOADABLE:
        message = (
            f"{name!r} is a {thing.category} and an actor of its own; this is for {_LOADABLE_WORDS}"
        )
        yield Issue(path, message)
    ends = sorted((thing.length, thing.width))
    if any(size > most + ROUNDING for size, most in zip((*ends, thing.height), room, strict=True)):
        size = f"{ends[1]:g} x {ends[0]:g} x {thing.height:g} m"
        most = f"{room[1]:g} x {room[0]:g} x {room[2]:g} m"
        yield Issue(path, f"{name!r} is {size}, at most {most} fit")
    prop = made.get(name)
    if prop is not None and prop.mass_kg > HELD_KG:
        yield Issue(path, f"{name!r} has {prop.mass_kg:g} kg, and a person holds {HELD_KG:g} kg")


def _able(able: Mapping[str, bool]) -> str:
    offered = [name for name, is_able in able.items() if is_able]
    return f"it can show: {', '.join(offered)}" if offered else "it has one look"


def unknown_words(noun: str, name: str, known: Collection[str]) -> str:
    """Return the message about an unknown name, with close matches or all known names."""
    matches = close_matches(name, known)
    hint = f"known: {', '.join(known)}" if known else "there are none"
    if matches:
        hint = f"did you mean {' or '.join(matches)}?"
    return f"unknown {noun} {name!r}; {hint}"
