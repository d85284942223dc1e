"""The kinds of situation that the closed question offers: possible on the road shown, and distinct in frames."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from oodscen._seeding import stream
from oodscen.data._scenario import Scenario
from oodscen.judging._aspects.concepts import seen_label
from oodscen.judging._aspects.naming import visible_naming
from oodscen.judging._references import AspectOption

LISTED = 7
"""Number of kinds in a list; with "nothing out of the ordinary" a list has eight options."""


@dataclass(frozen=True)
class Kinds:
    """The kinds of a study, and which of them are offered together on which map.

    The lists of a map depend on the map alone, never on the scene, and every kind of the map's scenes belongs
    to one of them; other lists may borrow it. So a list does not reveal the right kind, and a scene and its
    ordinary drives have the same list. Kinds of one family stand together, so that similar ones are offered.
    """

    kinds: tuple[AspectOption, ...]
    """Every kind once; leaves that frames cannot tell apart are one kind."""
    lists: Mapping[str, tuple[tuple[AspectOption, ...], ...]] = field(default_factory=dict)
    """The lists by map."""
    homes: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    """The index of the list to which a leaf belongs, by map."""

    @classmethod
    def of(
        cls, scenarios: Sequence[Scenario], maps: Mapping[str, str], *, seed: int = 0
    ) -> "Kinds":
        """Return the kinds of scenarios.

        A kind is possible on a map if a scene there shows it, or if no scene of it needs a certain place. `maps` holds
        the map of every scene, by its id.
        """
        described = [scenario for scenario in scenarios if scenario.leaf and scenario.path]
        families = {scenario.leaf: scenario.path[-2:-1] for scenario in described}
        kinds = merge_kinds({scenario.leaf: scenario.path[-1] for scenario in described})
        leaves = {scenario.id: scenario.leaf for scenario in scenarios}
        anywhere = [kind for kind in kinds if not _needs_place(kind)]
        lists: dict[str, tuple[tuple[AspectOption, ...], ...]] = {}
        homes: dict[str, dict[str, int]] = {}
        for map_name, shown in _kinds_by_map(kinds, leaves, maps).items():
            parts = _parts(sorted(shown, key=lambda kind: (families[kind.id], kind.id)))
            homes[map_name] = _list_numbers(parts)
            possible = [*shown, *(kind for kind in anywhere if kind not in shown)]
            order = stream(seed, "kinds", map_name).permutation(len(possible))
            spare = [possible[int(index)] for index in order]
            lists[map_name] = tuple(_filled(part, spare, families) for part in parts)
        return cls(tuple(kinds), lists, homes)

    def offered(self, leaf: str, map_name: str) -> tuple[AspectOption, ...]:
        """Return the list that holds a leaf on a map; the first `LISTED` kinds where there is none."""
        if leaf in self.homes.get(map_name, {}):
            return self.lists[map_name][self.homes[map_name][leaf]]
        kinds = sorted(self.kinds, key=lambda kind: not kind.holds(leaf))
        return tuple(kinds[:LISTED])


def merge_kinds(labels: Mapping[str, str]) -> list[AspectOption]:
    """Return the kinds of leaves by their labels: those that show the same things in the same states are one."""
    groups: dict[object, list[str]] = {}
    for leaf, label in sorted(labels.items()):
        groups.setdefault(_look(label), []).append(leaf)
    return [
        AspectOption(id=leaves[0], label=seen_label(labels[leaves[0]]), leaves=tuple(leaves))
        for leaves in groups.values()
    ]


def _needs_place(kind: AspectOption) -> bool:
    """Return whether a kind can be shown in certain places only, e.g. on a bridge."""
    return any(concept.kind == "place" for concept in visible_naming(kind.label).concepts)


def _kinds_by_map(
    kinds: Sequence[AspectOption], leaves: Mapping[str, str], maps: Mapping[str, str]
) -> dict[str, list[AspectOption]]:
    """Return the kinds that the scenes of every map show, from the leaf and the map of every scene."""
    holding: dict[str, list[AspectOption]] = {}
    for kind in kinds:
        for leaf in dict.fromkeys((kind.id, *kind.leaves)):
            holding.setdefault(leaf, []).append(kind)
    by_map: dict[str, dict[str, AspectOption]] = {}
    for scene_id, map_name in sorted(maps.items()):
        shown = by_map.setdefault(map_name, {})
        shown.update((kind.id, kind) for kind in holding.get(leaves.get(scene_id, ""), ()))
    return {map_name: list(shown.values()) for map_name, shown in by_map.items()}


def _list_numbers(parts: Sequence[Sequence[AspectOption]]) -> dict[str, int]:
    """Return the number of the part that holds each leaf."""
    return {
        leaf: number for number, part in enumerate(parts) for kind in part for leaf in kind.leaves
    }


def _look(label: str) -> object:
    """Return what frames show of a label: its concepts, or its words if it has none."""
    naming = visible_naming(label)
    names = frozenset(concept.name for concept in naming.concepts)
    return names, frozenset(() if names else naming.rest)


def _parts(ordered: Sequence[AspectOption]) -> list[Sequence[AspectOption]]:
    """Divide kinds into as few parts of at most `LISTED` as possible, whose sizes differ by at most one."""
    count = max(1, math.ceil(len(ordered) / LISTED))
    ends = [len(ordered) * number // count for number in range(count + 1)]
    return [ordered[start:end] for start, end in pairwise(ends)]


def _filled(
    part: Sequence[AspectOption],
    spare: Sequence[AspectOption],
    families: Mapping[str, tuple[str, ...]],
) -> tuple[AspectOption, ...]:
    """Return a list of `LISTED` kinds, if there are that many: the part, then kin of it, then others."""
    part_families = {families[kind.id] for kind in part}
    rest = [kind for kind in spare if kind not in part]
    rest.sort(key=lambda kind: families[kind.id] not in part_families)
    return (*part, *rest[: LISTED - len(part)])
