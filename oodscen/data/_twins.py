"""Ids of ordinary twins: a scene's id and `~twin`."""

_SUFFIX = "~twin"


def twin_id(scene_id: str) -> str:
    """Return the id of a scene's ordinary twin."""
    return f"{scene_id}{_SUFFIX}"


def is_twin(item_id: str) -> bool:
    """Whether an id belongs to an ordinary twin."""
    return item_id.endswith(_SUFFIX)


def scene_of(item_id: str) -> str:
    """Return the id of the scene that an item is, or is the twin of."""
    return item_id.removesuffix(_SUFFIX)
