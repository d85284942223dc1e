"""The tree grower: few-shot chain of thought in three turns (paper, section III-A)."""

from collections.abc import Sequence

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen._numbers import whole_number
from oodscen._paper import FEW_SHOTS, NODES, attestation
from oodscen._progress import Progress, reporting
from oodscen._words.text import one_line
from oodscen.llm._ask import ask, speaker
from oodscen.prompts._tree.classify_examples import ClassifyExamples
from oodscen.prompts._tree.give_examples import GiveExamples
from oodscen.prompts._tree.propose_tree import ProposedTree, ProposeTree
from oodscen.protocols import LLM
from oodscen.tree._labels import CLASSES, same_words
from oodscen.tree._scenario_tree import ROOT, ScenarioTree, TreeEdit


class TreeGrower(Brief):
    """Asks the tree-LLM for examples, for their classes, and for a tree.

    Args:
        llm: The tree-LLM.
        nodes: Size of the tree, at least 3: the root and the two classes count.
        examples: Number of examples requested in the first turn.
        shown: The few-shot examples.
    """

    _repr_fields = ("llm", "nodes", "examples")

    @checked
    def __init__(
        self,
        llm: LLM,
        *,
        nodes: int = NODES["initial"],
        examples: int = 12,
        shown: tuple[str, ...] = FEW_SHOTS,
    ) -> None:
        self.llm = llm
        self.nodes = whole_number("nodes", nodes, 1 + len(CLASSES))
        self.examples = whole_number("examples", examples)
        self.shown = shown

    @checked
    def run(self, sample: int = 0, *, progress: Progress | bool | None = None) -> ScenarioTree:
        """Return a tree of exactly `nodes` nodes.

        Args:
            sample: Index of the draw, for several independent trees.
            progress: True for a progress bar, or a callable; it counts the three questions.

        Raises:
            AnswerError: When the model gives no valid tree.
        """
        with reporting(progress) as report_progress:
            report_progress("grow", 0, 3)
            give = GiveExamples(shown=self.shown, count=self.examples)
            given = ask(self.llm, give, sample).examples
            examples = tuple(text for text in given if text.strip())
            report_progress("grow", 1, 3)
            classify = ClassifyExamples(asked=give, given=examples)
            classified = ask(self.llm, classify, sample).examples
            by_number = sorted(classified, key=lambda example: example.number)
            report_progress("grow", 2, 3)
            propose = ProposeTree(
                asked=classify,
                classes=tuple(example.scenario_class for example in by_number),
                nodes=self.nodes,
            )
            proposed = ask(self.llm, propose, sample)
            report_progress("grow", 3, 3)
        return _initial_tree(proposed, examples, model=speaker(self.llm), prompt=propose.citation())


def _initial_tree(
    proposed: ProposedTree, examples: Sequence[str], *, model: str, prompt: str
) -> ScenarioTree:
    """Return the tree, with ids, of the numbered list in an answer."""
    tree = ScenarioTree()
    ids: dict[int, str] = {}
    for node in proposed.nodes:
        label = one_line(node.label)
        parent = ids.get(node.parent)
        if parent == ROOT:
            label = next(name for name in CLASSES if same_words(name) == same_words(label))
        node_id = ROOT if parent is None else tree.new_id(label)
        ids[node.number] = node_id
        edit = TreeEdit(
            op="add",
            node=node_id,
            parent=parent,
            label=label,
            attested=attestation(label),
            stage="grow",
            source=one_line(examples[node.example - 1]) if node.example is not None else "",
            model=model,
            prompt=prompt,
        )
        tree = tree.apply(edit)
    return tree
