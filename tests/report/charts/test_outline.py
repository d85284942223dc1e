"""Outlines of the report: every node once, escaped, with its fate and origin."""

import re

from markupsafe import escape

from oodscen import ScenarioTree, Study
from oodscen.report._charts.outline import outline, remarks
from oodscen.tree._edit_log import MAX_DEPTH
from oodscen.tree._edits import TreeEdit


def test_an_outline_holds_every_node_once_in_tree_order(study: Study) -> None:
    for name in ("initial", "diverse", "simulatable"):
        tree = study.tree(name)
        shown = re.findall(r'<bdi class="name">(.*?)</bdi>', outline(tree))
        assert shown == [str(escape(node.label)) for node, _ in tree.walk()]


def test_fates_follow_the_decisions(study: Study) -> None:
    decisions = {decision.id: decision for decision in study.decisions}
    tree = study.tree("diverse")
    for name, remark in remarks(tree, study.decisions).items():
        assert remark.fate == ("kept" if decisions[name].keep else "dropped")
        missing = dict(remark.lines).get("Missing:", "")
        is_leaf = not tree.children[name]
        assert missing == (", ".join(decisions[name].missing) if is_leaf else "")


def test_attestation_is_shown_at_leaves(study: Study) -> None:
    tree = study.tree("initial")
    lines = [line for line in outline(tree).splitlines() if "badge paper" in line]
    attested = [leaf.label for leaf in tree.leaves if leaf.attested]
    assert [re.sub("<.*?>", "", line).removesuffix(" paper") for line in lines] == attested


def test_leaves_lead_to_what_the_page_holds(study: Study) -> None:
    tree = study.tree("simulatable")
    first = tree.leaves[0].id
    assert re.findall(r'href="(.*?)"', outline(tree, anchors={f"path-{first}"})) == [
        f"#path-{first}"
    ]


def test_the_deepest_outline_is_drawn() -> None:
    edits = [TreeEdit(op="add", node="n0", label="0")]
    edits += [
        TreeEdit(op="add", node=f"n{i}", parent=f"n{i - 1}", label=str(i))
        for i in range(1, MAX_DEPTH)
    ]
    text = outline(ScenarioTree().apply(*edits))
    assert text.count("</bdi>") == MAX_DEPTH
    assert text.count("<details") == text.count("</details>")
