"""Measures how the questions and checks serve language models that word freely.

Usage: python benchmarks/models.py [--json] [--scenes N]

The answers are those that a strong language model gave to earlier versions of the questions
(`strong_model.jsonl`: 54 texts with the claims read from them and the first scene staged for each). Scenes
without a fault must be accepted, those with one refused, and so must be scenes changed so that they contradict
their texts. An answer to a question that did not ask who stands for what has `stands_for` added by hand where
the words alone do not tell. Tokens are estimated from characters, four to one.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from _falsified_scenes import Told, falsified

from oodscen import Augmenter, Scenario, make_encoder, make_simulator
from oodscen.claims._checking import check_claims, mismatches
from oodscen.claims._matching import likeness_of
from oodscen.data._claim import Claim
from oodscen.errors import AnswerError
from oodscen.llm._prefix import LEAST_TOKENS
from oodscen.llm._reading import read_answer
from oodscen.llm._remote.sdk import load_litellm
from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._scenario.describe_path import DescribePath
from oodscen.prompts._scenario.extract_claims import ExtractClaims
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene
from oodscen.prompts._tree.judge_branch import JudgeBranches
from oodscen.stages._augment import scene_of_draft
from oodscen.stages._prune.pruner import TOGETHER
from oodscen.testing import ScriptedLLM

ANSWERS = Path(__file__).with_name("strong_model.jsonl")
SCENES = 200
CAUGHT = 0.95
CHARACTERS = 4
FULL_PRICE = 8_000
"""Most tokens at full price for one valid scene."""
CACHEABLE = 0.75
DIGEST_BEFORE = 4_600
"""Tokens of the catalogue in the questions that the model answered; it had one form for all."""
OTHERS = ((66, 65_832, 9_510),)
"""Calls of growing and red teaming in that run, with their input and output tokens; 3 leaves in 4 were new."""
LEAVES, PATHS, PER_PATH = 46, 18, 3
"""Judged leaves, staged paths and texts of a path in that run."""
WRITTEN, READ, JUDGED, STAGED = 54, 261, 101, 335
"""Output tokens for a text, the claims of a text, a judgement and a scene in that run."""
PRICED = ("gpt-4o", "gpt-5", "claude-sonnet-4-5", "gemini/gemini-2.5-pro", "deepseek/deepseek-chat")

Row = dict[str, object]


class Cost(NamedTuple):
    """Tokens of a kind of question in a run."""

    calls: float
    prefix: float
    """Tokens of the instructions, for one call."""
    rest: float
    answer: float

    @property
    def cacheable(self) -> float:
        """Input tokens that a provider can have cached; the first call fills the cache."""
        return (self.calls - 1) * self.prefix if self.prefix >= LEAST_TOKENS else 0.0

    @property
    def asked(self) -> float:
        """All input tokens."""
        return self.calls * (self.prefix + self.rest)


def row(name: str, value: object, unit: str, target: str, holds: bool | None) -> Row:
    return {"name": name, "value": value, "unit": unit, "target": target, "holds": holds}


def recorded() -> list[dict[str, Any]]:
    """Return the recorded texts, each with its claims, its path, the model's scene and the scene's fault."""
    return [json.loads(line) for line in ANSWERS.read_text(encoding="utf-8").splitlines()]


def accepted(
    augmenter: Augmenter, texts: Sequence[dict[str, Any]]
) -> Iterator[tuple[dict[str, Any], Told | None, str]]:
    """Yield every recorded answer with its scene, or the faults for which it is refused."""
    for text in texts:
        scenario = Scenario(id=text["id"], text=text["text"], leaf="x", path=tuple(text["path"]))
        claims = tuple(Claim.parse(claim) for claim in text["claims"])
        answer = {**json.loads(text["answer"]), "stands_for": text["stands_for"]}
        try:
            augmenter.roads(claims)
        except AnswerError as error:
            yield text, None, str(error)
            continue
        draft, issues = read_answer(
            json.dumps(answer),
            SceneDraft,
            [lambda draft: augmenter.faults(scenario, claims, draft)],  # noqa: B023
        )
        if draft is None:
            yield text, None, "; ".join(map(str, issues))
        else:
            yield text, Told(claims, scene_of_draft(scenario, draft, augmenter.catalogue)), ""


def rows(scenes: int) -> Iterator[Row]:
    catalogue = make_simulator("pybullet").catalogue()
    encoder = make_encoder("minilm")
    augmenter = Augmenter(ScriptedLLM(lambda request: ""), catalogue, encoder=encoder)
    judged = list(accepted(augmenter, recorded()))
    right = [(one, told, why) for one, told, why in judged if not one["fault"]]
    wrong = [(one, told, why) for one, told, why in judged if one["fault"]]
    refused = [one["id"] for one, told, why in right if told is None]
    for one, told, why in right:
        if told is None:
            print(f"wrongly refused {one['id']}: {why}", file=sys.stderr)
    missed = [one["id"] for one, told, _ in wrong if told is not None]
    yield row("first answers without a fault", len(right), "scenes", "46", len(right) == 46)
    yield row("of them wrongly refused", len(refused), "scenes", "0", not refused)
    yield row("first answers with a fault", len(wrong), "scenes", "printed", None)
    yield row("of them wrongly accepted", len(missed), "scenes", "0", not missed)
    told = [told for _, told, _ in judged if told is not None]
    likeness = likeness_of(encoder, catalogue)
    made: Counter[str] = Counter()
    caught: Counter[str] = Counter()
    for one in falsified(told, catalogue, scenes):
        made[one.change] += 1
        found = mismatches(check_claims(one.told.claims, one.scene, catalogue, likeness=likeness))
        is_named = any(mismatch.claim.kind in one.kinds for mismatch in found)
        caught[one.change] += is_named
        if not is_named:
            print(f"missed {one.change}: {one.scene.id} {found}", file=sys.stderr)
    total, share = sum(made.values()), sum(caught.values()) / max(1, sum(made.values()))
    yield row("falsified scenes", total, "scenes", f"at least {scenes}", total >= scenes)
    text = f"at least {CAUGHT}"
    yield row(
        "of them refused with the cause named", round(share, 4), "share", text, share >= CAUGHT
    )
    for name, count in made.items():
        yield row(f"refused: {name}", f"{caught[name]} of {count}", "scenes", "printed", None)
    repairs = len(wrong) / len(judged)
    yield from _tokens(CatalogueDigest.of(catalogue), repairs)


def _tokens(digest: CatalogueDigest, repairs: float) -> Iterator[Row]:
    every = recorded()
    path, text = tuple(every[0]["path"]), every[0]["text"]
    claims = tuple(Claim.parse(claim) for claim in every[0]["claims"])
    questions: Mapping[str, Prompt[Any]] = {
        "judge": JudgeBranches(paths=(path,) * TOGETHER, catalogue=digest),
        "describe": DescribePath(path=path, count=PER_PATH, catalogue=digest),
        "read": ExtractClaims(text=text),
        "stage": StageScene(
            text=text, path=path, claims=claims, roads=("urban_avenue",), catalogue=digest
        ),
    }
    empty = CatalogueDigest(assets=(), behaviours=(), maps=(), weather="")
    yield row("catalogue before, in every question", DIGEST_BEFORE, "tokens", "printed", None)
    for name in ("describe", "judge", "stage"):
        question = questions[name]
        without = question.model_copy(update={"catalogue": empty})
        size = _size(question.instructions()) - _size(without.instructions())
        yield row(f"catalogue now, to {name}", round(size), "tokens", "printed", None)
    texts = PATHS * PER_PATH
    staged = texts * (1 + repairs)
    calls = {"judge": LEAVES / TOGETHER, "describe": PATHS, "read": texts, "stage": staged}
    answers = {
        "judge": TOGETHER * JUDGED,
        "describe": PER_PATH * WRITTEN,
        "read": READ,
        "stage": STAGED,
    }
    costs = [
        Cost(calls[name], _size(question.instructions()), _size(question.question()), answers[name])
        for name, question in questions.items()
    ]
    # A repair repeats the answer and lists the faults.
    costs.append(Cost(texts * repairs, 0.0, STAGED + 150.0, 0.0))
    costs += [Cost(1, 0.0, asked, answered) for _, asked, answered in OTHERS]
    asked = sum(cost.asked for cost in costs)
    answered = sum(cost.calls * cost.answer for cost in costs)
    cacheable = sum(cost.cacheable for cost in costs)
    share = cacheable / asked
    name = "input tokens of a run that are a cacheable prefix"
    yield row(name, round(share, 3), "share", f"at least {CACHEABLE}", share >= CACHEABLE)
    full = (asked - cacheable + answered) / texts
    name = "tokens at full price for one valid scene"
    yield row(name, round(full), "tokens", f"at most {FULL_PRICE:,}", full <= FULL_PRICE)
    yield row(
        "all tokens for one valid scene",
        round((asked + answered) / texts),
        "tokens",
        "printed",
        None,
    )
    prices = load_litellm().model_cost
    for model in PRICED:
        price = prices[model]
        dollars = (
            (asked - cacheable) * price["input_cost_per_token"]
            + cacheable * price["cache_read_input_token_cost"]
            + answered * price["output_cost_per_token"]
        ) / texts
        yield row(f"one valid scene with {model}", round(dollars, 4), "USD", "printed", None)


def _size(text: str) -> float:
    return len(text) / CHARACTERS


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print rows as JSON in the last line")
    parser.add_argument("--scenes", type=int, default=SCENES, help="number of falsified scenes")
    arguments = parser.parse_args()
    found: list[Row] = []
    for item in rows(arguments.scenes):
        found.append(item)
        print(f"{item['name']:60} {item['value']!s:>10} {item['unit']:7} {item['target']}")
    if arguments.json:
        print(json.dumps(found))
    sys.exit(any(item["holds"] is False for item in found))


if __name__ == "__main__":
    main()
