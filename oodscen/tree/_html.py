"""Collapsible outlines of trees for notebooks and the report. Every label is escaped."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Literal

from oodscen._words.text import printable
from oodscen.tree._edits import Node, TreeEdit
from oodscen.tree._provenance import origin_words

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree

MAX_SHOWN = 3_000
"""Largest number of nodes that a notebook shows; deeper levels are left out as a whole."""
_OPEN_DEPTH = 2
"""Branches above this depth are open at first."""
_LONGEST_TITLE = 300
"""Length of the longest tooltip, in characters."""
_MARKS = {"kept": "✓", "dropped": "✕", "failed": "!"}

Fate = Literal["", "kept", "dropped", "failed"]


@dataclass(frozen=True)
class Remark:
    """Remarks on a node in an outline, besides its label."""

    fate: Fate = ""
    """Outcome of the node, if known."""
    origin: str = ""
    """Origin of the node, in a few words."""
    lines: tuple[tuple[str, str], ...] = ()
    """Headings (possibly empty) and texts of the lines below a leaf."""
    link: str = ""
    """Link target of the label."""
    title: str = ""
    """Tooltip of the label."""


def tree_html(
    tree: "ScenarioTree",
    remarks: Mapping[str, Remark] | None = None,
    *,
    max_depth: int | None = None,
) -> str:
    """Return the tree as a collapsible HTML list without style or script.

    Args:
        tree: Any tree.
        remarks: Remarks by node id.
        max_depth: Deeper nodes are left out.
    """
    remarks = remarks or {}
    path_counts = _path_counts(tree)
    parts = ['<ul class="outline">']
    nesting: list[int] = []
    for node, depth in tree.walk():
        if max_depth is not None and depth > max_depth:
            continue
        while nesting and nesting[-1] >= depth:
            nesting.pop()
            parts.append("</ul></details></li>")
        remark = remarks.get(node.id, Remark())
        is_branch = bool(tree.children[node.id])
        if is_branch and depth != max_depth:
            nesting.append(depth)
            parts.append(_branch(node, remark, path_counts[node.id], is_open=depth < _OPEN_DEPTH))
        else:
            parts.append(_item(node, remark, path_counts[node.id] if is_branch else 0))
    parts += ["</ul></details></li>"] * len(nesting)
    return "\n".join([*parts, "</ul>"])


def to_page(tree: "ScenarioTree") -> str:
    """Return the whole tree as a separate page, light or dark by the reader's preference."""
    title = escape(tree.nodes[0].label) if len(tree) else "An empty tree"
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        f"<title>{title}</title><style>body {{ font-family: system-ui, sans-serif; margin: 1.5rem; }}"
        f"</style></head><body>{notebook_html(tree, len(tree))}</body></html>"
    )


def notebook_html(tree: "ScenarioTree", max_nodes: int = MAX_SHOWN) -> str:
    """Return an outline of a limited number of nodes, with a line of totals and a style that suits any notebook theme."""
    level_sizes = Counter(depth for _, depth in tree.walk())
    max_depth = 0
    shown = level_sizes[0]
    while level_sizes[max_depth + 1] and shown + level_sizes[max_depth + 1] <= max_nodes:
        max_depth += 1
        shown += level_sizes[max_depth]
    hidden = len(tree) - shown
    head = (
        f"{_counted(len(tree), 'node')}, {_counted(len(tree.leaves), 'path')}, depth {tree.depth:,}"
    )
    if hidden:
        are = "is" if hidden == 1 else "are"
        head += f"; {_counted(hidden, 'node')} below depth {max_depth} {are} not shown"
    origins, reasons = origin_words(tree), _last_reasons(tree)
    remarks = {
        node.id: Remark(origin=origins.get(node.id, ""), title=reasons.get(node.id, ""))
        for node in tree.nodes
    }
    outline = tree_html(tree, remarks, max_depth=max_depth if hidden else None)
    return f'<div class="oodscen-tree"><style>{_STYLE}</style>\n<p>{head}</p>\n{outline}\n</div>'


# Only the text's own colour, so that the outline suits every notebook theme.
_STYLE = """
.oodscen-tree { line-height: 1.5; max-width: 60rem; overflow-wrap: anywhere; }
.oodscen-tree p { margin: 0 0 .3em; opacity: .75; }
.oodscen-tree ul { list-style: none; margin: 0; padding: 0; }
.oodscen-tree ul ul { margin-left: .4em; padding-left: 1em; border-left: 1px solid; border-color: color-mix(in srgb, currentColor 25%, transparent); }
.oodscen-tree li { margin: 0; padding: .1em 0; }
.oodscen-tree li.leaf { padding-left: 1em; }
.oodscen-tree summary { cursor: pointer; }
.oodscen-tree summary:focus-visible { outline: 2px solid; outline-offset: 1px; }
.oodscen-tree .origin, .oodscen-tree .aside { font-size: .85em; opacity: .75; }
.oodscen-tree .badge { font-size: .75em; border: 1px solid; border-radius: 3px; padding: 0 .35em; opacity: .85; }
.oodscen-tree .sr { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
"""


def _branch(node: Node, remark: Remark, path_count: int, *, is_open: bool) -> str:
    return (
        f"<li><details{' open' if is_open else ''}><summary>{_mark(remark)}{_label(node, remark)}"
        f" {_paths(path_count)}{_origin(remark)}</summary>\n<ul>"
    )


def _item(node: Node, remark: Remark, path_count: int) -> str:
    """Return a leaf, or with a number of paths a branch whose nodes are left out."""
    fate = f" is-{remark.fate}" if remark.fate else ""
    parts = [f'<li class="leaf{fate}">', _mark(remark), _label(node, remark)]
    if path_count:
        parts.append(f" {_paths(path_count)}")
    elif node.attested:
        parts.append(' <span class="badge paper">paper</span>')
    parts.append(_origin(remark))
    for heading, text in remark.lines:
        bold = f"<b>{escape(heading)}</b> " if heading else ""
        parts.append(f"\n<small>{bold}<bdi>{escape(text)}</bdi></small>")
    return "".join([*parts, "</li>"])


def _paths(count: int) -> str:
    return f'<span class="aside">{_counted(count, "path")}</span>'


def _counted(count: int, noun: str) -> str:
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def _label(node: Node, remark: Remark) -> str:
    title = f' title="{escape(remark.title)}"' if remark.title else ""
    text = f'<bdi class="name"{title}>{escape(node.label)}</bdi>'
    return f'<a href="{escape(remark.link)}">{text}</a>' if remark.link else text


def _mark(remark: Remark) -> str:
    fate = remark.fate
    if not fate:
        return ""
    return (
        f'<span class="fate is-{fate}" title="{fate}">{_MARKS[fate]}<span class="sr"> {fate}'
        "</span></span> "
    )


def _origin(remark: Remark) -> str:
    if not remark.origin:
        return ""
    return f'<span class="origin"> · <bdi>{escape(remark.origin)}</bdi></span>'


def _path_counts(tree: "ScenarioTree") -> dict[str, int]:
    """Count the paths that end at or below each node."""
    counts: dict[str, int] = {}
    for node, depth in reversed(list(tree.walk())):
        if children := tree.children[node.id]:
            counts[node.id] = sum(counts[child] for child in children)
        else:
            counts[node.id] = int(depth >= 2)
    return counts


def _last_reasons(tree: "ScenarioTree") -> dict[str, str]:
    """Return the latest decision on each node and its reason."""
    last: dict[str, TreeEdit] = {edit.node: edit for edit in tree.edits}
    return {node_id: _reason(edit) for node_id, edit in last.items()}


def _reason(edit: TreeEdit) -> str:
    parts = [edit.stage, "" if edit.round is None else f"round {edit.round}", edit.model]
    author = ", ".join(filter(None, parts))
    text = f"{edit.op} ({author})" if author else edit.op
    if edit.reason:
        text += f": {edit.reason}"
    text = printable(text)
    return text if len(text) <= _LONGEST_TITLE else f"{text[: _LONGEST_TITLE - 3]}..."
