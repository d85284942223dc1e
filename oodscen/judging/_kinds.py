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
    """The number of the list to which a leaf belongs, by map."""

    @classmethod
    def of(
        cls, scenarios: Sequence[Scenario], maps: Mapping[str, str], *, seed: int = 0
    ) -> "Kinds":
        """Return the kinds of scenarios.

        A kind is possible on a map if a scene there shows it, or if no scene of it needs a certain place. `maps` holds
        the map of every scene, by its id.
        """
        labels = {
            scenario.leaf: scenario.path[-1]
            for scenario in scenarios
            if scenario.leaf and scenario.path
        }
        families = {
            scenario.leaf: scenario.path[-2:-1]
            for scenario in scenarios
            if scenario.leaf and scenario.path
        }
        kinds = merge_kinds(labels)
        leaves = {scenario.id: scenario.leaf for scenario in scenarios}
        here: dict[str, list[AspectOption]] = {}
        for scene, place in sorted(maps.items()):
            leaf = leaves.get(scene, "")
            own = here.setdefault(place, [])
            own += [kind for kind in kinds if kind not in own and kind.holds(leaf)]
        anywhere = [
            kind
            for kind in kinds
            if all(concept.kind != "place" for concept in visible_naming(kind.label).concepts)
        ]
        lists: dict[str, tuple[tuple[AspectOption, ...], ...]] = {}
        homes: dict[str, dict[str, int]] = {}
        for place, own in here.items():
            parts = _parts(sorted(own, key=lambda kind: (families[kind.id], kind.id)))
            homes[place] = {
                leaf: number
                for number, part in enumerate(parts)
                for kind in part
                for leaf in kind.leaves
            }
            spare = [*own, *(kind for kind in anywhere if kind not in own)]
            order = stream(seed, "kinds", place).permutation(len(spare))
            options = [spare[int(index)] for index in order]
            lists[place] = tuple(_filled(part, options, families) for part in parts)
        return cls(tuple(kinds), lists, homes)

    def offered(self, leaf: str, place: str) -> tuple[AspectOption, ...]:
        """Return the list that holds a leaf on a map; the first `LISTED` kinds where there is none."""
        if leaf in self.homes.get(place, {}):
            return self.lists[place][self.homes[place][leaf]]
        own = [kind for kind in self.kinds if kind.holds(leaf)]
        others = [kind for kind in self.kinds if kind not in own]
        return tuple(own + others)[:LISTED]


def merge_kinds(labels: Mapping[str, str]) -> list[AspectOption]:
    """Return the kinds of leaves by their labels: those that show the same things in the same states are one."""
    groups: dict[object, list[str]] = {}
    for leaf, label in sorted(labels.items()):
        groups.setdefault(_look(label), []).append(leaf)
    return [
        AspectOption(id=leaves[0], label=seen_label(labels[leaves[0]]), leaves=tuple(leaves))
        for leaves in groups.values()
    ]


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
    near = {families[kind.id] for kind in part}
    rest = [kind for kind in spare if kind not in part]
    rest.sort(key=lambda kind: families[kind.id] not in near)
    return (*part, *rest[: LISTED - len(part)])
