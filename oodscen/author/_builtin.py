"""The default author: deterministic, embedded, built on a knowledge base instead of a language model."""

from collections.abc import Callable, Sequence
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from oodscen._display import Brief
from oodscen._seeding import stream
from oodscen._words.text import folded_words
from oodscen.author._feasibility import BranchJudge
from oodscen.author._imagining import Imagination
from oodscen.author._knowledge.base import HazardKind
from oodscen.author._knowledge.designs import design_motion, design_prop
from oodscen.author._knowledge.loading import load_knowledge, stamp_of
from oodscen.author._reading.claim_extraction import read_claims
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._settings import Scope, Showable
from oodscen.author._staging.drafting import Stager
from oodscen.author._taxonomy import TreeAuthor
from oodscen.author._writing.compose import Composer
from oodscen.author._writing.ordinary_twin import OrdinaryAuthor
from oodscen.driving._motion.behaviours.table import USUAL
from oodscen.errors import LLMError
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._scenario.describe_ordinary import DescribeOrdinary, OrdinaryText
from oodscen.prompts._scenario.describe_path import DescribePath, Descriptions
from oodscen.prompts._scenario.design_motion import DesignMotion
from oodscen.prompts._scenario.design_prop import DesignProp
from oodscen.prompts._scenario.extract_claims import MOST_CLAIMS, Claims, ExtractClaims
from oodscen.prompts._scenario.mark_hazard import MarkedHazard, MarkHazard
from oodscen.prompts._scenario.stage_scene import StageScene
from oodscen.prompts._tree.classify_examples import (
    Classification,
    ClassifiedExample,
    ClassifyExamples,
)
from oodscen.prompts._tree.give_examples import Examples, GiveExamples
from oodscen.prompts._tree.imagine_scenario import ImaginedScenario, ImagineScenario
from oodscen.prompts._tree.judge_branch import JudgeBranch, JudgeBranches
from oodscen.prompts._tree.place_scenario import PlaceScenario
from oodscen.prompts._tree.propose_tree import ProposeTree
from oodscen.protocols import Completion, Request

_WORDS_OF_ACTS = frozenset(
    """driver drives pedestrian cyclist motorcyclist child dog deer animal crowd police runs walks
    crosses overtakes swerves brakes reverses cuts merges jumps changes chases""".split()
)
"""Words of texts about actions, by which an unknown scenario counts as interactional."""


class BuiltinAuthor(Brief):
    """Answers every text prompt from a knowledge base of hazards.

    It is not a model: it recognises hazards by their words and composes sentences and scenes from
    phrases, ranges and a seed. It sees only the fields of the prompt, and it cannot see images.
    """

    _repr_fields = ("name", "seed", "knowledge")

    name = "builtin"
    argument = "knowledge"
    """Name of the argument after the colon: `builtin:FILE`."""

    def __init__(self, seed: int = 0, knowledge: str | Path | None = None) -> None:
        """Load the knowledge base.

        Args:
            seed: Seed of every random choice.
            knowledge: A TOML file, or a folder of them, that extends the shipped knowledge base.

        Raises:
            DataError: If the knowledge base cannot be read.
        """
        self.seed = seed
        self.knowledge = None if knowledge is None else Path(knowledge)
        if self.knowledge is not None:
            self.name = f"builtin:{self.knowledge.name}"
        self._knowledge = load_knowledge(knowledge)
        self._recogniser = _recogniser(self.knowledge, stamp_of(self.knowledge))
        self._composer = Composer(self._knowledge)
        self._imagination = Imagination(seed, self._knowledge, self._recogniser)
        self._trees = TreeAuthor(self._knowledge, self._recogniser)
        self._judge = BranchJudge(self._recogniser)
        self._stager = Stager(self._knowledge, self._recogniser)
        self._answers: dict[type, Callable[[Any, Request], BaseModel]] = {
            GiveExamples: self._give_examples,
            ClassifyExamples: lambda prompt, request: Classification(
                examples=[
                    self._classified(number, text)
                    for number, text in enumerate(prompt.given, start=1)
                ]
            ),
            ProposeTree: lambda prompt, request: self._trees.propose(
                prompt, self._stream(request, prompt.nodes)
            ),
            ImagineScenario: self._imagine,
            PlaceScenario: lambda prompt, request: self._trees.place(prompt),
            JudgeBranch: lambda prompt, request: self._judge.judge(prompt),
            JudgeBranches: lambda prompt, request: self._judge.judge_all(prompt),
            DesignMotion: lambda prompt, request: design_motion(prompt),
            DesignProp: lambda prompt, request: design_prop(prompt),
            DescribePath: self._describe,
            DescribeOrdinary: self._describe_ordinary,
            ExtractClaims: lambda prompt, request: Claims(
                claims=list(read_claims(prompt.text)[:MOST_CLAIMS])
            ),
            StageScene: lambda prompt, request: self._stager.stage(
                prompt, self.seed, request.attempt - 1
            ),
            MarkHazard: lambda prompt, request: _mark_hazard(prompt),
        }

    def __reduce__(self) -> tuple[type["BuiltinAuthor"], tuple[int, Path | None]]:
        return (BuiltinAuthor, (self.seed, self.knowledge))

    def complete(self, request: Request) -> Completion:
        """Answer one request as JSON text.

        Raises:
            LLMError: If the prompt is about images or goes beyond the knowledge base.
        """
        answer = self._answers.get(type(request.prompt))
        if answer is None:
            raise LLMError(
                f"the built-in author writes texts and cannot see: it has no answer to "
                f"{request.prompt.purpose!r}",
                model=self.name,
            )
        return Completion(text=answer(request.prompt, request).model_dump_json())

    def _stream(self, request: Request, *keys: object) -> np.random.Generator:
        return stream(self.seed, request.prompt.purpose, *keys, request.sample)

    def _give_examples(self, prompt: GiveExamples, request: Request) -> Examples:
        rng = self._stream(request, prompt.count)
        hazards = map(self._hazard, prompt.shown)
        shown = {hazard.id for hazard in hazards if hazard is not None}
        of_classes = [self._deck(name, shown, rng) for name in ("environmental", "interactional")]
        decks = [deck for deck in of_classes if deck]
        taken = {folded_words(text) for text in prompt.shown}
        texts = []
        for number in range(prompt.count):
            deck = decks[number % len(decks)]
            hazard = deck[(number // len(decks)) % len(deck)]
            text = next(self._composer.texts(hazard, rng, taken), None)
            if text is None:
                raise LLMError(
                    f"the built-in author runs out of different examples after {number} of {prompt.count}",
                    model=self.name,
                )
            texts.append(text)
        return Examples(examples=texts)

    def _deck(self, class_name: str, shown: set[str], rng: np.random.Generator) -> list[HazardKind]:
        """Return the hazards of a class that were not shown, or all, at random behind the `first` ones."""
        hazards = self._knowledge.of_class(class_name)
        new = [hazard for hazard in hazards if hazard.id not in shown] or list(hazards)
        shuffled = [new[index] for index in rng.permutation(len(new))]
        return sorted(shuffled, key=lambda hazard: not hazard.first)

    def _classified(self, number: int, text: str) -> ClassifiedExample:
        hazard = self._hazard(text)
        if hazard is not None:
            name = hazard.class_name
        elif _WORDS_OF_ACTS.isdisjoint(folded_words(text).split()):
            name = "environmental"
        else:
            name = "interactional"
        reason = (
            "An element of the surroundings deviates from its usual state."
            if name == "environmental"
            else "A moving actor does something unusual to which the ego vehicle must react."
        )
        return ClassifiedExample(number=number, reasoning=reason, scenario_class=name)

    def _imagine(self, prompt: ImagineScenario, request: Request) -> ImaginedScenario:
        rng = self._stream(request)
        hazard = self._imagination.hazard(prompt, rng)
        return ImaginedScenario(
            reasoning=f"Rarely met in ordinary traffic, where {hazard.ordinary[0]}.",
            text=self._composer.text(hazard, rng),
        )

    def _describe(self, prompt: DescribePath, request: Request) -> Descriptions:
        label = prompt.path[-1] if prompt.path else ""
        hazards = self._described_by(label)
        if not hazards:
            raise LLMError(f"the built-in author has no knowledge of {label!r}", model=self.name)
        rng = self._stream(request, *prompt.path, prompt.style)
        taken = {folded_words(text) for text in prompt.avoid}
        sources = [
            self._composer.texts(hazard, rng, taken, prompt.style, scope)
            for hazard, scope in self._scopes(hazards, prompt.catalogue)
        ]
        texts: list[str] = []
        while len(texts) < prompt.count and sources:
            source = sources[len(texts) % len(sources)]
            text = next(source, None)
            if text is None:
                sources.remove(source)
            else:
                texts.append(text)
        if len(texts) < prompt.count:
            raise LLMError(
                f"the built-in author has no more than {len(texts)} further texts for {label!r}",
                model=self.name,
            )
        return Descriptions(texts=texts)

    def _scopes(
        self, hazards: Sequence[HazardKind], catalogue: CatalogueDigest | None
    ) -> list[tuple[HazardKind, Scope | None]]:
        """Return the hazards that a catalogue has a place for, or else all, with the settings that it can show."""
        if catalogue is None:
            return [(hazard, None) for hazard in hazards]
        showable = Showable(self._knowledge, catalogue)
        placed = [hazard for hazard in hazards if not showable.lacking_place(hazard)]
        return [(hazard, showable.scope(hazard)) for hazard in placed or hazards]

    def _describe_ordinary(self, prompt: DescribeOrdinary, request: Request) -> OrdinaryText:
        label = prompt.path[-1] if prompt.path else ""
        rng = self._stream(request, prompt.text)
        return OrdinaryText(text=self._twins.twin(prompt.text, label, rng))

    @cached_property
    def _twins(self) -> OrdinaryAuthor:
        """The writer of twins, whose patterns of all places take long to compile."""
        return OrdinaryAuthor(self._knowledge, self._recogniser)

    def _described_by(self, label: str) -> tuple[HazardKind, ...]:
        """Return the hazards that the texts of a leaf describe.

        A widened leaf also stands for the hazard's kin, except for kin that need more from a
        simulator than the leaf's own hazard: a branch judged by one hazard must not be staged as a
        harder one.
        """
        covered = self._recogniser.covered_by(label)
        if not covered:
            return ()
        head = covered[0]
        return (head, *(kin for kin in covered[1:] if _is_as_easy(kin, head)))

    def _hazard(self, text: str) -> HazardKind | None:
        return self._recogniser.recognise(text).hazard


@cache
def _recogniser(path: Path | None, stamp: tuple[tuple[str, int, int], ...]) -> Recogniser:
    """Return the index of a knowledge base, built once per process; it holds no state of any author."""
    del stamp
    return Recogniser(load_knowledge(path))


def _is_as_easy(kin: HazardKind, head: HazardKind) -> bool:
    """Return whether every simulator that can show `head` can also show `kin`."""
    if head.stage is None:
        return True
    if kin.stage is None:
        return False
    return all(
        set(getattr(kin.needs, field)) <= set(getattr(head.needs, field))
        for field in ("assets", "behaviours", "weather", "traits")
    ) and set(kin.stage.behaviours) <= set(head.stage.behaviours)


def _mark_hazard(prompt: MarkHazard) -> MarkedHazard:
    """Mark the first actor that does more than stand or follow its lane."""
    acting = [actor for actor in prompt.actors if actor.does.partition(":")[0] not in USUAL]
    first = next(iter(acting or prompt.actors))
    return MarkedHazard(reasoning=f"{first.id}: {first.does}", actors=[first.id])
