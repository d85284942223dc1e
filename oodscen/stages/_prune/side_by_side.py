"""Comparisons of one tree pruned for several simulators."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal, Self, get_args

from pydantic import model_validator

from oodscen._arguments import checked
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._category import Category
from oodscen.data._weather import CLEAR_AIR_M, DUSK_DEG, PRECIPITATIONS
from oodscen.errors import UsageError
from oodscen.stages._prune.decisions import Match, PruneDecision, decisions_on_nodes
from oodscen.stages._prune.restoration import Restoration, restoration
from oodscen.tree._scenario_tree import ScenarioTree


class Side(Data):
    """The decision of one simulator about a branch."""

    keep: bool
    match: Match | None
    reason: str
    missing: tuple[str, ...] = ()
    label: str = ""
    """The narrower label, if only a part of the branch can be shown."""


class LeafDecisions(Data):
    """One leaf with the decisions of all simulators."""

    id: str
    path: tuple[str, ...]
    sides: tuple[Side, ...]
    """The decisions, in the order of `CatalogueComparison.catalogues`."""


class CatalogueTally(Data):
    """Summary figures of one simulator."""

    catalogue: str
    kept: int
    full: int
    substitute: int
    part: int
    dropped: int
    failed: int
    """Leaves for which the model gave no answer; counted as dropped as well."""
    alone: int
    """Number of leaves that only this simulator shows."""
    absent: tuple[str, ...]
    """Kinds that the catalogue lacks entirely: `animal`, `snow` ..."""
    restoration: Restoration
    catalogue_digest: str = ""
    """`Catalogue.digest()` of what was compared; empty in studies made before this was kept."""

    def __str__(self) -> str:
        """Return the figures and the best additions, for a terminal."""
        text = (
            f"{self.catalogue}: {self.kept} of {self.kept + self.dropped} branches ({self.full} as they "
            f"are, {self.substitute} with substitutes, {self.part} in part)"
        )
        if self.failed:
            text += f"; {self.failed} could not be judged"
        if self.absent:
            text += f"; nothing at all of: {', '.join(self.absent)}"
        best = [unlocked for unlocked in self.restoration.single if unlocked.paths][:3]
        if best:
            ranking = ", ".join(f"{unlocked.words} ({len(unlocked.paths)})" for unlocked in best)
            text += f"\n  would restore most: {ranking}"
        return text


class CatalogueComparison(Data):
    """One tree pruned for several simulators."""

    noun: ClassVar[str] = "comparison"

    schema_version: Literal[1] = 1
    catalogues: tuple[str, ...]
    tallies: tuple[CatalogueTally, ...]
    lines: tuple[LeafDecisions, ...]
    """One line for every leaf, in tree order."""

    @model_validator(mode="after")
    def _agree(self) -> Self:
        count = len(self.catalogues)
        if len(self.tallies) != count or any(len(line.sides) != count for line in self.lines):
            raise ValueError("tallies and lines must have one entry for each catalogue")
        return self

    def rows(self) -> list[dict[str, str]]:
        """Return a table with one row per leaf: `branch`, then the decision of each catalogue.

        Labels and reasons may come from a model: escape them for display.
        """
        return [
            {
                "branch": " > ".join(line.path[1:]),
                **{
                    name: _word(side)
                    for name, side in zip(self.catalogues, line.sides, strict=True)
                },
            }
            for line in self.lines
        ]

    def __str__(self) -> str:
        """Return the figures, then one line per leaf and catalogue, for a terminal."""
        parts = []
        for tally in self.tallies:
            parts.append(str(tally))
            if len(self.tallies) > 1:
                parts.append(f"  {tally.alone} branches that no other shows")
        for line in self.lines:
            parts.append(f"\n{' > '.join(line.path[1:])}")
            parts += [
                f"  {name}: {_word(side)}"
                for name, side in zip(self.catalogues, line.sides, strict=True)
            ]
        return "\n".join(parts)


@checked
def compare(
    tree: ScenarioTree,
    catalogues: Mapping[str, Catalogue],
    judged: Mapping[str, Sequence[PruneDecision]],
) -> CatalogueComparison:
    """Compare the decisions of several catalogues about one tree.

    Args:
        tree: The diverse tree.
        catalogues: The catalogues by name.
        judged: The decisions about all leaves, by the same names.

    Raises:
        UsageError: When catalogues and decisions have different names, or there is no decision on some leaf.
    """
    if set(catalogues) != set(judged):
        raise UsageError("catalogues and decisions have different names")
    decided = {name: decisions_on_nodes(tree, judged[name]) for name in catalogues}
    leaves = [leaf.id for leaf in tree.leaves]
    paths = tree.paths
    lines = tuple(
        LeafDecisions(
            id=leaf,
            path=paths[leaf],
            sides=tuple(_side(decided[name][leaf]) for name in catalogues),
        )
        for leaf in leaves
    )
    shown = {name: {leaf for leaf in leaves if decided[name][leaf].keep} for name in catalogues}
    tallies = []
    for name, catalogue in catalogues.items():
        decisions = [decided[name][leaf] for leaf in leaves]
        shown_elsewhere = set().union(*(shown[other] for other in catalogues if other != name))
        matches = Counter(decision.match for decision in decisions)
        tallies.append(
            CatalogueTally(
                catalogue=name,
                kept=len(shown[name]),
                full=matches["full"],
                substitute=matches["substitute"],
                part=matches["part"],
                dropped=len(decisions) - len(shown[name]),
                failed=sum(decision.status == "failed" for decision in decisions),
                alone=len(shown[name] - shown_elsewhere),
                absent=missing_kinds(catalogue),
                restoration=restoration(decisions),
                catalogue_digest=catalogue.digest(),
            )
        )
    return CatalogueComparison(catalogues=tuple(catalogues), tallies=tuple(tallies), lines=lines)


def missing_kinds(catalogue: Catalogue) -> tuple[str, ...]:
    """Return the kinds of assets, precipitation and light that a catalogue lacks entirely."""
    offered = {asset.category for asset in catalogue.assets}
    missing = [category for category in get_args(Category) if category not in offered]
    weather = catalogue.weather
    missing += [kind for kind in PRECIPITATIONS if kind not in ("none", *weather.precipitation)]
    if weather.min_fog_visual_range_m >= CLEAR_AIR_M:
        missing.append("fog")
    if weather.min_sun_elevation_deg >= DUSK_DEG:
        missing.append("night")
    return tuple(missing)


def _side(decision: PruneDecision) -> Side:
    return Side(
        keep=decision.keep,
        match=decision.match,
        reason=decision.reason or decision.error or "",
        missing=decision.missing,
        label=decision.label,
    )


def _word(side: Side) -> str:
    if side.match == "full":
        return "yes"
    words = {"substitute": "with substitutes", "part": "in part", "none": "no", None: "not judged"}
    narrower = f" ({side.label})" if side.label else ""
    return f"{words[side.match]}{narrower}: {side.reason}"
