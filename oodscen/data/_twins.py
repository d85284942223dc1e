"""Ids of ordinary twins: the scene's id followed by `~twin`."""

_SUFFIX = "~twin"


def twin_id(scene_id: str) -> str:
    """Return the id of a scene's ordinary twin."""
    return f"{scene_id}{_SUFFIX}"


def is_twin(item_id: str) -> bool:
    """Return whether an id belongs to an ordinary twin."""
    return item_id.endswith(_SUFFIX)


def scene_of(item_id: str) -> str:
    """Return the scene id of an item, which is a scene or a twin."""
    return item_id.removesuffix(_SUFFIX)
