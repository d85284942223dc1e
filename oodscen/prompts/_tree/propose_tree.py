"""The third turn of growing a tree: ask for the tree."""

from collections import Counter
from typing import ClassVar

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen._words.text import one_line
from oodscen.data._messages import Message
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._tree.classify_examples import (
    Classification,
    ClassifiedExample,
    ClassifyExamples,
)
from oodscen.prompts._tree.kind_labels import kind_fault
from oodscen.tree._labels import CLASSES, same_words

MAX_PROPOSED_DEPTH = 12
"""Largest number of edges from the root of a proposed tree to a leaf."""


class ProposedNode(Brief, BaseModel):
    """One node of the proposed tree."""

    number: int = Field(description="counted from 1; the root is 1")
    parent: int = Field(description="number of the parent, listed before; 0 for the root")
    label: str = Field(description="a kind, in at most eight words")
    example: int | None = Field(
        default=None, description="number of the example it comes from, counted from 1"
    )


class ProposedTree(Brief, BaseModel):
    """Answer: the tree as a flat list, parents before children."""

    nodes: list[ProposedNode]


class ProposeTree(Prompt[ProposedTree]):
    """Arrange the ideas as a tree whose root-to-leaf paths are distinct OOD scenarios."""

    purpose: ClassVar[str] = "propose-tree"
    template: ClassVar[str] = "propose_tree.md"
    answer: ClassVar[type[BaseModel]] = ProposedTree
    follows = (ClassifyExamples,)

    asked: ClassifyExamples
    """The second turn, which contains the first."""
    classes: tuple[str, ...]
    """The model's class for each example, in order."""
    nodes: int
    """Number of nodes of the tree, including the root and the two classes."""

    def earlier(self) -> tuple[Message, ...]:
        """Return the first two turns and their answers."""
        answer = Classification(
            examples=[
                ClassifiedExample.model_validate(
                    {"number": number, "reasoning": "", "scenario_class": name}
                )
                for number, name in enumerate(self.classes, start=1)
            ]
        )
        return (
            *self.asked.earlier(),
            Message(role="user", text=self.asked.question()),
            Message(role="assistant", text=answer.model_dump_json()),
        )

    def check(self, answer: ProposedTree) -> list[Issue]:
        """Return faults unless the list is a tree of the right size below the two classes."""
        return self._list_issues(answer) or self._tree_issues(answer)

    def _list_issues(self, answer: ProposedTree) -> list[Issue]:
        """Return faults of the single nodes: numbers, parents, labels, examples and depths."""
        issues = []
        depths: dict[int, int] = {}
        for index, node in enumerate(answer.nodes):
            path = f"nodes[{index}]"
            if node.number in depths:
                issues.append(Issue(f"{path}.number", f"{node.number} is taken"))
            if index == 0 and node.parent != 0:
                issues.append(
                    Issue(f"{path}.parent", "the first node is the root, its parent is 0")
                )
            if index > 0 and node.parent not in depths:
                issues.append(Issue(f"{path}.parent", f"no node {node.parent} is listed before"))
            if fault := kind_fault(one_line(node.label)):
                issues.append(Issue(f"{path}.label", fault))
            if node.example is not None and not 1 <= node.example <= len(self.asked.given):
                issues.append(Issue(f"{path}.example", f"there is no example {node.example}"))
            depths[node.number] = depths.get(node.parent, -1) + 1
            if depths[node.number] == MAX_PROPOSED_DEPTH + 1:
                issues.append(
                    Issue(
                        f"{path}.parent", f"deeper than {MAX_PROPOSED_DEPTH} levels below the root"
                    )
                )
        return issues

    def _tree_issues(self, answer: ProposedTree) -> list[Issue]:
        """Return faults of the whole: its classes, its size, and labels that occur twice."""
        issues = []
        below = [
            same_words(node.label)
            for node in answer.nodes[1:]
            if node.parent == answer.nodes[0].number
        ]
        if sorted(below) != sorted(map(same_words, CLASSES)):
            issues.append(Issue("nodes", f"below the root: exactly {' and '.join(CLASSES)}"))
        if len(answer.nodes) != self.nodes:
            issues.append(
                Issue("nodes", f"{len(answer.nodes)} nodes; exactly {self.nodes} are wanted")
            )
        counts = Counter(same_words(node.label) for node in answer.nodes)
        issues += [
            Issue("nodes", f"the label {label!r} occurs twice")
            for label, count in counts.items()
            if count > 1
        ]
        return issues
