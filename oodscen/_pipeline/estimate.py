"""Estimates of the calls and cost of a run, from the prompts that it would send."""

import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from oodscen._entry_points import is_asked
from oodscen._io.files import temporary_folder, unreadable
from oodscen._pipeline.models import Models
from oodscen._pipeline.options import RunOptions
from oodscen._pipeline.pipeline import Pipeline
from oodscen._pipeline.sweep import check_workers
from oodscen._registry import make_llm
from oodscen._words.text import CHARACTERS_PER_TOKEN
from oodscen.data._episode import MOMENTS, moments
from oodscen.data._messages import Image, Message
from oodscen.data._pairing import twin_id
from oodscen.data._verdict import verdict_id, without_pictures
from oodscen.errors import MissingExtra, StudyMismatch, UnknownComponent
from oodscen.judging._kinds import LISTED
from oodscen.judging._questions import ShownDrive, acting_prompt, choosing_prompt, naming_prompt
from oodscen.judging._references import AspectOption
from oodscen.judging._selection import ordinary_drives
from oodscen.llm._accounting import Account, accounts
from oodscen.llm._prefix import cacheable_share
from oodscen.llm._remote.budget import Price
from oodscen.llm._remote.sdk import known_price, load_litellm
from oodscen.llm._remote.usage import IMAGE_TOKENS
from oodscen.metrics._rarity.asking import DRAWS, questions
from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._judging.drive_facts import DriveFacts
from oodscen.prompts._scenario.estimate_rarity import EstimateRarity
from oodscen.protocols import LLM, Completion, Request, Usage
from oodscen.study._config import StudyConfig
from oodscen.study._stale_verdicts import Tables
from oodscen.study._store import Store
from oodscen.study._study import Study

DESCRIPTION = "word " * 60
"""A text as long as a model's description of a frame."""


def estimate(
    out: str | Path, config: StudyConfig, options: RunOptions | None = None
) -> list[Account]:
    """Return the calls, tokens and cost that a run into a folder still needs, per stage and model.

    The text stages run in a temporary folder that starts with a copy of the folder's files. The built-in
    author stands in for every model that would be asked, so the prompts have the size of the real ones and
    the answers are as long as the author's. Repairs and retries come on top. No model is asked, nothing is
    simulated and the folder is not changed.

    Args:
        out: The study's folder, which need not exist.
        config: What would be run.
        options: How it would be run; prices are for models whose price litellm does not know.

    Raises:
        UsageError: When a run would be refused: an unknown model, a malformed address, a cap on the cost of a model
            without a price, a simulator that workers cannot import, unusable ordinary texts.
        StudyMismatch: When the folder holds a study of another configuration.
        FolderTaken: When the folder holds no study, but files that a study would write.
    """
    study, options = Study(out), options or RunOptions()
    study.check()
    check_workers(config.simulator, options.workers, options.executor)
    models = Models(config, study.store, options)
    for name in config.models:
        models.get(name)
    prices = options.limits.prices
    with temporary_folder() as folder:
        _copy(study, Path(folder))
        names = {
            config.llm,
            config.red_llm or config.llm,
            *filter(None, [config.fallback, config.recogniser]),
        }
        authors = {
            name: _PricedAuthor(name, config.seed, prices) for name in names if is_asked(name)
        }
        stand_ins = {**options.models, **authors}
        pipeline = Pipeline(
            folder,
            config,
            RunOptions(models=stand_ins, progress=options.progress, tree=options.tree),
        )
        try:
            pipeline.prepare()
        except StudyMismatch as error:
            raise StudyMismatch(str(out), error.differences) from None
        store = Store(folder)
        texts = pipeline.write_texts().scenarios
        scenes = pipeline.stage(texts)
        lines = [line for line in store.lines("calls.jsonl") if line["model"] in authors]
        if config.rarity_llm is not None and is_asked(config.rarity_llm):
            model = _PricedAuthor(config.rarity_llm, config.seed, prices)
            lines += [
                model.line(Request(prompt, prompt.messages(), prompt.answer_schema()), "metrics")
                for prompt in questions([text.text for text in texts])
                for _ in range(DRAWS)
            ]
        kept = _kept(study)
        for name in filter(is_asked, config.vlms):
            model = _PricedAuthor(name, config.seed, prices)
            lines += [
                model.line(Request(prompt, prompt.messages(), prompt.answer_schema()))
                for scene in scenes
                for verdict, prompts in _judging(scene.id, name, config)
                if verdict not in kept
                for prompt in prompts
            ]
    return accounts(lines)


def _kept(study: Study) -> set[str]:
    """Return the ids of verdicts that a run keeps without a question."""
    if not study.store.holds("verdicts.jsonl"):
        return set()
    verdicts = study.stored_verdicts
    stale = {verdict.id for verdict in Tables.of(study).stale(verdicts)}
    return {verdict.id for verdict in verdicts if not verdict.retryable} - stale


def _items(scene_id: str, config: StudyConfig) -> tuple[str, ...]:
    """Return the items of a scene that models are asked about, as if all of them ran."""
    if not config.demands:
        return (scene_id, twin_id(scene_id))
    return (scene_id, *ordinary_drives(scene_id, seed=config.seed)[: config.ordinary])


def _copy(study: Study, target: Path) -> None:
    for name in study.own():
        if ".json" in name and name != "calls.jsonl":
            try:
                shutil.copy(study.store.path(name), target / name)
            except OSError as error:
                raise unreadable("study", study.folder / name, error) from None


def _judging(
    scene_id: str, model: str, config: StudyConfig
) -> Iterator[tuple[str, Sequence[Prompt[Any]]]]:
    """Yield the verdicts of a model on a scene and its ordinary drives, each with its questions."""
    protocols = config.protocols_of(model)
    for item in _items(scene_id, config):
        if "ours" in protocols:
            yield verdict_id(item, model), _questions(config)
        if model in config.withheld:
            row = without_pictures(model)
            yield verdict_id(item, row), _questions(config, is_withheld=True)
    if "paper" in protocols:
        yield verdict_id(scene_id, model, "paper"), _questions_of_the_paper(config)


def _questions(config: StudyConfig, *, is_withheld: bool = False) -> list[Prompt[Any]]:
    """Return the questions about one item, at their expected length."""
    shown = _shown(moments(config.frames), is_rear=config.rear_view)
    chain = _chain(shown) if config.chain and not is_withheld else []
    descriptions = (DESCRIPTION,) * len(chain)
    kinds = [AspectOption(id=str(n), label="word " * 10 + str(n)) for n in range(LISTED + 1)]
    if is_withheld:
        shown = shown.without_pictures()
    return [
        *chain,
        naming_prompt(shown, descriptions),
        choosing_prompt(shown, kinds, descriptions),
        acting_prompt(shown, descriptions),
    ]


def _questions_of_the_paper(config: StudyConfig) -> list[Prompt[Any]]:
    """Return the questions of the paper's protocol about one scene, at their expected length.

    Both drives begin with the same picture; of as many, it is described once.
    """
    before, whole = _shown(moments(config.frames)), _shown(MOMENTS)
    chain, whole_chain = _chain(before), _chain(whole)
    return [
        *chain,
        acting_prompt(before, (DESCRIPTION,) * len(chain), "paper"),
        *whole_chain[before == whole :],
        naming_prompt(whole, (DESCRIPTION,) * len(whole_chain), "paper"),
    ]


def _shown(names: Sequence[str], *, is_rear: bool = False) -> ShownDrive:
    """Return a drive of so many pictures with facts of the usual length."""
    frames = tuple(Image(name=f"{name}.jpg", sha256="0" * 64) for name in names)
    facts = DriveFacts(times_s=(0.0,) * len(frames), ego_speed_mps=10.0, behind="a lorry")
    return ShownDrive(frames, facts, frames[0] if is_rear else None)


def _chain(shown: ShownDrive) -> list[DescribeFrame]:
    """Return the questions that have the pictures described in turn."""
    frames = shown.images
    return [
        DescribeFrame(frames=frames[: n + 1], descriptions=(DESCRIPTION,) * n, total=len(frames))
        for n in range(len(frames))
    ]


class _PricedAuthor:
    """The built-in author under another model's name and price."""

    def __init__(self, name: str, seed: int, prices: Mapping[str, Price]) -> None:
        self.name = name
        self._author: LLM = make_llm("builtin", seed=seed)
        self._price = prices.get(name) or _price(name)

    def complete(self, request: Request) -> Completion:
        text = self._author.complete(request).text
        return Completion(text=text, usage=self.usage(request, len(text)))

    def line(self, request: Request, stage: str = "evaluate") -> dict[str, Any]:
        """Return the call of a question with an answer of ordinary length."""
        characters = 300
        if isinstance(request.prompt, EstimateRarity):
            characters = 120 * len(request.prompt.texts)
        usage = self.usage(request, characters)
        cacheable = round(cacheable_share(request) * usage.input_tokens)
        return {
            "stage": stage,
            "model": self.name,
            "requests": 1,
            "cacheable_tokens": cacheable,
            **usage.model_dump(),
        }

    def usage(self, request: Request, characters: int) -> Usage:
        input_tokens = sum(map(_tokens, request.messages))
        output_tokens = characters // CHARACTERS_PER_TOKEN
        cost = self._price.of(input_tokens, output_tokens) if self._price else None
        return Usage(input_tokens=input_tokens, output_tokens=output_tokens, cost_usd=cost)


def _tokens(message: Message) -> int:
    return len(message.text) // CHARACTERS_PER_TOKEN + IMAGE_TOKENS * len(message.images)


def _price(name: str) -> Price | None:
    try:
        return known_price(load_litellm(), name)
    except (MissingExtra, UnknownComponent):
        return None
