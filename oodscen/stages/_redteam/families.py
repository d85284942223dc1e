"""The families of a tree that a proposal is to look at: thin ones, and different ones for simultaneous proposals."""

import math
from itertools import zip_longest

from oodscen.tree._scenario_tree import ROOT, ScenarioTree

_THIN = 5
"""Number of groups that are named as thin at once."""


def thin(tree: ScenarioTree, *, turn: int = 0) -> tuple[str, ...]:
    """Return the labels of the groups with the fewest leaves, a few in every turn.

    A group is a family: a node between a class and the leaves. The thinner half takes turns. A class with
    less than half as many leaves as the other comes first.
    """
    leaves = dict.fromkeys((node.id for node in tree.nodes), 0)
    order = [node for node, _ in tree.walk()]
    for node in reversed(order):
        if not tree.children[node.id]:
            leaves[node.id] = 0 if node.parent in (None, ROOT) else 1
        if node.parent is not None:
            leaves[node.parent] += leaves[node.id]
    classes = [node for node in order if node.parent == ROOT]
    most = max((leaves[node.id] for node in classes), default=0)
    thin_classes = [node for node in classes if 2 * leaves[node.id] < most]
    families = [
        node for node in order if node.parent not in (None, ROOT) and tree.children[node.id]
    ]
    families.sort(key=lambda node: leaves[node.id])
    thinner = families[: math.ceil(len(families) / 2)]
    start = turn * _THIN % len(thinner) if thinner else 0
    thin_families = (thinner[start:] + thinner[:start])[:_THIN]
    return tuple(node.label for node in (*thin_classes, *thin_families))


def corner(tree: ScenarioTree, number: int, *, of: int) -> str:
    """Return the label of the family that one of several simultaneous proposals should look at.

    Proposals in flight together get different families, as far as there are as many, in both classes by
    turns. A single proposal at a time is free: its corner is empty.
    """
    if of <= 1:
        return ""
    families_by_class = [
        [node for node in tree.nodes if node.parent == parent.id and tree.children[node.id]]
        for parent in tree.nodes
        if parent.parent == ROOT
    ]
    by_turns = [
        family
        for families in zip_longest(*families_by_class)
        for family in families
        if family is not None
    ]
    return by_turns[(number - 1) % len(by_turns)].label if by_turns else ""
