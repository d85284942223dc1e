"""Ids of ordinary drives: the scene's id followed by `~` and the kind, as in `~twin`."""

_MARK = "~"
_TWIN = "twin"
KINDS = (_TWIN, "demand")
"""The kinds of ordinary drives: a scene without its hazard, and one that asks for a reaction."""


def twin_id(scene_id: str) -> str:
    """Return the id of a scene's ordinary twin."""
    return f"{scene_id}{_MARK}{_TWIN}"


def is_twin(item_id: str) -> bool:
    """Return whether an id belongs to an ordinary twin."""
    return ordinary_kind(item_id) == _TWIN


def ordinary_kind(item_id: str) -> str:
    """Return the kind of an ordinary drive (`twin` ...); empty for a scene."""
    kind = item_id.rpartition(_MARK)[2]
    return kind if kind in KINDS and _MARK in item_id else ""


def scene_of(item_id: str) -> str:
    """Return the id of the scene that an item is, or that an ordinary drive belongs to."""
    return item_id.rpartition(_MARK)[0] if ordinary_kind(item_id) else item_id
