"""What leaves for other tools comes back as the same tree, and labels stay text."""

import html
import json
import re

from hypothesis import given

from oodscen.tree._edit_log import MAX_DEPTH
from oodscen.tree._scenario_tree import ScenarioTree
from tests.tree.woods import broad, chain, few, trees


def shape(tree):
    """Return labels with the labels of their parents, in order."""
    return [(node.label, node.parent and tree.by_id[node.parent].label) for node in tree.nodes]


@few
@given(trees)
def test_a_mermaid_chart_holds_every_node_and_edge_and_no_markup(tree):
    labels, edges = {}, {}
    for line in tree.to_mermaid().splitlines()[1:]:
        if found := re.fullmatch(r'  (n\d+)\["([^"<>`&\\]*)"\]', line):
            text = re.sub(r"#(\d+);", lambda code: chr(int(code[1])), found[2])
            labels[found[1]] = text
        elif found := re.fullmatch(r"  (n\d+) --> (n\d+)", line):
            edges[found[2]] = found[1]
        else:
            assert re.match(r"  class(Def)? [\w]+ (paper|stroke)", line)
    assert [(text, labels.get(edges.get(name))) for name, text in labels.items()] == shape(tree)


@few
@given(trees)
def test_a_dot_graph_holds_every_node_and_edge(tree):
    text = r'"((?:[^"\\]|\\.)*)"'
    labels, edges = {}, {}
    for line in tree.to_dot().splitlines()[3:-1]:
        if found := re.fullmatch(rf"  {text} \[label={text}(, penwidth=2)?\];", line):
            labels[found[1]] = html.unescape(re.sub(r"\\(.)", r"\1", found[2]))
        else:
            found = re.fullmatch(rf"  {text} -> {text};", line)
            edges[found[2]] = found[1]
    assert labels == {node.id: node.label for node in tree.nodes}
    assert edges == {node.id: node.parent for node in tree.nodes if node.parent}


@few
@given(trees)
def test_nested_json_is_the_tree(tree):
    value = json.loads(tree.to_nested_json())
    found = []
    stack = [(value, None)] if value else []
    while stack:
        item, parent = stack.pop()
        found.append({"id": item["id"], "parent": parent, "label": item["label"]})
        stack += [(child, item["id"]) for child in reversed(item["children"])]
    assert found == [node.model_dump(exclude={"attested"}) for node, _ in tree.walk()]


def test_size_is_no_obstacle():
    for tree in (chain(MAX_DEPTH + 1), broad(10_000)):
        for export in (tree.to_mermaid, tree.to_dot, tree.to_nested_json):
            assert len(export()) < 200 * len(tree)


def test_an_empty_tree_is_an_empty_chart():
    assert ScenarioTree().to_nested_json() == "null"
    assert ScenarioTree().to_mermaid().startswith("flowchart LR\n")
    assert ScenarioTree().to_dot().endswith("}")
