"""One tree out of two that were grown apart."""

from oodscen.edits import Node, TreeEdit
from oodscen.protocols import Encoder
from oodscen.tree import ScenarioTree
from oodscen.trees.history import undone_edits
from oodscen.trees.matching import THRESHOLD, Match, match


def merge(
    one: ScenarioTree,
    other: ScenarioTree,
    *,
    encoder: Encoder | None = None,
    threshold: float = THRESHOLD,
) -> ScenarioTree:
    """Return the first tree with what only the second one has added in its place.

    The log of the first tree stays as it is. A node of the second that the first has too (see
    `match`) leaves a `keep` there that names the second's label, model, prompt and text. Any other
    is added below the node that stands for its parent, with the decisions that made it what it is:
    stage, round, model, prompt, reason and text included; then a `keep` of stage `merge` says that
    it came in by a merge. Neither order nor time nor anything but the arguments decides.

    Args:
        one: Its labels and places win.
        other: The tree that is merged in.
        encoder: Pairs nodes by meaning that neither id nor label pairs.
        threshold: Least cosine of two labels that mean the same.

    Raises:
        UsageError: When the threshold is no cosine.
        EncoderError: When the encoder fails.
    """
    paired = {pair.after: pair for pair in match(one, other, encoder=encoder, threshold=threshold)}
    decisions = _decisions(other)
    ids = {after: pair.before for after, pair in paired.items()}
    tree = one
    for node in other.nodes:
        log = decisions[node.id]
        pair = paired.get(node.id)
        if pair is not None:
            tree = tree.apply(_kept(node, pair, log[-1]))
            continue
        ids[node.id] = tree.new_id(log[0].label or node.label)
        tree = tree.apply(*_added(node, ids, log))
    return tree


def _decisions(tree: ScenarioTree) -> dict[str, list[TreeEdit]]:
    """Return by node the edit that added it and those that relabelled or confirmed it and stand."""
    undone = undone_edits(tree.edits)
    found: dict[str, list[TreeEdit]] = {}
    for index, edit in enumerate(tree.edits):
        if edit.op == "add" and (edit.undoes is None or edit.node not in found):
            found[edit.node] = [edit]
        elif (
            edit.op in ("broaden", "narrow", "keep") and edit.undoes is None and index not in undone
        ):
            found[edit.node].append(edit)
    return found


def _kept(node: Node, pair: Match, last: TreeEdit) -> TreeEdit:
    sure = "" if pair.similarity is None else f", similarity {pair.similarity:.2f}"
    return TreeEdit(
        op="keep",
        node=pair.before,
        stage="merge",
        round=last.round,
        reason=f"the other tree has it as “{node.label}” (same {pair.by}{sure})",
        source=last.source,
        model=last.model,
        prompt=last.prompt,
    )


def _added(node: Node, ids: dict[str, str], log: list[TreeEdit]) -> list[TreeEdit]:
    here = ids[node.id]
    parent = ids[node.parent] if node.parent is not None else None
    edits = [
        edit.model_copy(
            update={
                "node": here,
                "parent": parent if edit.op == "add" else None,
                "attested": node.attested and edit.attested,
                "undoes": None,
            }
        )
        for edit in log
    ]
    labels = [edit.label for edit in edits if edit.op != "keep"]
    if labels[-1] != node.label or node.attested not in {edit.attested for edit in edits}:
        edits.append(
            TreeEdit(
                op="broaden",
                node=here,
                label=node.label,
                attested=node.attested,
                stage="merge",
                reason="its label in the other tree",
            )
        )
    why = f"merged in from another tree, where its id was {node.id}"
    return [*edits, TreeEdit(op="keep", node=here, stage="merge", reason=why)]
