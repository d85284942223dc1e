"""Excerpts of a tree for a prompt: all of a small tree, the relevant part of a large one."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from oodscen._words.text import CHARACTERS_PER_TOKEN
from oodscen.prompts._tree.place_scenario import Hidden
from oodscen.tree._scenario_tree import ROOT, Node, ScenarioTree

_NEAREST = 0.75
"""Share of the room that the nearest branches may take; the rest is for the upper levels."""


class Excerpt(NamedTuple):
    """A part of a tree that is itself a tree."""

    nodes: tuple[Node, ...]
    """The shown nodes, parents before children, in the tree's order."""
    hidden: tuple[Hidden, ...]
    """Shown nodes with hidden leaves below them."""


def excerpt(tree: ScenarioTree, ranked: Callable[[], Sequence[str]], *, tokens: int) -> Excerpt:
    """Choose the part of a tree that fits into a prompt.

    The branches of the nearest leaves come first, then the upper levels, breadth first. A tree that fits is
    shown whole; otherwise `ranked` returns the ids of the leaves, nearest first. Takes linear time in the size of
    the tree.
    """
    depths = {node.id: depth for node, depth in tree.walk()}
    costs = {key: _cost(tree.by_id[key], depth) for key, depth in depths.items()}
    room = tokens * CHARACTERS_PER_TOKEN
    if sum(costs.values()) <= room:
        return Excerpt(tree.nodes, ())
    shown = {node.id for node in tree.nodes if node.parent in (None, ROOT)}
    spent = sum(costs[name] for name in shown)
    for leaf in ranked():
        branch, node_id, cost = [], leaf, 0
        while node_id not in shown and cost <= room:
            branch.append(node_id)
            cost += costs[node_id]
            node_id = tree.by_id[node_id].parent or ROOT
        if spent + cost > _NEAREST * room:
            break
        shown.update(branch)
        spent += cost
    inner = [name for name in depths if tree.children[name] and name not in shown]
    for name in sorted(inner, key=lambda name: depths[name]):
        if spent + costs[name] > room:
            break
        if tree.by_id[name].parent in shown:
            shown.add(name)
            spent += costs[name]
    return Excerpt(tuple(node for node in tree.nodes if node.id in shown), _hidden(tree, shown))


def _cost(node: Node, depth: int) -> int:
    return 2 * min(depth, 20) + len(node.label) + len(node.id) + 10


def _hidden(tree: ScenarioTree, shown: set[str]) -> tuple[Hidden, ...]:
    nearest: dict[str, str] = {}
    counts: dict[str, int] = {}
    for node, _ in tree.walk():
        nearest[node.id] = node.id if node.id in shown else nearest[node.parent or ROOT]
        if not tree.children[node.id] and node.id not in shown:
            counts[nearest[node.id]] = counts.get(nearest[node.id], 0) + 1
    return tuple(Hidden(id=name, leaves=counts[name]) for name in nearest if name in counts)


def list_leaves(tree: ScenarioTree, *, tokens: int, turn: int = 0) -> tuple[tuple[str, ...], int]:
    """Return the labels of the leaves that fit into a prompt, and the number of those that do not.

    If they do not all fit, each turn lists others, so that all are listed in time.
    """
    labels = [leaf.label for leaf in tree.leaves]
    room = tokens * CHARACTERS_PER_TOKEN
    if sum(len(label) + 2 for label in labels) <= room:
        return tuple(labels), 0
    longest = max(len(label) for label in labels) + 2
    start = turn * max(room // longest, 1) % len(labels)  # At least so many fit: no turn skips any.
    listed: list[str] = []
    for label in labels[start:] + labels[:start]:
        room -= len(label) + 2
        if room < 0:
            break
        listed.append(label)
    return tuple(listed), len(labels) - len(listed)
