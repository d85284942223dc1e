"""The items of a study that answerers are asked about."""

from collections.abc import Sequence

from oodscen._seeding import stream
from oodscen.data._episode import Episode
from oodscen.data._pairing import demand_id, is_ordinary, scene_of, twin_id


def ordinary_drives(scene_id: str, *, seed: int) -> tuple[str, str]:
    """Return the ids of a scene's ordinary drives, in the order in which they are asked about."""
    both = (twin_id(scene_id), demand_id(scene_id))
    return both[::-1] if stream(seed, "ordinary", scene_id).integers(2) else both


def choose_items(episodes: Sequence[Episode], *, count: int, seed: int) -> list[Episode]:
    """Return the scenes, each with `count` of its ordinary drives.

    With one, a draw by seed and scene takes the twin or the demand, so that every other ordinary drive asks
    for a reaction; where only one of them ran, that one goes with the scene.
    """
    there = {episode.scene_id for episode in episodes}
    ran = {episode.scene_id for episode in episodes if episode.status == "ok"}

    def is_taken(item: str) -> bool:
        if count > 1 or not is_ordinary(item):
            return True
        both = ordinary_drives(scene_of(item), seed=seed)
        return item == min(both, key=lambda one: (one not in ran, one not in there))

    return [episode for episode in episodes if is_taken(episode.scene_id)]
