"""Excerpts of a tree for a prompt: all of a small tree, the relevant part of a large one."""

import math
import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from oodscen._text import stem
from oodscen.prompts._tree.place_scenario import Hidden
from oodscen.tree._scenario_tree import ROOT, Node, ScenarioTree

CHARACTERS = 4
"""Characters per token of English text."""
_NEAREST = 0.75
"""Share of the room that the nearest branches may take; the rest is for the upper levels."""
_THIN = 5
"""Number of groups that are named as thin at once."""


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
    room = tokens * CHARACTERS
    if sum(costs.values()) <= room:
        return Excerpt(tree.nodes, ())
    shown = {node.id for node in tree.nodes if node.parent in (None, ROOT)}
    spent = sum(costs[name] for name in shown)
    for leaf in ranked():
        branch, cursor, cost = [], leaf, 0
        while cursor not in shown and cost <= room:
            branch.append(cursor)
            cost += costs[cursor]
            cursor = tree.by_id[cursor].parent or ROOT
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
    room = tokens * CHARACTERS
    if sum(len(label) + 2 for label in labels) <= room:
        return tuple(labels), 0
    least = min(len(label) for label in labels) + 2
    start = turn * max(room // (4 * least), 1) % len(labels)
    found: list[str] = []
    for label in labels[start:] + labels[:start]:
        room -= len(label) + 2
        if room < 0:
            break
        found.append(label)
    return tuple(found), len(labels) - len(found)


def thin(tree: ScenarioTree, *, turn: int = 0) -> tuple[str, ...]:
    """Return the labels of the groups with the fewest leaves, a few in every turn.

    A group is a family: a node between a class and the leaves. The thinner half takes turns. A class with
    less than half as many leaves as the other comes first.
    """
    counts = dict.fromkeys((node.id for node in tree.nodes), 0)
    order = [node for node, _ in tree.walk()]
    for node in reversed(order):
        if not tree.children[node.id]:
            counts[node.id] = 0 if node.parent in (None, ROOT) else 1
        if node.parent is not None:
            counts[node.parent] += counts[node.id]
    classes = [node for node in order if node.parent == ROOT]
    most = max((counts[node.id] for node in classes), default=0)
    found = [node.label for node in classes if 2 * counts[node.id] < most]
    families = [
        node for node in order if node.parent not in (None, ROOT) and tree.children[node.id]
    ]
    families.sort(key=lambda node: counts[node.id])
    thinner = families[: -(-len(families) // 2)]
    start = turn * _THIN % len(thinner) if thinner else 0
    found += [node.label for node in (thinner[start:] + thinner[:start])[:_THIN]]
    return tuple(found)


def corner(tree: ScenarioTree, number: int, *, of: int) -> str:
    """Return the label of the family that one of several simultaneous proposals should look at.

    Proposals in flight together get different families, as far as there are as many, in both classes by
    turns. A single proposal at a time is free: its corner is empty.
    """
    if of <= 1:
        return ""
    classes = [node.id for node in tree.nodes if node.parent == ROOT]
    families = [
        [node for node in tree.nodes if node.parent == name and tree.children[node.id]]
        for name in classes
    ]
    turns = [
        group[place]
        for place in range(max(map(len, families), default=0))
        for group in families
        if place < len(group)
    ]
    return turns[(number - 1) % len(turns)].label if turns else ""


# ------------------------------------------------------------------ by words


def by_words(text: str, labels: Sequence[str]) -> list[float]:
    """Return for each label the share of its weighted words that a text contains, 0 to 1.

    Rare words among the labels weigh more. Words are compared by their stems, so that inflections coincide.
    """
    own = stems(text)
    of_label = [stems(label) for label in labels]
    counts: dict[str, int] = {}
    for words in of_label:
        for word in words:
            counts[word] = counts.get(word, 0) + 1
    weights = {word: math.log1p(len(labels) / count) for word, count in counts.items()}
    scores = []
    for words in of_label:
        total = math.fsum(weights[word] for word in sorted(words))
        shared = math.fsum(weights[word] for word in sorted(words & own))
        scores.append(shared / total if total else 0.0)
    return scores


def stems(text: str) -> set[str]:
    """Return the stems of the words of three letters and more."""
    return {stem(word) for word in re.findall(r"[^\W\d_]{3,}", text.casefold())}
