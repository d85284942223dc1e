"""The families of a tree that a proposal is to look at: thin ones, and different ones for simultaneous proposals."""

from oodscen.tree._scenario_tree import ROOT, ScenarioTree

_THIN = 5
"""Number of groups that are named as thin at once."""


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
