"""Texts spread over the paths of a tree as evenly as possible."""

from collections.abc import Mapping, Sequence

from oodscen.data._scenario import Scenario


def spread(paths: Mapping[str, tuple[str, ...]], total: int) -> dict[str, int]:
    """Distribute `total` texts over the paths as evenly as possible, earlier paths first."""
    base, rest = divmod(total, len(paths))
    return {leaf: base + (index < rest) for index, leaf in enumerate(paths)}


def spread_subset(scenarios: Sequence[Scenario], size: int) -> list[Scenario]:
    """Choose `size` scenarios that cover the paths as evenly as possible.

    The first text of every path comes first, then the second, and so on; the last level needed contributes
    evenly spaced paths. The order of the scenarios is kept.
    """
    by_leaf: dict[str, list[Scenario]] = {}
    for scenario in scenarios:
        by_leaf.setdefault(scenario.leaf, []).append(scenario)
    chosen: set[str] = set()
    for level in range(max(map(len, by_leaf.values()), default=0)):
        row = [group[level] for group in by_leaf.values() if level < len(group)]
        wanted = min(size - len(chosen), len(row))
        chosen.update(row[index * len(row) // wanted].id for index in range(wanted))
    return [scenario for scenario in scenarios if scenario.id in chosen]
