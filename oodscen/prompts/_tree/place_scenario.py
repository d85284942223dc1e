"""The tree-LLM's prompt: find the place of a scenario in the tree."""

from collections.abc import Iterable
from functools import lru_cache
from typing import Any, ClassVar, Literal

from pydantic import BaseModel, Field, field_validator

from oodscen._display import Brief
from oodscen._words.text import one_line
from oodscen.data._base import Data
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._tree.kind_labels import kind_fault
from oodscen.tree._labels import same_words
from oodscen.tree._scenario_tree import ROOT, Node, ScenarioTree

MOST_ALSO = 3
"""Largest number of runners-up to keep."""


class AlsoFits(Brief, BaseModel):
    """A leaf that a text would fit as well."""

    node: str
    why: str = ""


class PlacedScenario(Brief, BaseModel):
    """Answer: the branch that covers the text, or the change that makes the tree cover it."""

    reasoning: str = Field(description="one or two sentences")
    decision: Literal["covered", "broaden", "add", "split", "not-ood", "off-topic"]
    node: str | None = Field(
        default=None,
        description="covered: the leaf; broaden, split: the node to change; add: the parent",
    )
    label: str | None = Field(
        default=None, description="broaden: the wider label; add, split: the label of the new leaf"
    )
    category: str | None = Field(
        default=None,
        description="add: label of a new family to put between parent and leaf; split: the wider "
        "label of the node",
    )
    members: list[str] = Field(
        default=[], description="add: ids of leaves that move into the new family"
    )
    also: list[AlsoFits] = Field(
        default=[], description="leaves that would have been the next best choices"
    )

    @field_validator("node", "label", "category", mode="before")
    @classmethod
    def _given(cls, value: object) -> object:
        return None if isinstance(value, str) and not value.strip() else value

    @field_validator("members", "also", mode="before")
    @classmethod
    def _listed(cls, value: object) -> object:
        return [] if value is None else value


class Hidden(Data):
    """A node whose subtree is only partly shown."""

    noun: ClassVar[str] = "hidden branch"

    id: str
    leaves: int
    """Number of leaves below it that are not shown."""


class PlaceScenario(Prompt[PlacedScenario]):
    """Find the branch for a scenario, or adjust the tree to accommodate it (paper, section III-A)."""

    purpose: ClassVar[str] = "place-scenario"
    template: ClassVar[str] = "place_scenario.md"
    answer: ClassVar[type[BaseModel]] = PlacedScenario

    text: str
    nodes: tuple[Node, ...]
    """The tree, or the part of a large tree that is shown."""
    hidden: tuple[Hidden, ...] = ()
    """Nodes below which leaves are left out."""
    full: tuple[str, ...] = ()
    """Ids of leaves that must not be broadened further."""
    procedure: Literal["paper", "closed"] = "paper"
    """`paper`: nodes are added or broadened. `closed`: leaves may also be split and moved, and the
    answer names runners-up."""

    def variables(self) -> dict[str, Any]:
        """Return the fields, with the tree as an outline."""
        return {**super().variables(), "outline": _outline(self.nodes, self.hidden)}

    def check(self, answer: PlacedScenario) -> list[Issue]:
        """Return faults: a decision that names no existing node or lacks the labels it needs."""
        if answer.decision in ("not-ood", "off-topic"):
            return []
        by_id = {node.id: node for node in self.nodes}
        named = answer.node or ""
        node = by_id.get(named)
        if node is None:
            return [Issue("node", f"{named[:80]!r} is not an id of the tree")]
        return [*self._node_issues(answer, node), *label_issues(answer, self.nodes)]

    def _node_issues(self, answer: PlacedScenario, node: Node) -> list[Issue]:
        """Return faults if the node that an answer names does not go with its decision."""
        issues = []
        if node.id == ROOT:
            issues.append(Issue("node", "name a node below the root"))
        is_class = node.parent == ROOT
        inner = {other.parent for other in self.nodes} | {branch.id for branch in self.hidden}
        is_leaf = node.id not in inner and not is_class
        needs_leaf = answer.decision in ("covered", "split") or (
            answer.decision == "broaden" and self.procedure == "closed"
        )
        if needs_leaf and not is_leaf:
            issues.append(Issue("node", f"{node.id!r} is not a leaf"))
        if answer.decision == "broaden" and is_class:
            issues.append(Issue("node", "the classes keep their labels"))
        if answer.decision == "broaden" and node.id in self.full:
            message = f"{node.id!r} has been broadened often enough: split it"
            issues.append(Issue("decision", message))
        if answer.decision == "split" and self.procedure == "paper":
            issues.append(Issue("decision", 'answer "broaden" or "add" instead of "split"'))
        if answer.decision == "add" and is_leaf:
            message = f"{node.id!r} is a leaf: name the node above it, or broaden the leaf"
            issues.append(Issue("node", message))
        if answer.decision == "add" and is_class and answer.category is None:
            issues.append(Issue("category", "a leaf hangs below a family: name a new one"))
        return issues


def label_issues(answer: PlacedScenario, nodes: Iterable[Node]) -> list[Issue]:
    """Return the faults of an answer's labels: malformed, or already taken by one of the nodes."""
    if answer.decision not in ("broaden", "add", "split"):
        return []
    labels = {"label": one_line(answer.label or "")}
    if answer.decision == "split" or (answer.decision == "add" and answer.category is not None):
        labels["category"] = one_line(answer.category or "")
    taken = {same_words(node.label): node.id for node in nodes}
    issues = []
    for name, label in labels.items():
        if fault := kind_fault(label):
            issues.append(Issue(name, fault))
        elif same_words(label) in taken:
            message = f"the tree has a node {label!r} already: [{taken[same_words(label)]}]"
            issues.append(Issue(name, message))
    if len(set(map(same_words, labels.values()))) < len(labels):
        issues.append(Issue("category", "leaf and family need different labels"))
    return issues


@lru_cache(maxsize=8)
def _outline(nodes: tuple[Node, ...], hidden: tuple[Hidden, ...]) -> str:
    """Return a tree as indented lines; kept, since the instructions and the question both render the variables."""
    left_out = {branch.id: branch.leaves for branch in hidden}
    return "\n".join(
        f"{'  ' * depth}- {node.label} [{node.id}]"
        + (f" (+{left_out[node.id]})" if node.id in left_out else "")
        for node, depth in ScenarioTree.parse({"nodes": nodes}).walk()
    )
