"""Measures the accuracy of the open-answer matcher on recorded answers, labels and clauses.

Usage: python benchmarks/aspects.py [--json]

The answers are those of tests/judging/aspects/aspects.jsonl, written in rounds. Concepts missing from the
table for the rounds of `HELD_OUT` have not been added to it, so these rounds predict the accuracy on new
answers.
"""

import argparse
import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from oodscen.author._knowledge.base import HazardKind
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.judging._aspects.matching import names_aspect

Row = dict[str, Any]
ANSWERS = Path(__file__).parents[1] / "tests" / "judging" / "aspects" / "aspects.jsonl"
HELD_OUT = (4, 5)
STEP = 5
"""One in this many clauses is compared with the labels of all other hazards."""


def row(name: str, value: float, target: str, holds: bool) -> Row:
    """Return one row of the result."""
    return {"name": name, "value": round(value, 4), "unit": "", "target": target, "holds": holds}


def share(pairs: Iterable[tuple[str, str]]) -> float:
    """Return the fraction of answer-label pairs that count as the same."""
    found = [names_aspect(said, ("OOD", label)) for said, label in pairs]
    return sum(found) / len(found)


def written() -> list[Row]:
    """Measure the answers written by a person."""
    lines = [json.loads(line) for line in ANSWERS.read_text(encoding="utf-8").splitlines()]
    rows = []
    for name, is_held_out, least, most in (("", False, 0.9, 0.03), (", held out", True, 0.8, 0.05)):
        ones = [line for line in lines if (line["round"] in HELD_OUT) == is_held_out]
        right = share((one["answer"], one["label"]) for one in ones if one["is_right"])
        wrong = share((one["answer"], one["label"]) for one in ones if not one["is_right"])
        rows.append(row(f"right answers that count{name}", right, f">= {least}", right >= least))
        rows.append(row(f"wrong answers that count{name}", wrong, f"<= {most}", wrong <= most))
    labels = {line["label"] for line in lines}
    pairs = share((said, meant) for said in labels for meant in labels if said != meant)
    rows.append(row("labels of a default study taken for another", pairs, "< 0.01", pairs < 0.01))
    return rows


def known() -> list[Row]:
    """Measure the clauses and wider labels in the built-in author's knowledge."""
    hazards: tuple[HazardKind, ...] = load_knowledge().hazards
    told = [
        (clause.replace("{where}", ""), hazard) for hazard in hazards for clause in hazard.events
    ]
    own = share((clause, hazard.label) for clause, hazard in told)
    foreign = share(
        (clause, other.label)
        for clause, hazard in told[::STEP]
        for other in hazards
        if other is not hazard and other.id not in hazard.kin
    )
    wider = share((one.wider, one.label) for one in hazards if one.wider)
    return [
        row("clauses that name their own label", own, ">= 0.75", own >= 0.75),
        row("clauses that name another's label", foreign, "<= 0.015", foreign <= 0.015),
        row("wider labels that name their own label", wider, ">= 0.8", wider >= 0.8),
    ]


def main() -> None:
    """Print the rows."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print rows as JSON in the last line")
    arguments = parser.parse_args()
    rows = written() + known()
    for one in rows:
        print(f"{one['name']:50} {one['value']:>7} {one['target']}")
    if arguments.json:
        print(json.dumps(rows))
    sys.exit(not all(one["holds"] for one in rows))


if __name__ == "__main__":
    main()
