"""Measures claims: whether scenes satisfy their texts, and whether scenes that do not are detected.

Alone: python benchmarks/_text_claims.py [--json] [--llm MODEL]
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from _text_mutants import MUTATIONS, Case, mutants

from oodscen import (
    Augmenter,
    Describer,
    Pruner,
    RedTeamer,
    Scenario,
    Scene,
    TreeGrower,
    make_llm,
    make_simulator,
    simulate,
)
from oodscen._seeding import stream
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.claims._checking import check_claims, mismatches
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.driving._trace import Trace
from oodscen.errors import AnswerError, LLMError
from oodscen.protocols import LLM

TEXTS = 200
MUTANTS = 500
CAUGHT = 0.98
PLAYED = 40
"""Number of scenes that are run in the simulator itself and checked again against its traces."""

Row = dict[str, object]


def row(name: str, value: object, unit: str, target: str, holds: bool | None) -> Row:
    return {"name": name, "value": value, "unit": unit, "target": target, "holds": holds}


@dataclass(frozen=True)
class Staged:
    """A text with its claims and a scene that satisfies them."""

    scene: Scene
    claims: tuple[Claim, ...]


def rows(llm: str = "builtin", seed: int = 0) -> Iterator[Row]:
    """Stage texts, simulate some of the scenes, and mutate the scenes.

    Args:
        llm: The model that writes, reads and stages.
        seed: Seed of the model.
    """
    model, simulator = make_llm(llm, seed=seed), make_simulator("pybullet")
    catalogue = simulator.catalogue()
    scenarios = _texts(model, catalogue)
    staged, refused, told = _staged(model, catalogue, scenarios)
    yield row("texts staged", len(scenarios), "texts", f"at least {TEXTS}", len(scenarios) >= TEXTS)
    per_text = told / max(len(scenarios), 1)
    yield row("claims per text", round(per_text, 2), "claims", "at least 4", per_text >= 4.0)
    unnamed = [name for name, error in refused.items() if "the text says" not in error]
    yield row(
        "scenes refused for a claim", len(refused) - len(unnamed), "scenes", "claim named", None
    )
    yield row("failed for another reason", len(unnamed), "scenes", "0", not unnamed)
    states = Counter(
        finding.status
        for one in staged
        for finding in check_claims(one.claims, one.scene, catalogue)
    )
    judged = sum(states.values())
    share = (judged - states["fails"]) / max(judged, 1)
    yield row("claims that hold in accepted scenes", round(share, 5), "share", "1", share == 1.0)
    open_share = states["open"] / max(judged, 1)
    yield row(
        "claims that nobody can tell",
        round(open_share, 4),
        "share",
        "at most 0.02",
        open_share <= 0.02,
    )
    played, wrong = 0, 0
    for one in staged[:: max(1, len(staged) // PLAYED)][:PLAYED]:
        played += len(one.claims)
        missed = [
            {one.claim for one in mismatches(check_claims(one.claims, one.scene, catalogue, trace))}
            for trace in _played(one.scene, simulator)
        ]
        wrong += len(set.intersection(*missed))
    holds = (played - wrong) / max(played, 1)
    text = "1, in what the simulator reports"
    yield row("claims that hold in played episodes", round(holds, 4), "share", text, holds == 1.0)
    texts = {scenario.id: scenario.text for scenario in scenarios}
    yield from _falsified(staged, texts, catalogue, seed)


def _texts(model: LLM, catalogue: Catalogue) -> list[Scenario]:
    tree = RedTeamer(model).run(TreeGrower(model).run())
    shown = Pruner(model, catalogue, threads=8).run(tree)
    per_path = max(3, -(-TEXTS // max(len(shown.leaves), 1)))
    return list(Describer(model, None, per_path=per_path).run(shown))


def _staged(
    model: LLM, catalogue: Catalogue, scenarios: Sequence[Scenario]
) -> tuple[list[Staged], dict[str, str], int]:
    augmenter, staged, refused, told = Augmenter(model, catalogue), [], {}, 0
    for scenario in scenarios:
        try:
            claims = augmenter.read(scenario)
            told += len(claims)
            staged.append(Staged(augmenter.run(scenario, claims), claims))
        except (AnswerError, LLMError) as error:
            refused[scenario.id] = str(error)
            print(f"{scenario.text}\n    {error}", file=sys.stderr)
    return staged, refused, told


def _played(scene: Scene, simulator: Any) -> Iterator[Trace]:
    """Yield the simulator's trace of approach and outcome, once if the ego goes on and once if it brakes.

    An actor may depend on the ego: a deer that bolts before a car stays put if the car stops.
    """
    result = simulate(
        scene, simulator, render=False, traces=True, actions=("keep_speed", "emergency_brake")
    )
    for rollout in result.rollouts.values():
        columns = {
            name: np.concatenate([result.trace[name], rollout[name][1:]])
            for name in result.trace.columns
        }
        yield Trace(result.trace.ids, columns)


# ---------------------------------------------------------------------------- falsifying


def _falsified(
    staged: Sequence[Staged], texts: Mapping[str, str], catalogue: Catalogue, seed: int
) -> Iterator[Row]:
    """Mutate scenes independently of the extracted claims, and count the mutants that are detected."""
    knowledge = load_knowledge()
    pools: dict[str, list[tuple[Staged, Scene]]] = {name: [] for name in MUTATIONS}
    left_out: Counter[tuple[str, str]] = Counter()
    for one in staged:
        case = Case(texts[one.scene.scenario_id], one.scene, catalogue, knowledge)
        for name, mutant in mutants(case):
            if isinstance(mutant, str):
                left_out[name, mutant] += 1
            else:
                pools[name].append((one, mutant))
    made: Counter[str] = Counter()
    caught: Counter[str] = Counter()
    for name, one, mutant in _drawn(pools, seed):
        made[name] += 1
        found = mismatches(check_claims(one.claims, mutant, catalogue))
        caught[name] += bool(found)
        if not found:
            told = [str(claim) for claim in one.claims]
            text = texts[one.scene.scenario_id]
            print(f"missed {name} in {mutant.id}: {text} {told}", file=sys.stderr)
    total = sum(made.values())
    share = sum(caught.values()) / max(total, 1)
    yield row("mutated scenes", total, "scenes", f"at least {MUTANTS}", total >= MUTANTS)
    yield row(
        "mutated scenes caught", round(share, 4), "share", f"at least {CAUGHT}", share >= CAUGHT
    )
    for name in made:
        yield row(f"caught: {name}", f"{caught[name]} of {made[name]}", "scenes", "printed", None)
    for (name, why), number in sorted(left_out.items()):
        yield row(f"left out: {name}: {why}", number, "scenes", "printed", None)


def _drawn(
    pools: Mapping[str, list[tuple[Staged, Scene]]], seed: int
) -> Iterator[tuple[str, Staged, Scene]]:
    """Take the mutations in turn, each from its pool in random order, up to the required number."""
    queues = {}
    for name, pool in pools.items():
        order = stream(seed, "falsify", name).permutation(len(pool))
        queues[name] = [pool[index] for index in order]
    taken = 0
    while taken < MUTANTS and any(queues.values()):
        for name, queue in queues.items():
            if queue and taken < MUTANTS:
                taken += 1
                yield name, *queue.pop()


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--llm", default="builtin")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    found = []
    for one in rows(options.llm, options.seed):
        found.append(one)
        if not options.json:
            print(
                f"{one['name']:45} {one['value']!s:>16} {one['unit']:8} {one['target']} {one['holds']}"
            )
    if options.json:
        print(json.dumps(found))
    return 0 if all(one["holds"] is not False for one in found) else 1


if __name__ == "__main__":
    sys.exit(main())
