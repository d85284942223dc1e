"""Details of an actor: the pose of a person and what it holds; the parts, colour and load of a vehicle."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import (
    AfterValidator,
    Field,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
)

from oodscen.data._base import Data, LeanData
from oodscen.data._designs.colours import LIT, rgb_of, unknown_colour

if TYPE_CHECKING:
    from oodscen.data._catalogue import Asset

Size = tuple[float, float, float]
"""Length, width and height, m."""
Length = Annotated[float, Field(gt=0, le=30)]
Word = Annotated[str, Field(pattern=r"^([a-z][a-z0-9_]{0,39})?$")]

_LOW_M = 0.12
"""Least height of a held thing above the ground, m."""
_TALL_M = 1.0
"""Height from which a thing is held at its middle, m."""
_BELOW_HANDS_M = 0.04
"""Height of the hands above the underside of a thing in both hands, m."""
_BEHIND_HANDS_M = 0.02
"""Distance of the near side of a thing before the body behind the middle of the hands, m."""
_OUTWARDS = 0.3
"""Distance of the middle of a hanging thing from the hand, as a share of its shorter side."""


def _paint(name: str) -> str:
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
    colour: Annotated[str, Field(max_length=20), AfterValidator(_paint)] = ""
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
        """Return the values of the details in the order of the fields."""
        words = (self.pose, self.holds, *self.parts, self.colour, self.cargo, self.text)
        return tuple(word for word in words if word)


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
    length: Length
    """Greatest length of a load, m."""
    width: Length
    """Greatest width of a load, m."""


class AssetDetails(Data):
    """The details that one asset can show."""

    poses: dict[Word, tuple[Length, Length, Length]] = {}
    """Length, width and height of the body in each pose, m."""
    scale: float = Field(default=1.0, gt=0.2, le=2)
    """Size against an adult, for the place of the hands."""
    parts: dict[Word, tuple[Length, Length, Length]] = {}
    """Length, width and height with the part in each state, m."""
    is_painted: bool = False
    """True if its colour can be chosen."""
    bed: Bed | None = None
    """Left out if it carries no load."""
    has_text: bool = False
    """True if its sides can carry a text."""

    @model_serializer(mode="wrap")
    def _lean(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields = type(self).model_fields
        values = serialise(self).items()
        return {name: value for name, value in values if value != fields[name].default}


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
    shorter = min(length, width)
    x, y, z = (scale * value for value in grip.at)
    is_tall = height > _TALL_M
    match grip.how:
        case "before":
            x = x + shorter / 2 - _BEHIND_HANDS_M
            z -= height / 2 if is_tall else _BELOW_HANDS_M
        case "beside":
            y -= _OUTWARDS * shorter
            z = 0.0 if is_tall else z - height
    is_turned = width > length if grip.how == "beside" else length > width
    return Held(at=(x, y, max(_LOW_M, z)), is_turned=is_turned)


def shown_as(
    asset: "Asset", details: Details, things: "Mapping[str, Asset]", kinds: DetailKinds
) -> "Asset":
    """Return an asset with the size and the words that it has with its details.

    Args:
        asset: The asset of the actor.
        details: The actor's details; those that the asset does not offer do not change its size.
        things: Assets by id, for what is held or loaded.
        kinds: The poses and parts of the simulator.
    """
    offers = asset.offers or AssetDetails()
    pose = kinds.pose(posed(details))
    grip = pose.grip if pose is not None and pose.id in offers.poses else None
    size = _bare_size(asset, offers, details, pose)
    held, load = things.get(details.holds), things.get(details.cargo)
    if held is not None and grip is not None:
        size = _with_held(size, held, grip, offers.scale)
    if load is not None and offers.bed is not None:
        size = _with_load(size, load, offers.bed)
    length, width, height = size
    tags = [*asset.tags]
    if pose is not None:
        tags += [pose.id, *pose.tags]
    for part in kinds.parts:
        if part.id in details.parts:
            tags += [part.id, *part.tags]
    return asset.model_copy(
        update={
            "length": round(length, 2),
            "width": round(width, 2),
            "height": round(height, 2),
            "tags": tuple(dict.fromkeys(tags)),
            "description": described(asset.description, details, things, kinds),
        }
    )


def _bare_size(
    asset: "Asset", offers: AssetDetails, details: Details, pose: PoseKind | None
) -> Size:
    """Return the size of an actor in its pose, with its parts in their states, and nothing carried."""
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
    depth, breadth = held.length, held.width
    if place.is_turned:
        depth, breadth = breadth, depth
    return (
        max(length / 2, x + depth / 2) + max(length / 2, depth / 2 - x),
        2 * max(width / 2, abs(y) + breadth / 2),
        max(height, z + held.height),
    )


def _with_load(size: Size, load: "Asset", bed: Bed) -> Size:
    """Return the size of a vehicle's box, grown around a load that lies lengthwise."""
    length, width, height = size
    return (
        length,
        max(width, min(load.length, load.width)),
        max(height, bed.at[1] + load.height),
    )


def posed(details: Details) -> str:
    """Return the pose of a person; one that holds something and has no pose carries it."""
    return details.pose or ("carry" if details.holds else "")


def described(
    description: str, details: Details, things: "Mapping[str, Asset]", kinds: DetailKinds
) -> str:
    """Return a description of an asset together with its details."""
    phrases = [description]
    pose = kinds.pose(details.pose)
    if pose is not None:
        phrases.append(pose.doing)
    if details.holds in things:
        phrases.append(f"holding {things[details.holds].description}")
    if details.colour:
        phrases.append(f"painted {details.colour.replace('_', ' ')}")
    phrases += [part.seen for part in kinds.parts if part.id in details.parts]
    if details.cargo in things:
        phrases.append(f"carrying {things[details.cargo].description}")
    if details.text:
        phrases.append(f"with {details.text} written on its sides")
    return ", ".join(phrases)
