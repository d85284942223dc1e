"""Ids of the items of a benchmark: a scene, and its ordinary drives `<scene>~twin` and `<scene>~demand`."""

from typing import Literal

Kind = Literal["rare", "twin", "demand"]

_MARK = "~"
_ORDINARY: dict[str, Kind] = {"twin": "twin", "demand": "demand"}


def twin_id(scene_id: str) -> str:
    """Return the id of a scene's ordinary twin."""
    return f"{scene_id}{_MARK}twin"


def demand_id(scene_id: str) -> str:
    """Return the id of a scene's ordinary demand: ordinary traffic that asks for a reaction."""
    return f"{scene_id}{_MARK}demand"


def kind_of(item_id: str) -> Kind:
    """Return the kind of an item."""
    return _ORDINARY.get(item_id.rpartition(_MARK)[2], "rare") if _MARK in item_id else "rare"


def is_twin(item_id: str) -> bool:
    """Return whether an id belongs to an ordinary twin."""
    return kind_of(item_id) == "twin"


def is_ordinary(item_id: str) -> bool:
    """Return whether an id belongs to an ordinary drive, a twin or a demand."""
    return kind_of(item_id) != "rare"


def scene_of(item_id: str) -> str:
    """Return the id of the scene that an item is, or to which an ordinary drive belongs."""
    return item_id.rpartition(_MARK)[0] if is_ordinary(item_id) else item_id


def leaf_in(item_id: str) -> str:
    """Return the leaf that an item's id begins with, `fog` of `fog-003~twin`; the scene's id if it has no number."""
    scene = scene_of(item_id)
    leaf, _, number = scene.rpartition("-")
    return leaf if leaf and number[:1].isdecimal() else scene
