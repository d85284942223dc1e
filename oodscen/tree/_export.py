"""Export of trees for other tools: Mermaid, Graphviz, nested JSON."""

import json
import re
from typing import TYPE_CHECKING

from oodscen.tree._edits import Node

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree


def to_mermaid(tree: "ScenarioTree") -> str:
    """Return the tree as a Mermaid flowchart.

    Labels are quoted and escaped; leaves that the paper names have a bold border. Mermaid renderers
    refuse charts above a size limit (500 edges by default); Graphviz has no such limit.
    """
    names = _names(tree)
    nodes = [f'  {names[node.id]}["{mermaid_text(node.label)}"]' for node in tree.nodes]
    edges = [
        f"  {names[node.parent]} --> {names[node.id]}"
        for node in tree.nodes
        if node.parent is not None
    ]
    styles = [f"  class {names[node.id]} paper" for node in tree.nodes if _is_papers(tree, node)]
    styles.append("  classDef paper stroke-width:3px")
    return "\n".join(["flowchart LR", *nodes, *edges, *styles])


def to_dot(tree: "ScenarioTree") -> str:
    """Return the tree in Graphviz's DOT language; node names are the ids."""
    nodes = [
        f"  {_dot_text(node.id)} [label={_dot_text(node.label)}"
        f"{', penwidth=2' if _is_papers(tree, node) else ''}];"
        for node in tree.nodes
    ]
    edges = [
        f"  {_dot_text(node.parent)} -> {_dot_text(node.id)};"
        for node in tree.nodes
        if node.parent is not None
    ]
    head = [
        "digraph tree {",
        "  rankdir=LR;",
        '  node [shape=box, style=rounded, fontname="sans"];',
    ]
    return "\n".join([*head, *nodes, *edges, "}"])


def to_nested_json(tree: "ScenarioTree") -> str:
    """Return the tree as nested JSON objects: `id`, `label`, `attested`, `children`.

    An empty tree is `null`.
    """
    parts: list[str] = []
    nesting: list[int] = []
    for node, depth in tree.walk():
        while nesting and nesting[-1] >= depth:
            nesting.pop()
            parts.append("]}")
        if parts and not parts[-1].endswith("["):
            parts.append(",")
        parts.append(f'{_open_object(node)},"children":[')
        nesting.append(depth)
    parts += ["]}"] * len(nesting)
    return "".join(parts) or "null"


def mermaid_text(text: str) -> str:
    """Escape a text so that a Mermaid chart treats it as plain text inside quotes."""
    return _SPECIAL.sub(lambda match: "".join(f"#{ord(char)};" for char in match[0]), text)


_SPECIAL = re.compile(r"[^\w .,;()/+–—’“”„→…-]|^[-+]|(?<=^\d)\.|(?<=^\d\d)\.")
"""Characters that a chart could interpret: all but words and plain punctuation, and list markers."""


def _names(tree: "ScenarioTree") -> dict[str, str]:
    return {node.id: f"n{index}" for index, node in enumerate(tree.nodes)}


def _is_papers(tree: "ScenarioTree", node: Node) -> bool:
    """Return whether a node is a leaf that the paper names."""
    return node.attested is not None and not tree.children[node.id]


def _dot_text(text: str) -> str:
    escaped = text.replace("&", "&amp;").replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _open_object(node: Node) -> str:
    """Return the JSON object of a node without its closing brace."""
    fields = {"id": node.id, "label": node.label, "attested": node.attested}
    return json.dumps(fields, ensure_ascii=False)[:-1]
