"""Measures how the time of every tree operation grows with the size of the tree.

Usage: python benchmarks/tree.py [--json] [--nodes N]

Each operation is timed on trees of N / 4 and of N nodes (default 10,000), alternating; the best CPU time of five
counts, without the cyclic garbage collector. A ratio of 4 is linear; processor caches may push it somewhat above.
"""

import argparse
import gc
import json
import sys
import time
from collections.abc import Callable

from tqdm import tqdm

from oodscen.testing._encoder import HashEncoder
from oodscen.tree._comparison import diff
from oodscen.tree._coverage import coverage
from oodscen.tree._export import to_dot, to_mermaid, to_nested_json
from oodscen.tree._history import replay
from oodscen.tree._html import to_page
from oodscen.tree._merge import merge
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit

FACTOR = 4
LARGEST = 6.0
ROUNDS = 5

Row = dict[str, object]
Operation = Callable[[ScenarioTree], object]


def broad(size: int) -> ScenarioTree:
    """Grow families of a hundred leaves, one edit at a time, each with its own id."""
    tree = ScenarioTree.initial()
    family = ""
    for number in range(size - 3):
        is_family = number % 101 == 0
        label = "Family" if is_family else f"Something unusual on road {number % 101}"
        node = tree.new_id(label)
        parent = ("environmental", "interactional")[number % 2] if is_family else family
        tree = tree.apply(TreeEdit(op="add", node=node, parent=parent, label=label))
        family = node if is_family else family
    return tree


def fresh(tree: ScenarioTree) -> ScenarioTree:
    """Return an equal tree with empty caches."""
    return tree.at(edit=len(tree.edits))


def middle(tree: ScenarioTree) -> str:
    return tree.nodes[len(tree) // 2].id


OPERATIONS: dict[str, Operation] = {
    "to JSON and back": lambda tree: ScenarioTree.parse(fresh(tree).to_json()),
    "walk, depth, leaves, outline": lambda tree: (
        fresh(tree).depth,
        fresh(tree).leaves,
        fresh(tree).outline(),
    ),
    "at half of the log": lambda tree: tree.at(edit=len(tree.edits) // 2).nodes,
    "replay": lambda tree: sum(len(after) for _, after in replay(tree)),
    "undo the middle edit": lambda tree: tree.undo(len(tree.edits) // 2).nodes,
    "provenance": lambda tree: fresh(tree).provenance(middle(tree)),
    "diff with itself": lambda tree: diff(tree, fresh(tree), encoder=HashEncoder()),
    "merge with itself": lambda tree: merge(tree, fresh(tree)).nodes,
    "merge with another": lambda tree: merge(ScenarioTree.initial(), tree).nodes,
    "coverage": lambda tree: coverage(fresh(tree)),
    "Mermaid": lambda tree: to_mermaid(fresh(tree)),
    "Graphviz": lambda tree: to_dot(fresh(tree)),
    "nested JSON": lambda tree: to_nested_json(fresh(tree)),
    "page": lambda tree: to_page(fresh(tree)),
    "notebook": lambda tree: fresh(tree)._repr_html_(),
}


def seconds(task: Callable[..., object], *arguments: object) -> float:
    gc.collect()
    began = time.process_time()
    task(*arguments)
    return time.process_time() - began


def row(name: str, small: float, large: float, nodes: int) -> Row:
    ratio = large / max(small, 1e-9)
    return {
        "name": f"{name}: time for {nodes:,} nodes ({1000 * large:.0f} ms) over that for a quarter",
        "value": round(ratio, 2),
        "unit": "x",
        "target": f"at most {LARGEST}",
        "holds": ratio <= LARGEST,
    }


def measure(nodes: int) -> list[Row]:
    rows = []
    sizes = nodes // FACTOR, nodes
    grown = [[seconds(broad, size) for size in sizes] for _ in range(ROUNDS)]
    rows.append(row("grown edit by edit", *map(min, zip(*grown, strict=True)), nodes))
    trees = [broad(size) for size in sizes]
    for name, operation in tqdm(OPERATIONS.items(), disable=None):
        found = [[seconds(operation, tree) for tree in trees] for _ in range(ROUNDS)]
        rows.append(row(name, *map(min, zip(*found, strict=True)), nodes))
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="print one JSON list at the end")
    parser.add_argument("--nodes", type=int, default=10_000, help="size of the larger trees")
    options = parser.parse_args()
    gc.disable()
    rows = measure(options.nodes)
    for item in rows:
        mark = "ok  " if item["holds"] else "MISS"
        print(f"{mark} {item['name']}: {item['value']} {item['unit']} ({item['target']})")
    if options.json:
        print(json.dumps(rows))
    return 0 if all(item["holds"] for item in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
