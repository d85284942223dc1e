"""The tree-LLM's question: where does a scenario belong in the tree?"""

from typing import Any, ClassVar, Literal

from pydantic import BaseModel, Field

from oodscen.errors import Issue
from oodscen.prompts.base import Prompt
from oodscen.tree import ROOT, Node, ScenarioTree, label_fault


class PlacedScenario(BaseModel):
    """Answer: the branch that covers the text, or the change that makes the tree cover it."""

    reasoning: str = Field(description="one or two sentences")
    decision: Literal["covered", "broaden", "add", "reject"]
    node: str | None = Field(
        default=None,
        description="covered: the leaf; broaden: the node to relabel; add: the parent",
    )
    label: str | None = Field(
        default=None, description="broaden: the wider label; add: the label of the new leaf"
    )
    category: str | None = Field(
        default=None, description="add: label of a new family to put between parent and leaf"
    )


class PlaceScenario(Prompt[PlacedScenario]):
    """Find the branch for a scenario, or adjust the tree to accommodate it (paper, section III-A)."""

    purpose: ClassVar[str] = "place-scenario"
    template: ClassVar[str] = "place_scenario.md"
    answer: ClassVar[type[BaseModel]] = PlacedScenario

    text: str
    nodes: tuple[Node, ...]
    """The tree as it stands."""

    def variables(self) -> dict[str, Any]:
        """Show the tree as an outline."""
        tree = ScenarioTree.model_validate({"nodes": self.nodes})
        return {"text": self.text, "outline": tree.outline(ids=True)}

    def check(self, answer: PlacedScenario) -> list[Issue]:
        """The decision names an existing node and carries the labels that it needs."""
        if answer.decision == "reject":
            return []
        by_id = {node.id: node for node in self.nodes}
        node = by_id.get(answer.node or "")
        if node is None:
            return [Issue("node", f"{answer.node!r} is not an id of the tree")]
        issues = []
        if node.id == ROOT:
            issues.append(Issue("node", "name a node below the root"))
        if answer.decision == "covered" and any(n.parent == node.id for n in self.nodes):
            issues.append(Issue("node", f"{node.id!r} is not a leaf"))
        if answer.decision == "broaden" and node.parent == ROOT:
            issues.append(Issue("node", "the classes keep their labels"))
        if answer.decision in ("broaden", "add"):
            issues += _check_label("label", answer.label, by_id)
        if answer.decision == "add" and answer.category is not None:
            issues += _check_label("category", answer.category, by_id)
        if answer.decision == "add" and node.parent == ROOT and answer.category is None:
            issues.append(Issue("category", "a leaf hangs below a family: name a new one"))
        return issues


def _check_label(field: str, label: str | None, nodes: dict[str, Node]) -> list[Issue]:
    label = " ".join((label or "").split())
    if fault := label_fault(label):
        return [Issue(field, fault)]
    if label.casefold() in {node.label.casefold() for node in nodes.values()}:
        return [Issue(field, f"the tree has a node {label!r} already")]
    return []
