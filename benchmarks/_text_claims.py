"""Rows on claims: do scenes hold to their texts, and are scenes that do not found out?

Alone: python benchmarks/_text_claims.py [--json] [--llm MODEL]
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

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
from oodscen.catalogue import Catalogue
from oodscen.claims import Claim, check_claims, judge_claims
from oodscen.claims.things import may_be
from oodscen.driving.placement import staging_issues
from oodscen.errors import AnswerError, DataError, LLMError
from oodscen.protocols import LLM
from oodscen.seeding import stream
from oodscen.trace import Trace

TEXTS = 200
MUTANTS = 500
CAUGHT = 0.98
PLAYED = 40
"""Scenes that are played in the simulator itself, and compared again with what happened there."""

Row = dict[str, object]
Fields = dict[str, Any]


def row(name: str, value: object, unit: str, target: str, holds: bool | None) -> Row:
    return {"name": name, "value": value, "unit": unit, "target": target, "holds": holds}


@dataclass(frozen=True)
class Staged:
    """A text with its claims and a scene that holds to them."""

    scene: Scene
    claims: tuple[Claim, ...]


def rows(llm: str = "builtin", seed: int = 0) -> Iterator[Row]:
    """Stage texts, play some of the scenes, and falsify the scenes.

    Args:
        llm: The model that writes, reads and stages.
        seed: Of the model.
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
        for finding in judge_claims(one.claims, one.scene, catalogue)
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
        trace = _played(one.scene, simulator)
        played += len(one.claims)
        wrong += len(check_claims(one.claims, one.scene, catalogue, trace))
    holds = (played - wrong) / max(played, 1)
    text = "1, in what the simulator reports"
    yield row("claims that hold in played episodes", round(holds, 4), "share", text, holds == 1.0)
    yield from _falsified(staged, catalogue, seed)


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


def _played(scene: Scene, simulator: Any) -> Trace:
    """Return the approach and what follows if the ego keeps its speed, as a simulator reports them."""
    result = simulate(
        scene, simulator, render=False, traces=True, actions=("keep_speed", "emergency_brake")
    )
    traces = [result.trace, *result.rollouts.values()]
    longest = max(traces[1:], key=lambda trace: trace.steps)
    columns = {
        name: np.concatenate([result.trace[name], longest[name][1:]])
        for name in result.trace.columns
    }
    return Trace(result.trace.ids, columns)


# ---------------------------------------------------------------------------- falsifying


def _falsified(staged: Sequence[Staged], catalogue: Catalogue, seed: int) -> Iterator[Row]:
    made: Counter[str] = Counter()
    caught: Counter[str] = Counter()
    for round_number in range(6):
        for number, one in enumerate(staged):
            if sum(made.values()) >= MUTANTS:
                break
            names = list(MUTATIONS)
            rng = stream(seed, "falsify", one.scene.id, round_number)
            least = min(made.values(), default=0)
            order = sorted(names, key=lambda name: (made[name] > least + 20, rng.random()))
            for name in order:
                mutant = _mutant(one, name, catalogue, number)
                if mutant is None:
                    continue
                made[name] += 1
                found = check_claims(one.claims, mutant, catalogue)
                caught[name] += bool(found)
                if not found:
                    told = [str(claim) for claim in one.claims]
                    print(f"missed {name} in {mutant.id}: {told}", file=sys.stderr)
                break
    total = sum(made.values())
    share = sum(caught.values()) / max(total, 1)
    yield row("mutated scenes", total, "scenes", f"at least {MUTANTS}", total >= MUTANTS)
    yield row(
        "mutated scenes caught", round(share, 4), "share", f"at least {CAUGHT}", share >= CAUGHT
    )
    for name in made:
        yield row(f"caught: {name}", f"{caught[name]} of {made[name]}", "scenes", "printed", None)


def _mutant(one: Staged, name: str, catalogue: Catalogue, number: int) -> Scene | None:
    """Return the scene with one thing changed that its text forbids; `None` where there is none."""
    for claim in one.claims:
        fields = MUTATIONS[name](claim, one, catalogue)
        if fields is None:
            continue
        try:
            scene = Scene.parse({**fields, "id": f"{one.scene.id}.{name.replace(' ', '-')}"})
        except DataError:
            continue
        if not staging_issues(scene, catalogue) and scene.model_dump(
            exclude={"id"}
        ) != one.scene.model_dump(exclude={"id"}):
            return scene
    return None


def _meant(claim: Claim, one: Staged, catalogue: Catalogue) -> list[int]:
    """Return the indices of the unusual actors that a claim may be about."""
    return [
        index
        for index, actor in enumerate(one.scene.actors)
        if actor.id in one.scene.hazard.actors
        and may_be(claim.subject, catalogue.asset(actor.asset))
    ]


def _weather(claim: Claim, one: Staged, catalogue: Catalogue) -> Fields | None:
    if claim.kind != "weather":
        return None
    dry = {"precipitation": "none", "precipitation_mm_h": 0.0, "friction": 1.0}
    wet = {"precipitation": "rain", "precipitation_mm_h": 12.0, "friction": 0.6, "cloud_cover": 1.0}
    clear = {"fog_visual_range_m": 10_000.0}
    changes = {
        value: change
        for values, change in (
            (("rain", "light_rain", "heavy_rain", "wet_road"), dry),
            (("snow", "light_snow", "heavy_snow", "slippery_road"), dry),
            (("fog", "thick_fog", "mist"), clear),
            (("clear", "dry"), wet),
            (("cloudy",), {"cloud_cover": 0.0}),
        )
        for value in values
    }
    fields = one.scene.model_dump()
    fields["weather"] |= changes[claim.value]
    return fields


def _light(claim: Claim, one: Staged, catalogue: Catalogue) -> Fields | None:
    if claim.kind != "time":
        return None
    fields = one.scene.model_dump()
    fields["weather"]["sun_elevation_deg"] = -25.0 if claim.value in ("day", "low_sun") else 45.0
    return fields


def _lane(claim: Claim, one: Staged, catalogue: Catalogue) -> Fields | None:
    if (claim.kind, claim.value) != ("place", "in_lane"):
        return None
    fields, meant = one.scene.model_dump(), _meant(claim, one, catalogue)
    if any(one.scene.actors[index].behaviour.name != "stand" for index in meant):
        return None
    for index in meant:
        asset = catalogue.asset(one.scene.actors[index].asset)
        reach = 0.5 * max(asset.length, asset.width)
        fields["actors"][index]["placement"]["offset_m"] = -(1.75 + reach + 0.6)
    return fields if meant else None


def _missing(claim: Claim, one: Staged, catalogue: Catalogue) -> Fields | None:
    if claim.kind != "thing":
        return None
    fields, meant = one.scene.model_dump(), _meant(claim, one, catalogue)
    gone = {one.scene.actors[index].id for index in meant}
    while True:
        more = {
            actor.id
            for actor in one.scene.actors
            if {actor.behaviour.other, actor.behaviour.trigger.actor} & gone
        }
        if more <= gone:
            break
        gone |= more
    fields["actors"] = [actor for actor in fields["actors"] if actor["id"] not in gone]
    fields["hazard"]["actors"] = {
        name: twin for name, twin in fields["hazard"]["actors"].items() if name not in gone
    }
    if not fields["hazard"]["actors"] and fields["hazard"]["weather"] is None:
        fields["hazard"]["weather"] = fields["weather"]
    fields["decision"] = {"kind": "time", "value": 4.0}
    return fields if gone else None


def _moving(claim: Claim, one: Staged, catalogue: Catalogue) -> Fields | None:
    if (claim.kind, claim.value) != ("motion", "stationary"):
        return None
    fields, meant = one.scene.model_dump(), _meant(claim, one, catalogue)
    for index in meant:
        category = catalogue.asset(one.scene.actors[index].asset).category
        name = {
            "vehicle": "follow_lane",
            "cyclist": "follow_lane",
            "work_zone": "roll_away",
            "signal": "",
        }.get(category, "walk_along")
        if not name or one.scene.actors[index].behaviour.name != "stand":
            return None
        trigger = {"kind": "time", "value": 0.0}
        speed = {"speed": 4.0}
        fields["actors"][index]["behaviour"] = {
            "name": name,
            "trigger": trigger,
            "parameters": speed,
        }
    return fields if meant else None


def _side(claim: Claim, one: Staged, catalogue: Catalogue) -> Fields | None:
    sides = ("from_left", "from_right", "left", "right", "left_lane", "right_lane")
    if claim.kind not in ("place", "motion") or claim.value not in sides:
        return None
    fields, meant = one.scene.model_dump(), _meant(claim, one, catalogue)
    for index in meant:
        place = fields["actors"][index]["placement"]
        for name in ("lane", "offset_m", "heading_deg"):
            place[name] = -place[name]
    return fields if meant else None


def _map(claim: Claim, one: Staged, catalogue: Catalogue) -> Fields | None:
    if claim.kind not in ("road", "lanes", "own_lanes"):
        return None
    fields = one.scene.model_dump()
    far = {"urban": "highway", "residential": "highway", "highway": "residential_two_lane"}
    fields["map"] = far.get(claim.value, "urban_three_lane")
    if fields["map"] == one.scene.map:
        fields["map"] = "residential_two_lane"
    return fields


def _behind(claim: Claim, one: Staged, catalogue: Catalogue) -> Fields | None:
    if (claim.kind, claim.value) != ("place", "ahead"):
        return None
    fields, meant = one.scene.model_dump(), _meant(claim, one, catalogue)
    for index in meant:
        fields["actors"][index]["placement"]["ahead_m"] = -12.0 - 3.0 * index
        fields["actors"][index]["behaviour"] = {}
    fields["decision"] = {"kind": "time", "value": 4.0}
    return fields if meant else None


MUTATIONS: dict[str, Callable[[Claim, Staged, Catalogue], Fields | None]] = {
    "wrong lane": _lane,
    "wrong weather": _weather,
    "day for night": _light,
    "missing actor": _missing,
    "moving instead of static": _moving,
    "wrong side": _side,
    "wrong map": _map,
    "behind instead of ahead": _behind,
}


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
