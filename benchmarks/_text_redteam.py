"""Compares the closed with the open loop at equal model calls; a part of benchmarks/text.py.

Alone: python benchmarks/_text_redteam.py [--json] [--llm replay:FILE] [--encoder NAME] [--quick]

The built-in author plays both models. In the open loop it draws from a repertoire fitted to the number of
leaves that two real models added in a hundred rounds (37 by the paper; 36 rounds by a frontier model that
followed it by hand, whose tree grew from 40 to 79 nodes and was dry from round 68 on). It is an assumption
that a model omits, five times out of six, what it is shown as covered. The figures for a model that listens
every second time, or never, and for one that repeats itself less, are printed below it.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from tqdm import tqdm

from oodscen import RedTeamer, TreeGrower, make_encoder, make_llm
from oodscen._entry_points import DEFAULT_LLM
from oodscen._registry import DEFAULT_ENCODER
from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._imagining import Habits, Imagination
from oodscen.encoders._cached import CachedEncoder
from oodscen.encoders._check import encode
from oodscen.errors import LLMError
from oodscen.llm._ask import ask
from oodscen.prompts._tree.place_scenario import PlaceScenario
from oodscen.protocols import LLM, Encoder
from oodscen.stages._redteam.rounds import Round
from oodscen.stages._redteam.saturation import Saturation, saturation
from oodscen.tree._scenario_tree import ScenarioTree

BUDGET = 200
LEAST = 1.3
PATIENCE = 20
ROUNDS = 600
ALIKE = 0.8
"""Cosine similarity at and above which two labels count as one kind."""
HABITS = {
    "listens every second time": Habits(listens=0.5),
    "never listens": Habits(listens=0.0),
    "repeats itself less": Habits(repertoire=75.0),
}

Row = dict[str, object]


class Played(NamedTuple):
    """The result of one red team."""

    before: ScenarioTree
    after: ScenarioTree
    rounds: list[Round]
    found: Saturation


def rows(
    *,
    llm: str = DEFAULT_LLM,
    seed: int = 0,
    encoder: str = DEFAULT_ENCODER,
    count: int = 3,
    quick: bool = False,
) -> list[Row]:
    """Return the rows of the comparison.

    Args:
        llm: Model or `replay:FILE` to run in addition; the built-in author always decides.
        seed: Seed of the first red team.
        encoder: Compares proposals and labels.
        count: Number of seeds.
        quick: Skip the authors with other habits, and the rounds until nothing new appears.
    """
    meaning = CachedEncoder(make_encoder(encoder))
    seeds = range(seed, seed + count)
    found, played = [], []
    for one_seed in tqdm(seeds, desc="red teams", disable=None):
        loops = [play(author(one_seed), meaning, closed=closed) for closed in (False, True)]
        found += compared(*loops, meaning, f"seed {one_seed}", decides=True)
        if one_seed == seed:
            for name, one in zip(("open", "closed"), loops, strict=True):
                found += described(one, f"{name} loop, seed {seed}")
        played.append((author(one_seed), loops[1]))
    found += refusals(played)
    for closed in () if quick else (False, True):
        found.append(saturated(author(seed), meaning, closed=closed))
    for name, habits in () if quick else HABITS.items():
        loops = [play(author(seed, habits), meaning, closed=closed) for closed in (False, True)]
        found += compared(*loops, meaning, name, decides=False)[:1]
    return found + modelled(llm, seed, meaning)


def author(seed: int, habits: Habits | None = None) -> LLM:
    """Return the built-in author, optionally with other habits."""
    made = make_llm("builtin", seed=seed)
    if habits is not None:
        assert isinstance(made, BuiltinAuthor)
        made._imagination = Imagination(seed, made._knowledge, made._recogniser, habits)
    return made


def play(llm: LLM, encoder: Encoder, *, closed: bool) -> Played:
    """Grow a tree and red-team it until the budget is spent."""
    before = TreeGrower(llm).run()
    teamer = RedTeamer(llm, iterations=BUDGET, budget=BUDGET, closed_loop=closed, encoder=encoder)
    rounds = list(teamer.rounds(before))
    after = before.apply(*(edit for item in rounds for edit in item.edits))
    return Played(before, after, rounds, saturation(rounds))


def compared(
    opened: Played, closed: Played, encoder: Encoder, name: str, *, decides: bool
) -> list[Row]:
    """Compare the two loops of one author."""
    leaves = [len(one.after.leaves) for one in (opened, closed)]
    ratio = leaves[1] / leaves[0]
    target = f">= {LEAST}" if decides else ""
    holds = ratio >= LEAST if decides else None
    added = [one.found.kinds for one in (opened, closed)]
    kinds = [distinct(one.after, encoder) for one in (opened, closed)]
    what = f"closed over open loop, {name}"
    return [
        row(f"{what}: leaves", ratio, "x", target, holds),
        row(f"{what}: leaves of each", f"{leaves[1]} / {leaves[0]}"),
        row(f"{what}: new leaves", f"{added[1]} / {added[0]} = {added[1] / max(added[0], 1):.2f}"),
        row(f"{what}: leaves, like labels taken as one", f"{kinds[1] / kinds[0]:.2f}"),
    ]


def described(one: Played, name: str) -> list[Row]:
    """Return the counts of decisions, and the round from which the red team was dry."""
    found = one.found
    counts = Counter(str(item.decision) for item in one.rounds)
    decisions = ", ".join(f"{number} {kind}" for kind, number in counts.most_common())
    dry = "not yet" if found.dry_from is None else f"from round {found.dry_from}"
    return [
        row(f"{name}: decisions in {found.rounds} rounds, {found.calls} calls", decisions),
        row(f"{name}: nodes", f"{len(one.before)} -> {len(one.after)}"),
        row(
            f"{name}: dry within the budget ({found.patience} rounds without a new kind)",
            f"{dry}; the last new kind in round {found.last_new}",
        ),
        row(f"{name}: half of all new kinds by round", half(one.rounds)),
        row(
            f"{name}: last {found.recent_rounds} rounds with a new kind",
            f"{found.recent:.2f} [{found.recent_low:.2f}, {found.recent_high:.2f}]",
        ),
        row(
            f"{name}: Good-Turing coverage",
            f"{found.coverage:.2f} [{found.coverage_low:.2f}, {found.coverage_high:.2f}]",
        ),
        row(
            f"{name}: unseen kinds (Chao1)",
            f"{found.unseen:.0f} [{found.unseen_low:.0f}, {found.unseen_high:.0f}]",
        ),
    ]


def half(rounds: Sequence[Round]) -> int:
    """Return the round by which half of the new kinds had been found."""
    new = [item.round for item in rounds if item.decision in ("add", "split")]
    return new[(len(new) - 1) // 2] if new else 0


def distinct(tree: ScenarioTree, encoder: Encoder) -> int:
    """Return the number of leaves, counting those with similar labels once."""
    vectors = encode(encoder, [leaf.label for leaf in tree.leaves]).astype(np.float64)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    kept: list[int] = []
    for place in range(len(vectors)):
        if not kept or (vectors[kept] @ vectors[place]).max() < ALIKE:
            kept.append(place)
    return len(kept)


def saturated(llm: LLM, encoder: Encoder, *, closed: bool) -> Row:
    """Red-team until the tree is dry, and report the round."""
    name = f"{'closed' if closed else 'open'} loop: dry ({PATIENCE} rounds without a new kind) from round"
    before = TreeGrower(llm).run()
    teamer = RedTeamer(
        llm, iterations=ROUNDS, patience=PATIENCE, closed_loop=closed, encoder=encoder
    )
    found = saturation(teamer.rounds(before), patience=PATIENCE)
    known = f"{found.kinds} new kinds after {found.calls} calls"
    return row(name, f"{found.dry_from or f'later than {ROUNDS}'}; {known}")


def refusals(played: Sequence[tuple[LLM, Played]]) -> list[Row]:
    """Ask the tree-LLM about every proposal that was rejected without asking it."""
    right = wrong = missed = 0
    for llm, one in played:
        tree = one.before
        for item in one.rounds:
            if item.decision == "duplicate":
                question = PlaceScenario(text=item.text, nodes=tree.nodes)
                is_right = ask(llm, question).decision == "covered"
                right, wrong = right + is_right, wrong + (not is_right)
            tree = tree.apply(*item.edits)
        missed += sum(item.decision == "covered" for item in one.rounds)
    value = f"{right} rightly, {wrong} wrongly; {missed} that were covered passed"
    return [row("proposals refused by meaning, all seeds", value)]


def modelled(llm: str, seed: int, encoder: Encoder) -> list[Row]:
    """Run both loops with a model or a recording of one, as far as it answers."""
    if llm == DEFAULT_LLM:
        return [
            row("closed over open loop, recorded model", "no recording given (--llm replay:FILE)")
        ]
    loops, found = {}, []
    for closed in (False, True):
        name = f"{'closed' if closed else 'open'} loop, {llm}"
        try:
            loops[closed] = play(make_llm(llm, seed=seed), encoder, closed=closed)
        except LLMError as error:
            found.append(row(name, f"no answer: {str(error)[:100]}"))
            continue
        answered = [item for item in loops[closed].rounds if item.status == "ok"]
        found.append(row(f"{name}: rounds with an answer", len(answered)))
        found += described(loops[closed], name)
    if len(loops) == 2:
        found += compared(loops[False], loops[True], encoder, llm, decides=False)
    return found


def row(
    name: str,
    value: object,
    unit: str = "",
    target: str = "",
    holds: bool | None = None,
) -> Row:
    """Return one row of a benchmark."""
    shown = round(value, 4) if isinstance(value, float) else value
    return {"name": name, "value": shown, "unit": unit, "target": target, "holds": holds}


def main() -> int:
    """Print the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--llm", default=DEFAULT_LLM, help="another model, or replay:FILE")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--encoder", default=DEFAULT_ENCODER)
    parser.add_argument("--count", type=int, default=3, help="seeds that are played")
    parser.add_argument("--quick", action="store_true")
    given = parser.parse_args()
    found = rows(
        llm=given.llm,
        seed=given.seed,
        encoder=given.encoder,
        count=given.count,
        quick=given.quick,
    )
    if given.json:
        print(json.dumps(found))
    else:
        for one in found:
            state = {True: "holds", False: "FAILS", None: ""}[one["holds"]]  # type: ignore[index]
            print(f"{one['name']!s:78} {one['value']!s:>12} {one['unit']} {one['target']} {state}")
    return 0 if all(one["holds"] is not False for one in found) else 1


if __name__ == "__main__":
    sys.exit(main())
