"""Trees as collapsible outlines, with the origin and the pruning decision of each node."""

from collections.abc import Collection, Sequence

from markupsafe import Markup

from oodscen.stages._prune.decisions import PruneDecision
from oodscen.tree._html import Fate, Remark, tree_html
from oodscen.tree._provenance import origin_words
from oodscen.tree._scenario_tree import ScenarioTree


def outline(
    tree: ScenarioTree,
    decisions: Sequence[PruneDecision] = (),
    anchors: Collection[str] = (),
) -> Markup:
    """Return a tree as a collapsible list.

    Args:
        tree: Any tree.
        decisions: Pruning decisions about its nodes, if they are to be shown.
        anchors: Anchors of the page; a leaf whose `path-<id>` is among them links there.
    """
    return Markup(tree_html(tree, remarks(tree, decisions, anchors)))


def remarks(
    tree: ScenarioTree,
    decisions: Sequence[PruneDecision] = (),
    anchors: Collection[str] = (),
) -> dict[str, Remark]:
    """Return the details that the outline shows beside each label, by node."""
    fates = {decision.id: decision for decision in decisions}
    origins = origin_words(tree)
    details = {}
    for node in tree.nodes:
        decision = fates.get(node.id)
        is_leaf = not tree.children[node.id]
        details[node.id] = Remark(
            fate=_fate(decision),
            origin=origins.get(node.id, ""),
            lines=_lines(decision, tree) if decision and is_leaf else (),
            link=f"#path-{node.id}" if is_leaf and f"path-{node.id}" in anchors else "",
        )
    return details


def _fate(decision: PruneDecision | None) -> Fate:
    if decision is None:
        return ""
    if decision.status == "failed":
        return "failed"
    return "kept" if decision.keep else "dropped"


def _lines(decision: PruneDecision, tree: ScenarioTree) -> tuple[tuple[str, str], ...]:
    shown_with = (*decision.assets, *decision.behaviours, *decision.weather)
    substitutes = [
        f"{substitute.asset} for {substitute.stands_for}" for substitute in decision.substitutes
    ]
    alike = [tree.by_id[name].label for name in decision.same_as if name in tree.by_id]
    lines = [
        ("", decision.reason or decision.error or ""),
        ("Missing:", ", ".join(decision.missing)),
        ("Shown as:", decision.label if decision.keep else ""),
        ("Shown with:", ", ".join(shown_with) if decision.keep else ""),
        ("Standing in:", ", ".join(substitutes) if decision.keep else ""),
        ("Looks the same as:", "; ".join(alike) if decision.keep else ""),
    ]
    return tuple(line for line in lines if line[1])
