"""Additions that would restore the pruned branches, ranked by the number of paths that each unlocks."""

from collections.abc import Iterable, Mapping
from typing import Literal

from oodscen._arguments import checked
from oodscen.data._additions import Addition
from oodscen.data._base import Data
from oodscen.data._category import Category
from oodscen.stages._prune.decisions import PruneDecision


class Unlocked(Data):
    """One addition, or several together, and the leaves that it would restore."""

    additions: tuple[Addition, ...]
    category: Category | None = None
    """The category whose missing assets are all added at once, if any."""
    paths: tuple[str, ...]
    """Ids of the restored leaves, in tree order."""
    helps: int
    """Number of dropped leaves that need it, including those that need further additions."""

    @property
    def words(self) -> str:
        """Readable description of the additions."""
        if self.category is not None:
            listed = ", ".join(addition.name.replace("_", " ") for addition in self.additions)
            return f"{len(self.additions)} assets of the category {self.category}: {listed}"
        return "; ".join(addition.words for addition in self.additions)


class RestorationStep(Data):
    """One step of extending a catalogue."""

    additions: tuple[Addition, ...]
    """Usually one; several if only all of them together restore a leaf."""
    paths: tuple[str, ...]
    """Ids of the leaves that this step restores."""
    total: int
    """Number of leaves restored by this step and all steps before it."""


class Restoration(Data):
    """The additions that would restore everything that was dropped."""

    schema_version: Literal[1] = 1
    catalogue: str = ""
    kept: int
    """Number of leaves that the catalogue shows."""
    dropped: int
    single: tuple[Unlocked, ...]
    """Single additions, ranked by the number of leaves that each restores alone."""
    categories: tuple[Unlocked, ...]
    """Whole categories of missing assets, ranked by the number of leaves that each restores."""
    sequence: tuple[RestorationStep, ...]
    """Steps of a sequence in which each restores the most remaining leaves per addition."""
    beyond: tuple[str, ...]
    """Ids of dropped leaves that no addition to a catalogue restores."""
    unknown: tuple[str, ...] = ()
    """Ids of leaves for which the model gave no answer."""


@checked
def restoration(decisions: Iterable[PruneDecision]) -> Restoration:
    """Rank the additions that would restore the branches that pruning dropped.

    A leaf is restored when everything that it lacks is added. This holds for the same judge:
    `Catalogue.extended` makes the catalogue with which to ask it again.

    Args:
        decisions: Decisions on leaves, or on every node; inner nodes are ignored.
    """
    everything = list(decisions)
    inner = {decision.path[:-1] for decision in everything}
    leaves = [
        decision for decision in everything if decision.path not in inner and len(decision.path) > 2
    ]
    dropped = [leaf for leaf in leaves if not leaf.keep and leaf.status == "ok"]
    first: dict[tuple[str, str], Addition] = {}
    needs = {
        decision.id: tuple(
            dict.fromkeys(first.setdefault(_key(lack), lack) for lack in decision.lacks)
        )
        for decision in dropped
        if decision.lacks and all(addition.kind != "other" for addition in decision.lacks)
    }
    return Restoration(
        catalogue=next((leaf.catalogue for leaf in leaves if leaf.catalogue), ""),
        kept=sum(leaf.keep for leaf in leaves),
        dropped=sum(not leaf.keep for leaf in leaves),
        single=_ranked(_alone(needs)),
        categories=_ranked(_by_category(needs)),
        sequence=_sequence(needs),
        beyond=tuple(decision.id for decision in dropped if decision.id not in needs),
        unknown=tuple(leaf.id for leaf in leaves if leaf.status == "failed"),
    )


def _key(addition: Addition) -> tuple[str, str]:
    """Return the key under which two additions are the same, ignoring the category from the model."""
    return addition.kind, addition.name.casefold()


Needs = dict[str, tuple[Addition, ...]]


def _alone(needs: Needs) -> Iterable[Unlocked]:
    users: dict[Addition, list[str]] = {}
    for leaf, lacks in needs.items():
        for lack in lacks:
            users.setdefault(lack, []).append(leaf)
    order = {leaf: number for number, leaf in enumerate(needs)}
    for addition in users:
        brought = _closure(frozenset({addition}), users)
        helped = sorted({leaf for lack in brought for leaf in users[lack]}, key=order.__getitem__)
        alone = tuple(leaf for leaf in helped if brought.issuperset(needs[leaf]))
        yield Unlocked(additions=(addition,), paths=alone, helps=len(helped))


def _by_category(needs: Needs) -> Iterable[Unlocked]:
    groups: dict[Category, list[Addition]] = {}
    for addition in dict.fromkeys(lack for lacks in needs.values() for lack in lacks):
        if addition.kind == "asset" and addition.category is not None:
            groups.setdefault(addition.category, []).append(addition)
    for category, group in groups.items():
        restored = tuple(
            leaf
            for leaf, lacks in needs.items()
            if all(any(one.brings(lack) for one in group) for lack in lacks)
        )
        helps = sum(not set(lacks).isdisjoint(group) for lacks in needs.values())
        yield Unlocked(additions=tuple(group), category=category, paths=restored, helps=helps)


def _ranked(found: Iterable[Unlocked]) -> tuple[Unlocked, ...]:
    return tuple(sorted(found, key=lambda one: (-len(one.paths), -one.helps, one.words)))


Wanted = frozenset[Addition]


def _sequence(needs: Needs) -> tuple[RestorationStep, ...]:
    """Build the sequence greedily: each step is the set of lacks that restores most leaves per addition."""
    order = {leaf: number for number, leaf in enumerate(needs)}
    groups: dict[Wanted, list[str]] = {}
    for leaf, lacks in needs.items():
        groups.setdefault(frozenset(lacks), []).append(leaf)
    steps: list[RestorationStep] = []
    total = 0
    while groups:
        users: dict[Addition, set[Wanted]] = {}
        for wanted in groups:
            for addition in wanted:
                users.setdefault(addition, set()).add(wanted)
        closed = {wanted: _closure(wanted, users) for wanted in groups}
        restored = {
            wanted: {other for lack in closure for other in users[lack] if other <= closure}
            for wanted, closure in closed.items()
        }
        worth = {
            wanted: (-sum(len(groups[g]) for g in restored[wanted]) / len(wanted), len(wanted))
            for wanted in groups
        }
        first = min(worth.values())
        best = min(
            (group for group in groups if worth[group] == first),
            key=lambda wanted: sorted(addition.words for addition in wanted),
        )
        paths = sorted((leaf for g in restored[best] for leaf in groups[g]), key=order.__getitem__)
        total += len(paths)
        additions = tuple(sorted(best, key=lambda one: one.words))
        steps.append(RestorationStep(additions=additions, paths=tuple(paths), total=total))
        left: dict[Wanted, list[str]] = {}
        for wanted, leaves in groups.items():
            if wanted not in restored[best]:
                left.setdefault(wanted - closed[best], []).extend(leaves)
        groups = left
    return tuple(steps)


def _closure(wanted: Wanted, users: Mapping[Addition, object]) -> Wanted:
    """Return everything that some additions bring; a map also brings every map with fewer traits."""
    if all(addition.kind != "map" for addition in wanted):
        return wanted
    maps = [addition for addition in wanted if addition.kind == "map"]
    brought = (user for user in users if user.kind == "map" and any(m.brings(user) for m in maps))
    return wanted.union(brought)


def restoration_rows(
    found: Restoration, labels: dict[str, str], *, limit: int = 10
) -> list[dict[str, str | int]]:
    """Return the ranking as table rows: `addition`, `paths`, `helps` and the leaves' `labels`.

    All values may come from a model: escape them for display.
    """
    return [
        {
            "addition": one.words,
            "paths": len(one.paths),
            "helps": one.helps,
            "labels": "; ".join(labels.get(leaf, leaf) for leaf in one.paths),
        }
        for one in found.single[:limit]
    ]
