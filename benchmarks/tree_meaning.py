"""Measures how well two trees with different words for the same hazards are paired by meaning.

Usage: python benchmarks/tree_meaning.py [--json] [--encoder NAME] [--trees N]

Labelled pairs come from the knowledge base: the label of a hazard and the words of another text about the same
hazard match, those of two hazards do not. In every pair of trees a fifth of the leaves are the same hazards: one
tree has their labels, the other has their wider labels (short, and wide enough to cover related hazards: hard)
or one of their events (long, and specific: easy). The other leaves of both trees are different hazards, closely
related ones among them. Half of the hazards, by id, choose the threshold (tune); the other half evaluates it
(test). The counts are of the pairs that `match` makes by meaning.
"""

import argparse
import json
import sys
import zlib
from collections.abc import Sequence

import numpy as np
from tqdm import tqdm

from oodscen import make_encoder
from oodscen._registry import DEFAULT_ENCODER
from oodscen.author._knowledge.base import HazardKind
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.encoders._cached import CachedEncoder
from oodscen.protocols import Encoder
from oodscen.tree._labels import label_fault, same_words
from oodscen.tree._matching import THRESHOLD, match
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit

LEAST = 0.95
"""Least precision: a wrong pair cannot be recovered."""
THRESHOLDS = (0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8)

Row = dict[str, object]


def planted(leaves: Sequence[tuple[HazardKind, str]]) -> ScenarioTree:
    """Plant texts below the class and family of their hazards, with uninformative ids."""
    tree = ScenarioTree.initial()
    families: dict[tuple[str, str], str] = {}
    for hazard, label in leaves:
        key = hazard.class_name, hazard.family
        if key not in families:
            families[key] = tree.new_id(hazard.family)
            tree = tree.apply(
                TreeEdit(op="add", node=families[key], parent=key[0], label=hazard.family)
            )
        tree = tree.apply(
            TreeEdit(op="add", node=tree.new_id(label), parent=families[key], label=label)
        )
    return tree


def other_words(hazard: HazardKind, kind: str, number: int) -> str:
    """Return another wording of a hazard, or an empty string."""
    if kind == "wider":
        found = hazard.wider
    else:
        events = [event.replace("{where}", "ahead") for event in hazard.events]
        found = events[number % len(events)]
    return "" if label_fault(found) or same_words(found) == same_words(hazard.label) else found


def counted(
    hazards: Sequence[HazardKind], kind: str, encoder: Encoder, threshold: float, trees: int
) -> tuple[int, int, int]:
    """Return the numbers of correct pairs by meaning, of all pairs by meaning, and of pairs to find."""
    right = made = wanted = 0
    for number in range(trees):
        order = np.random.default_rng([number, len(hazards)]).permutation(len(hazards))
        chosen = [hazards[place] for place in order]
        fifth = len(chosen) // 5
        shared = [(one, other_words(one, kind, number)) for one in chosen[:fifth]]
        shared = [(one, words) for one, words in shared if words]
        rest = chosen[fifth:]
        half = len(rest) // 2
        here = [(one, one.label) for one in [*(one for one, _ in shared), *rest[:half]]]
        there = [*shared, *((one, one.label) for one in rest[half:])]
        left, right_tree = planted(here), planted(there)
        by_label = (
            {words: one.id for one, words in here},
            {words: one.id for one, words in there},
        )
        wanted += len(shared)
        for pair in match(left, right_tree, encoder=encoder, threshold=threshold):
            if pair.by == "meaning" and not left.children[pair.before]:
                made += 1
                labels = left.by_id[pair.before].label, right_tree.by_id[pair.after].label
                right += by_label[0][labels[0]] == by_label[1][labels[1]]
    return right, made, wanted


def measure(encoder_name: str, trees: int) -> list[Row]:
    encoder = CachedEncoder(make_encoder(encoder_name))
    hazards = load_knowledge().hazards
    parts = {
        name: [hazard for hazard in hazards if zlib.crc32(hazard.id.encode()) % 2 == place]
        for place, name in enumerate(("tune", "test"))
    }
    rows: list[Row] = []
    for part, some in parts.items():
        for kind in ("wider", "event"):
            for threshold in tqdm(THRESHOLDS, desc=f"{part} {kind}", disable=None):
                right, made, wanted = counted(some, kind, encoder, threshold, trees)
                decides = part == "test" and threshold == THRESHOLD
                precision = right / max(made, 1)
                words = "wider labels" if kind == "wider" else "events"
                name = f"{part}: label against {words} at {threshold}"
                rows.append(
                    {
                        "name": f"{name}: precision ({right} of {made} pairs)",
                        "value": round(precision, 3),
                        "unit": "",
                        "target": f">= {LEAST}" if decides else "",
                        "holds": precision >= LEAST if decides else None,
                    }
                )
                rows.append(
                    {
                        "name": f"{name}: recall ({right} of {wanted})",
                        "value": round(right / max(wanted, 1), 3),
                        "unit": "",
                        "target": "",
                        "holds": None,
                    }
                )
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON list at the end")
    parser.add_argument("--encoder", default=DEFAULT_ENCODER)
    parser.add_argument("--trees", type=int, default=20, help="pairs of trees of each kind")
    options = parser.parse_args()
    rows = measure(options.encoder, options.trees)
    for item in rows:
        mark = {True: "ok  ", False: "MISS", None: "    "}[item["holds"]]  # type: ignore[index]
        print(f"{mark} {item['name']}: {item['value']} {item['target']}")
    if options.json:
        print(json.dumps(rows))
    return 0 if all(item["holds"] is not False for item in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
