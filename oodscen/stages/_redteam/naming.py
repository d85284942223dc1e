"""Ids in a question that follow the current labels, while the tree keeps its own."""

from collections.abc import Collection, Mapping
from typing import NamedTuple

from oodscen.prompts._tree.place_scenario import PlacedScenario, PlaceScenario
from oodscen.tree._labels import MAX_LABEL, slug
from oodscen.tree._scenario_tree import ScenarioTree

_LONGEST = 64
"""Largest number of characters of an id."""


class Names(NamedTuple):
    """The translation of ids between a tree and a question about it.

    The id of a node stays when its label is widened. A model that reads "dog-on-the-road" takes the node for
    a narrower kind than its label "Animal on the road" says. Ids of long labels are cut, which a model copies badly.
    """

    shown: Mapping[str, str]
    """Names in the question by the ids that they replace."""

    @classmethod
    def of(cls, tree: ScenarioTree, changed: Collection[str]) -> "Names":
        """Return the names of the nodes whose labels have changed or whose ids are cut; other ids stay as they are."""
        shown: dict[str, str] = {}
        taken = set(tree.by_id)
        for node in tree.nodes:
            name = _name_of(node.label)
            is_cut = name.startswith(node.id) and slug(node.label) == node.id
            if not (is_cut or node.id in changed) or name == node.id or name in taken:
                continue
            taken.add(name)
            shown[node.id] = name
        return cls(shown)

    def in_question(self, question: PlaceScenario) -> PlaceScenario:
        """Return a question about the tree with the names for its ids."""
        if not self.shown:
            return question
        nodes = tuple(
            node.model_copy(
                update={
                    "id": self._name(node.id),
                    "parent": node.parent and self._name(node.parent),
                }
            )
            for node in question.nodes
        )
        hidden = tuple(
            branch.model_copy(update={"id": self._name(branch.id)}) for branch in question.hidden
        )
        full = tuple(sorted(map(self._name, question.full)))
        return question.model_copy(update={"nodes": nodes, "hidden": hidden, "full": full})

    def in_tree(self, answer: PlacedScenario) -> PlacedScenario:
        """Return an answer with the ids of the tree for their names."""
        ids = {name: node for node, name in self.shown.items()}
        if not ids:
            return answer
        also = [
            fits.model_copy(update={"node": ids.get(fits.node, fits.node)}) for fits in answer.also
        ]
        return answer.model_copy(
            update={
                "node": ids.get(answer.node, answer.node) if answer.node else answer.node,
                "members": [ids.get(name, name) for name in answer.members],
                "also": also,
            }
        )

    def _name(self, node: str) -> str:
        return self.shown.get(node, node)


def _name_of(label: str) -> str:
    """Return the id that a label gives, cut after a word where it is too long."""
    name = slug(label, longest=MAX_LABEL)
    return name if len(name) <= _LONGEST else name[:_LONGEST].rpartition("-")[0] or slug(label)
