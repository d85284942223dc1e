"""The calls of the best shortcut as verdicts, for the leaderboard."""

from collections.abc import Mapping

from oodscen.data._verdict import Verdict, verdict_id
from oodscen.judging._items import Items
from oodscen.judging._shortcuts.rules import best_rule

Calls = tuple[str, Mapping[str, bool]]
"""The name of a shortcut, and by item whether it calls it out of the ordinary."""


def rule_calls(items: Items) -> Calls | None:
    """Return the calls of the best rule on the bodies that the simulator knows; `None` without two paths."""
    found = best_rule(items)
    if found is None:
        return None
    guess, there = found
    names = [one.scene_id for one, is_there in zip(items.episodes, there, strict=True) if is_there]
    return guess.name, dict(zip(names, map(bool, guess.is_called), strict=True))


def shortcut_verdicts(items: Items, calls: Calls | None) -> list[Verdict]:
    """Return the calls as verdicts of a reference, which has no action and names nothing."""
    if calls is None:
        return []
    name, by_item = calls
    model = f"shortcut: {name}"
    return [
        Verdict(
            id=verdict_id(item, model),
            scene_id=item,
            model=model,
            kind="reference",
            is_ordinary=not items.is_scene[items.index[item]],
            is_ood=is_called,
        )
        for item, is_called in by_item.items()
        if item in items.index
    ]
