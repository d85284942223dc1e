"""The things and movements that dropped leaves lack, and the leaves' second judgement once these are made."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

from oodscen.data._additions import Addition
from oodscen.data._catalogue import Catalogue
from oodscen.data._category import Category
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.pruner import Pruner
from oodscen.tree._scenario_tree import ScenarioTree


class WantedThing(NamedTuple):
    """A thing that dropped leaves lack."""

    name: str
    category: Category
    path: tuple[str, ...]
    """Labels of the first leaf that lacks it."""


class WantedMotion(NamedTuple):
    """A movement that dropped leaves lack."""

    name: str
    path: tuple[str, ...]
    """Labels of the first leaf that lacks it."""
    categories: tuple[Category, ...]
    """Categories of the things that this leaf lacks besides; empty if it lacks none."""


def is_makeable(decision: PruneDecision) -> bool:
    """Return whether a dropped leaf lacks nothing but things and movements, which can be made."""
    lacks = _without_states(decision)
    return (
        not decision.keep
        and decision.status == "ok"
        and not decision.made
        and bool(lacks)
        and all(lack.kind in ("asset", "behaviour") for lack in lacks)
    )


def _without_states(decision: PruneDecision) -> tuple[Addition, ...]:
    """Return what a leaf lacks, without the states of things that it lacks: the design of a thing gives its states."""
    assets = {lack.name for lack in decision.lacks if lack.kind == "asset"}
    return tuple(
        lack
        for lack in decision.lacks
        if lack.kind != "state" or lack.name.partition(":")[0] not in assets
    )


def additions_to_make(decision: PruneDecision) -> tuple[Addition, ...]:
    """Return what is to be made for a leaf, or was made for it."""
    return _without_states(decision) if is_makeable(decision) else decision.made_as


def _in_order(tree: ScenarioTree, decisions: Iterable[PruneDecision]) -> Iterator[PruneDecision]:
    """Yield the decisions about leaves of a tree in the tree's order."""
    by_id = {decision.id: decision for decision in decisions}
    yield from (by_id[leaf.id] for leaf in tree.leaves if leaf.id in by_id)


def wanted_things(
    tree: ScenarioTree, decisions: Iterable[PruneDecision], catalogue: Catalogue
) -> list[WantedThing]:
    """Return the things whose making may restore dropped leaves, each once, in the order of the tree."""
    assets = {asset.id for asset in catalogue.assets}
    things: dict[str, WantedThing] = {}
    for decision in _in_order(tree, decisions):
        for addition in additions_to_make(decision):
            if addition.kind == "asset" and is_id(addition) and addition.name not in assets:
                category = addition.category or "object"
                thing = WantedThing(addition.name, category, decision.path)
                things.setdefault(addition.name, thing)
    return list(things.values())


def wanted_motions(
    tree: ScenarioTree, decisions: Iterable[PruneDecision], catalogue: Catalogue
) -> list[WantedMotion]:
    """Return the movements whose making may restore dropped leaves, each once, in the order of the tree."""
    behaviours = {behaviour.id for behaviour in catalogue.behaviours}
    motions: dict[str, WantedMotion] = {}
    for decision in _in_order(tree, decisions):
        additions = additions_to_make(decision)
        categories = dict.fromkeys(addition.category for addition in additions if addition.category)
        for addition in additions:
            is_new = addition.kind == "behaviour" and addition.name not in behaviours
            if is_new and is_id(addition):
                motion = WantedMotion(addition.name, decision.path, tuple(categories))
                motions.setdefault(addition.name, motion)
    return list(motions.values())


def judged_again(
    pruner: Pruner,
    tree: ScenarioTree,
    decisions: Sequence[PruneDecision],
    made: Collection[str],
) -> list[PruneDecision]:
    """Judge the leaves again whose lacking things and movements have all been `made`.

    The pruner's catalogue must have them.
    """
    names = {
        decision.id: tuple(lack.name for lack in _without_states(decision))
        for decision in decisions
        if is_makeable(decision) and all(lack.name in made for lack in _without_states(decision))
    }
    others = {leaf.id for leaf in tree.leaves if leaf.id not in names}
    before = {decision.id: decision for decision in decisions}
    again = []
    for decision in pruner.decisions(tree, others):
        if decision.status == "failed":
            continue
        made_as = _without_states(before[decision.id])
        lacks = decision.lacks if decision.keep else decision.lacks or made_as
        update = {"made": names[decision.id], "made_as": made_as, "lacks": lacks}
        again.append(decision.model_copy(update=update))
    return again


def is_id(addition: Addition) -> bool:
    """Return whether an addition has a name that can be an id."""
    name = addition.name
    return (
        2 <= len(name) <= 40
        and name[0].isalpha()
        and name.replace("_", "").isalnum()
        and name.isascii()
    )
