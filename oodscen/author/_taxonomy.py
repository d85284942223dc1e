"""Answers about the tree: proposing a tree, and finding the place of a scenario in it."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.errors import LLMError
from oodscen.prompts._tree.place_scenario import MOST_ALSO, AlsoFits, PlacedScenario, PlaceScenario
from oodscen.prompts._tree.propose_tree import ProposedNode, ProposedTree, ProposeTree
from oodscen.tree._labels import CLASSES
from oodscen.tree._scenario_tree import ROOT, Node

_NEW_FAMILY_AT_LAST = 9
"""Rank of a family that would take the last nodes."""
_MOST_EXAMPLES = 6
"""Largest number of the model's own examples that a tree takes over."""


@dataclass
class _Draft:
    """The hazards chosen so far, by family, and the number of nodes still available."""

    room: int
    families: dict[str, list[HazardKind]] = field(default_factory=dict)
    bare: list[HazardKind] = field(default_factory=list)
    """Leaves directly below their class, because a family would take one node too many."""
    class_sizes: Counter[str] = field(default_factory=Counter)
    """Number of leaves by class."""

    def cost(self, hazard: HazardKind) -> int:
        """Return the number of nodes that a hazard takes: its leaf, and its family if that is new."""
        return 1 if hazard.family in self.families else 2

    def add(self, hazard: HazardKind) -> None:
        """Add a hazard below its family."""
        self.room -= self.cost(hazard)
        self.class_sizes[hazard.class_name] += 1
        self.families.setdefault(hazard.family, []).append(hazard)

    def add_bare(self, hazard: HazardKind) -> None:
        """Add a hazard directly below its class."""
        self.room -= 1
        self.class_sizes[hazard.class_name] += 1
        self.bare.append(hazard)

    @property
    def hazards(self) -> list[HazardKind]:
        """All hazards chosen so far."""
        return [*(hazard for leaves in self.families.values() for hazard in leaves), *self.bare]

    def rank(self, hazard: HazardKind) -> tuple[int, int]:
        """Return how late a hazard is added: the smaller class comes first, then families of one leaf."""
        class_size = self.class_sizes[hazard.class_name]
        family_size = len(self.families.get(hazard.family, ()))
        if not family_size and self.room <= 2:
            return class_size, _NEW_FAMILY_AT_LAST
        return class_size, {1: 0, 0: 1, 2: 2}.get(family_size, family_size + 1)


class TreeAuthor:
    """Answers `ProposeTree` and `PlaceScenario`."""

    def __init__(self, knowledge: Knowledge, recogniser: Recogniser) -> None:
        self.knowledge = knowledge
        self.recogniser = recogniser
        self.simulated = self._named(knowledge.paper.simulated)
        self.mentioned = self._named(knowledge.paper.mentioned)

    def _named(self, descriptions: Sequence[str]) -> tuple[HazardKind, ...]:
        kinds = [self.recogniser.recognise(text).hazard for text in descriptions]
        return tuple({hazard.id: hazard for hazard in kinds if hazard is not None}.values())

    def _numbers(self, descriptions: Sequence[str]) -> dict[str, int]:
        """Return the number of the first example that describes each hazard, by hazard id."""
        numbers: dict[str, int] = {}
        for number, text in enumerate(descriptions, start=1):
            hazard = self.recogniser.recognise(text).hazard
            if hazard is not None:
                numbers.setdefault(hazard.id, number)
        return numbers

    def propose(self, prompt: ProposeTree, rng: np.random.Generator) -> ProposedTree:
        """Build a tree of the given size from the paper's scenarios and a seeded choice of others."""
        draft = _Draft(room=prompt.nodes - 1 - len(CLASSES))
        if draft.room < len(self.simulated):
            least = 1 + len(CLASSES) + len(self.simulated)
            raise LLMError(f"the built-in author needs at least {least} nodes", model="builtin")
        self._add_simulated(draft)
        if draft.room:
            examples = self._named(prompt.asked.given)
            for hazard in (*self.mentioned, *examples[:_MOST_EXAMPLES]):
                chosen = {hazard.id for hazard in draft.hazards}
                if hazard.id not in chosen and draft.cost(hazard) <= draft.room:
                    draft.add(hazard)
            self._fill(draft, rng)
        if draft.room:
            size = 1 + len(CLASSES) + len(self.knowledge.hazards) + len(self.knowledge.families)
            raise LLMError(
                f"the built-in author knows enough for {size} nodes, not {prompt.nodes}",
                model="builtin",
            )
        return self._lay_out(draft, self._numbers(prompt.asked.given))

    def _add_simulated(self, draft: _Draft) -> None:
        """Place the simulated scenarios; in a tiny tree, some go without their family."""
        members: dict[str, list[HazardKind]] = {}
        for hazard in self.simulated:
            members.setdefault(hazard.family, []).append(hazard)
        spare = draft.room - len(self.simulated)
        for leaves in sorted(members.values(), key=lambda leaves: -len(leaves)):
            if spare > 0:
                spare -= 1
                for hazard in leaves:
                    draft.add(hazard)
            else:
                for hazard in leaves:
                    draft.add_bare(hazard)

    def _fill(self, draft: _Draft, rng: np.random.Generator) -> None:
        """Use up the remaining nodes, balanced between the classes, preferring families with several leaves."""
        order = [
            self.knowledge.hazards[index] for index in rng.permutation(len(self.knowledge.hazards))
        ]
        taken = {hazard.id for hazard in draft.hazards}
        left = [hazard for hazard in order if hazard.id not in taken]
        while draft.room and left:
            best = min(left, key=draft.rank)
            if draft.cost(best) > draft.room:
                fitting = [hazard for hazard in left if draft.cost(hazard) <= draft.room]
                if not fitting:
                    draft.add_bare(best)
                    return
                best = min(fitting, key=draft.rank)
            draft.add(best)
            left.remove(best)

    def _lay_out(self, draft: _Draft, examples: Mapping[str, int]) -> ProposedTree:
        nodes: list[ProposedNode] = []

        def add(parent: int, label: str, example: int | None = None) -> int:
            number = len(nodes) + 1
            nodes.append(ProposedNode(number=number, parent=parent, label=label, example=example))
            return number

        root = add(0, "Out-of-distribution driving scenario")
        classes = {label.casefold(): add(root, label) for label in CLASSES}
        for class_name, top in classes.items():
            for family, leaves in draft.families.items():
                if leaves[0].class_name == class_name:
                    parent = add(top, family)
                    for hazard in leaves:
                        add(parent, hazard.label, examples.get(hazard.id))
            for hazard in draft.bare:
                if hazard.class_name == class_name:
                    add(top, hazard.label, examples.get(hazard.id))
        return ProposedTree(nodes=nodes)

    def place(self, prompt: PlaceScenario) -> PlacedScenario:
        """Return the branch for a text, or the change that makes the tree cover it."""
        recognition = self.recogniser.recognise(prompt.text)
        hazard = recognition.hazard
        if hazard is None:
            if recognition.is_driving:
                reason = "The text describes driving, but nothing in it is out of the ordinary."
                return PlacedScenario(reasoning=reason, decision="not-ood")
            return PlacedScenario(reasoning="The text is not about driving.", decision="off-topic")
        outline = _TreeOutline(prompt)
        placed = (
            self._covered(hazard, outline)
            or self._broadened(hazard, outline)
            or self._added(hazard, outline)
        )
        if prompt.procedure == "paper":
            return placed
        return placed.model_copy(update={"also": self._also(prompt, hazard, placed.node)})

    def _covered(self, hazard: HazardKind, outline: "_TreeOutline") -> PlacedScenario | None:
        for leaf in outline.leaves:
            if any(kind.id == hazard.id for kind in self.recogniser.covered_by(leaf.label)):
                return PlacedScenario(
                    reasoning=f"This is what {leaf.label!r} describes already.",
                    decision="covered",
                    node=leaf.id,
                )
        return None

    def _also(
        self, prompt: PlaceScenario, hazard: HazardKind, chosen: str | None
    ) -> list[AlsoFits]:
        """Return the leaves of the hazard's kin, and of other hazards whose words the text contains."""
        reasons = {
            other.id: "It is close kin."
            for other in self.knowledge.hazards
            if other.id in hazard.kin or hazard.id in other.kin
        }
        for other, _ in self.recogniser.candidates(prompt.text):
            reasons.setdefault(other.id, "The text has words of it as well.")
        reasons.pop(hazard.id, None)
        ranks = {hazard_id: rank for rank, hazard_id in enumerate(reasons)}
        ranked: dict[str, tuple[int, str]] = {}
        for leaf in _TreeOutline(prompt).leaves:
            kind, _ = self.recogniser.label(leaf.label)
            if kind is not None and kind.id in reasons and leaf.id != chosen:
                ranked.setdefault(leaf.id, (ranks[kind.id], reasons[kind.id]))
        best = sorted(ranked, key=ranked.__getitem__)[:MOST_ALSO]
        return [AlsoFits(node=node_id, why=ranked[node_id][1]) for node_id in best]

    def _broadened(self, hazard: HazardKind, outline: "_TreeOutline") -> PlacedScenario | None:
        """Widen a closely related leaf that has not been widened yet, or split it if it is full."""
        for leaf in outline.leaves:
            kind, widened = self.recogniser.label(leaf.label)
            if kind is None or widened or hazard.id not in kind.kin:
                continue
            if not kind.wider or kind.wider.casefold() in outline.labels:
                continue
            if leaf.id in outline.full:
                if hazard.label.casefold() in (*outline.labels, kind.wider.casefold()):
                    continue
                return PlacedScenario(
                    reasoning=f"Close to {leaf.label!r}, which stands for enough already.",
                    decision="split",
                    node=leaf.id,
                    label=hazard.label,
                    category=kind.wider,
                )
            return PlacedScenario(
                reasoning=f"Close to {leaf.label!r}: a slightly wider label covers both.",
                decision="broaden",
                node=leaf.id,
                label=kind.wider,
            )
        return None

    def _added(self, hazard: HazardKind, outline: "_TreeOutline") -> PlacedScenario:
        label = outline.free(hazard.label, hazard.wider)
        family = self._family_node(hazard, outline)
        if family is not None:
            return PlacedScenario(
                reasoning=f"No leaf covers it; it belongs to {family.label!r}.",
                decision="add",
                node=family.id,
                label=label,
            )
        top = next(
            (node for node in outline.tops if node.label.casefold() == hazard.class_name), None
        )
        if top is None:
            reason = f"The tree has no class for {hazard.class_name} scenarios."
            return PlacedScenario(reasoning=reason, decision="not-ood")
        return PlacedScenario(
            reasoning="Neither a leaf nor a family covers it, so a new family is needed.",
            decision="add",
            node=top.id,
            label=label,
            category=outline.free(hazard.family),
        )

    def _family_node(self, hazard: HazardKind, outline: "_TreeOutline") -> Node | None:
        """Return the node of the hazard's family, found by its label or else by the leaves below it."""
        for node in outline.families:
            if self.recogniser.family(node.label) == hazard.family:
                return node
        votes: dict[str, int] = {}
        for leaf in outline.leaves:
            kind, _ = self.recogniser.label(leaf.label)
            if kind is not None and kind.family == hazard.family and leaf.parent:
                votes[leaf.parent] = votes.get(leaf.parent, 0) + 1
        families = {node.id: node for node in outline.families}
        parents = [node_id for node_id in votes if node_id in families]
        return families[max(parents, key=votes.__getitem__)] if parents else None


class _TreeOutline:
    """The parts of a tree that matter for placing a scenario."""

    def __init__(self, prompt: PlaceScenario) -> None:
        nodes = prompt.nodes
        parents = {node.parent for node in nodes} | {item.id for item in prompt.hidden}
        self.full = frozenset(prompt.full)
        self.labels = {node.label.casefold() for node in nodes}
        self.tops = [node for node in nodes if node.parent == ROOT]
        below = [node for node in nodes if node.parent not in (None, ROOT)]
        self.leaves = [node for node in below if node.id not in parents]
        self.families = [node for node in below if node.id in parents]

    def free(self, *labels: str) -> str:
        """Return the first label that the tree does not have; if it has all, number the first one."""
        for label in labels:
            if label and label.casefold() not in self.labels:
                return label
        number = 2
        while f"{labels[0]} ({number})".casefold() in self.labels:
            number += 1
        return f"{labels[0]} ({number})"
