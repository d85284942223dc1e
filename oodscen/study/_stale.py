"""Episodes that no longer belong to their scenes, since a scene was changed and not run again."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from oodscen.data._base import digest
from oodscen.data._episode import Episode
from oodscen.data._pairing import scene_of
from oodscen.data._scene import Scene
from oodscen.errors import UsageError

if TYPE_CHECKING:
    from oodscen.study._study import Study

_SHOWN = 5
"""Scenes that are named."""


def stale_scenes(
    episodes: Iterable[Episode], scenes: Iterable[Scene], staged: Iterable[Mapping[str, Any]]
) -> list[str]:
    """Return the ids of the scenes that are not those of their episodes, in the order of the episodes.

    The episodes of a scene and of its ordinary drives were made from the scene, and that of a demand from the demand
    as well. Episodes that do not say what they were made from are taken as they are.

    Args:
        episodes: Those of scenes, ordinary drives and demands.
        scenes: The lines of `scenes.jsonl`, demands included.
        staged: The lines of `staged.jsonl`, which hold the demands as they were run.
    """
    now = {scene.id: scene.digest() for scene in scenes}
    demands = [line["demand"] for line in staged if isinstance(line.get("demand"), Mapping)]
    ran = {one.get("id"): digest(one) for one in demands}
    found = dict[str, None]()
    for one in episodes:
        name = scene_of(one.scene_id)
        is_own = now.get(name) == one.made_from
        is_own &= one.scene_id not in ran or now.get(one.scene_id) == ran[one.scene_id]
        if one.made_from and not is_own:
            found[name] = None
    return list(found)


def in_words(stale: list[str]) -> str:
    """Return the sentence about scenes that have changed."""
    more = ", ..." if len(stale) > _SHOWN else ""
    told = f"{len(stale)} scenes have" if len(stale) > 1 else "1 scene has"
    they = "they were" if len(stale) > 1 else "it was"
    return (
        f"{told} changed since {they} run: {', '.join(stale[:_SHOWN])}{more}; the same `oodscen run OUT` makes "
        "their episodes again"
    )


def refuse_stale(study: "Study", episodes: Iterable[Episode], scenes: Iterable[Scene]) -> None:
    """Refuse a study whose episodes are not those of its scenes, which come without the demands.

    Raises:
        UsageError: If a scene has changed since it was run.
        DataError: If a table is malformed.
    """
    lines = study.store.lines("staged.jsonl")
    if stale := stale_scenes(episodes, [*scenes, *study.demands], lines):
        raise UsageError(f"{study.folder}: {in_words(stale)}")
