"""Scenes that no longer belong to their episodes: one of them, or a text, was changed or removed and not run again."""

from collections.abc import Container, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from oodscen._words.text import first_few
from oodscen.data._base import digest
from oodscen.data._episode import Episode
from oodscen.data._pairing import scene_of
from oodscen.data._scene import Scene
from oodscen.errors import UsageError
from oodscen.study._files import ClaimsLine
from oodscen.study._made import NOTHING, made_for
from oodscen.study._staging import text_digest

if TYPE_CHECKING:
    from oodscen.study._study import Study


def stale_scenes(
    episodes: Iterable[Episode],
    scenes: Iterable[Scene],
    staged: Iterable[Mapping[str, Any]],
    changed: Container[str] = (),
) -> list[str]:
    """Return the ids of the scenes that are not those of their episodes, in their order, and of those without theirs.

    The episodes of a scene and of its ordinary drives were made from the scene, and that of a demand from the demand
    as well. Episodes that do not say what they were made from are taken as they are.

    Args:
        episodes: Those of scenes, ordinary drives and demands.
        scenes: The lines of `scenes.jsonl`, demands included.
        staged: The lines of `staged.jsonl`, which hold the demands as they were run.
        changed: The ids of scenes whose texts have changed.
    """
    now = {scene.id: scene.digest() for scene in scenes}
    staged, episodes = list(staged), list(episodes)
    demands = [line["demand"] for line in staged if isinstance(line.get("demand"), Mapping)]
    run_demands = {demand.get("id"): digest(demand) for demand in demands}

    def is_stale(episode: Episode) -> bool:
        name = scene_of(episode.scene_id)
        if name in changed:
            return True
        if not episode.made_from:
            return False
        demand = run_demands.get(episode.scene_id)
        is_same_demand = demand is None or now.get(episode.scene_id) == demand
        return now.get(name) != episode.made_from or not is_same_demand

    stale = [scene_of(episode.scene_id) for episode in episodes if is_stale(episode)]
    ran = {episode.scene_id for episode in episodes}
    names = (line.get("id") for line in staged if line.get("how") is not None)
    lost = (name for name in names if isinstance(name, str) and name not in ran)
    return list(dict.fromkeys([*stale, *lost]))


def changed_texts(study: "Study") -> set[str]:
    """Return the ids of the scenes whose text is gone, or is not what they were staged from.

    A text is its words, its path, its leaf, its claims and the designs made for it. What a study has no record of is
    taken as it is.

    Raises:
        DataError: If a table or the tree is malformed.
    """
    store = study.store
    texts = {scenario.id: scenario for scenario in study.scenarios}
    claims = {str(line.get("id")): line for line in store.lines("claims.jsonl")}
    has_tree = store.holds("tree.simulatable.json")
    paths = study.tree("simulatable").paths if has_tree else None
    made = made_for(study) if has_tree else {}
    changed = set[str]()
    staged = {str(line.get("id")): line for line in store.lines("staged.jsonl")}
    for name, line in staged.items():
        text, claims_line = texts.get(name), claims.get(name)
        if text is None or (paths is not None and paths.get(text.leaf) != text.path):
            changed.add(name)
        elif claims_line is not None and line.get("made_from"):
            text_claims = None
            if claims_line.get("status") != "failed":
                source = f"{store.path('claims.jsonl')}, {name}"
                text_claims = ClaimsLine.parse(claims_line, source=source).claims
            designs = made.get(text.path, NOTHING).digests()
            if text_digest(text, text_claims, designs) != line["made_from"]:
                changed.add(name)
    return changed


def in_words(stale: list[str]) -> str:
    """Return the sentence about scenes that have changed or are gone, themselves, their texts or their episodes."""
    subject, pronoun = "1 scene, or its text, has", "it was"
    if len(stale) > 1:
        subject, pronoun = f"{len(stale)} scenes, or their texts, have", "they were"
    return (
        f"{subject} changed or been removed since {pronoun} run: {first_few(stale)}; "
        "the same `oodscen run OUT` makes their episodes again"
    )


def refuse_stale(study: "Study", episodes: Iterable[Episode], scenes: Iterable[Scene]) -> None:
    """Refuse a study whose episodes are not those of its scenes and texts; the scenes come without the demands.

    Raises:
        UsageError: If a scene or its text has changed, or it or its episode was removed, since it was run.
        DataError: If a table is malformed.
    """
    lines = study.store.lines("staged.jsonl")
    if stale := stale_scenes(episodes, [*scenes, *study.demands], lines, changed_texts(study)):
        raise UsageError(f"{study.folder}: {in_words(stale)}")
