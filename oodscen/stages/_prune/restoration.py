"""Additions that would restore the pruned branches, ranked by the number of paths that each unlocks."""

from collections.abc import Iterable, Mapping, Set
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


Wanted = frozenset[Addition]
"""Additions that restore leaves together."""
Needs = dict[str, tuple[Wanted, ...]]
"""The ways to restore each dropped leaf, by its id, the one that its judge named first in front."""


@checked
def restoration(decisions: Iterable[PruneDecision]) -> Restoration:
    """Rank the additions that would restore the branches that pruning dropped.

    A leaf is restored when everything that it lacks is added. This holds for the same judge:
    `Catalogue.extended` makes the catalogue with which to ask it again.

    Args:
        decisions: Decisions on leaves, or on every node; inner nodes are ignored.
    """
    decisions = list(decisions)
    inner = {decision.path[:-1] for decision in decisions}
    leaves = [
        decision for decision in decisions if decision.path not in inner and len(decision.path) > 2
    ]
    dropped = [leaf for leaf in leaves if not leaf.keep and leaf.status == "ok"]
    needs = _needs(dropped)
    return Restoration(
        catalogue=next((leaf.catalogue for leaf in leaves if leaf.catalogue), ""),
        kept=sum(leaf.keep for leaf in leaves),
        dropped=sum(not leaf.keep for leaf in leaves),
        single=_ranked(_single(needs)),
        categories=_ranked(_by_category(needs)),
        sequence=_sequence(needs),
        beyond=tuple(decision.id for decision in dropped if decision.id not in needs),
        unknown=tuple(leaf.id for leaf in leaves if leaf.status == "failed"),
    )


def _needs(dropped: Iterable[PruneDecision]) -> Needs:
    """Return the additions that restore each leaf, without leaves that no addition restores.

    Additions of one thing are one, however the model wrote it and whatever category it gave.
    """
    first: dict[object, Addition] = {}
    needs: Needs = {}
    for leaf in dropped:
        ways = [
            frozenset(first.setdefault(lack.key, lack) for lack in way)
            for way in (leaf.lacks, *leaf.instead)
            if way and all(lack.kind != "other" for lack in way)
        ]
        if ways:
            needs[leaf.id] = tuple(dict.fromkeys(ways))
    return needs


def _single(needs: Needs) -> Iterable[Unlocked]:
    """Yield every addition by itself."""
    users: dict[Addition, dict[str, None]] = {}
    for leaf, ways in needs.items():
        for way in ways:
            for lack in sorted(way, key=lambda addition: addition.words):
                users.setdefault(lack, {})[leaf] = None
    order = {leaf: number for number, leaf in enumerate(needs)}
    for addition in users:
        brought = _closure(frozenset({addition}), users)
        helped = sorted({leaf for lack in brought for leaf in users[lack]}, key=order.__getitem__)
        restored = tuple(leaf for leaf in helped if _is_met(needs[leaf], brought))
        yield Unlocked(additions=(addition,), paths=restored, helps=len(helped))


def _by_category(needs: Needs) -> Iterable[Unlocked]:
    """Yield the missing assets of every category together."""
    groups: dict[Category, dict[Addition, None]] = {}
    for first, *_ in needs.values():
        for addition in sorted(first, key=lambda addition: addition.words):
            if addition.kind == "asset" and addition.category is not None:
                groups.setdefault(addition.category, {})[addition] = None
    for category, group in groups.items():
        restored = tuple(leaf for leaf, ways in needs.items() if _is_met(ways, group.keys()))
        helps = sum(any(not way.isdisjoint(group) for way in ways) for ways in needs.values())
        yield Unlocked(additions=tuple(group), category=category, paths=restored, helps=helps)


def _is_met(ways: Iterable[Wanted], brought: Set[Addition]) -> bool:
    """Return whether additions suffice for one of some ways."""
    return any(way <= brought for way in ways)


def _ranked(unlocked: Iterable[Unlocked]) -> tuple[Unlocked, ...]:
    return tuple(sorted(unlocked, key=lambda each: (-len(each.paths), -each.helps, each.words)))


def _sequence(needs: Needs) -> tuple[RestorationStep, ...]:
    """Build the sequence greedily: each step is the set of lacks that restores most leaves per addition."""
    order = {leaf: number for number, leaf in enumerate(needs)}
    remaining = {leaf: set(ways) for leaf, ways in needs.items()}
    steps: list[RestorationStep] = []
    total = 0
    while remaining:
        leaves: dict[Wanted, set[str]] = {}
        users: dict[Addition, set[Wanted]] = {}
        for leaf, ways in remaining.items():
            for wanted in ways:
                leaves.setdefault(wanted, set()).add(leaf)
                for addition in wanted:
                    users.setdefault(addition, set()).add(wanted)
        closed = {wanted: _closure(wanted, users) for wanted in leaves}
        restored = {
            wanted: {
                leaf
                for lack in closure
                for other in users[lack]
                if other <= closure
                for leaf in leaves[other]
            }
            for wanted, closure in closed.items()
        }
        ranks = {wanted: (-len(restored[wanted]) / len(wanted), len(wanted)) for wanted in leaves}
        best_rank = min(ranks.values())
        best = min(
            (wanted for wanted in leaves if ranks[wanted] == best_rank),
            key=lambda wanted: sorted(addition.words for addition in wanted),
        )
        total += len(restored[best])
        steps.append(
            RestorationStep(
                additions=tuple(sorted(best, key=lambda addition: addition.words)),
                paths=tuple(sorted(restored[best], key=order.__getitem__)),
                total=total,
            )
        )
        remaining = {
            leaf: {wanted - closed[best] for wanted in ways}
            for leaf, ways in remaining.items()
            if leaf not in restored[best]
        }
    return tuple(steps)


def _closure(wanted: Wanted, users: Mapping[Addition, object]) -> Wanted:
    """Return everything that some additions bring; a map also brings every map with fewer traits."""
    if all(addition.kind != "map" for addition in wanted):
        return wanted
    maps = [addition for addition in wanted if addition.kind == "map"]
    return wanted.union(
        user
        for user in users
        if user.kind == "map" and any(addition.brings(user) for addition in maps)
    )


def restoration_rows(
    ranking: Restoration, labels: dict[str, str], *, limit: int = 10
) -> list[dict[str, str | int]]:
    """Return the ranking as table rows: `addition`, `paths`, `helps` and the leaves' `labels`.

    All values may come from a model: escape them for display.
    """
    return [
        {
            "addition": unlocked.words,
            "paths": len(unlocked.paths),
            "helps": unlocked.helps,
            "labels": "; ".join(labels.get(leaf, leaf) for leaf in unlocked.paths),
        }
        for unlocked in ranking.single[:limit]
    ]
