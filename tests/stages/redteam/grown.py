"""Trees of any shape."""

from hypothesis import strategies as st

from oodscen import ScenarioTree
from oodscen.tree._scenario_tree import TreeEdit


def grown(shape):
    """Return a tree with these numbers of leaves per family, the families in turn in each class."""
    edits = []
    for number, leaves in enumerate(shape):
        top = ("environmental", "interactional")[number % 2]
        edits.append(TreeEdit(op="add", node=f"f{number}", parent=top, label=f"Family {number}"))
        edits += [
            TreeEdit(
                op="add", node=f"f{number}-{n}", parent=f"f{number}", label=f"Leaf {number} {n}"
            )
            for n in range(leaves)
        ]
    return ScenarioTree.initial().apply(*edits)


shapes = st.lists(st.integers(1, 6), min_size=1, max_size=12)
