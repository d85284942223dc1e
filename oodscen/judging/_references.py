"""Reference answerers: the scores of constant, random, blind, novelty-based and all-knowing answers.

They carry `kind = "reference"`, answer a `Case` directly, without prompts, and cost nothing. Every
leaderboard shows them beside the models: the oracle is the ceiling, the others are floors.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, Literal, Protocol, TypeGuard, runtime_checkable

from pydantic import Field, field_validator

from oodscen._display import Brief
from oodscen._members import optional
from oodscen.data._base import Data
from oodscen.data._episode import ACTIONS, Episode, best_action
from oodscen.data._pairing import scene_of
from oodscen.data._verdict import NOTHING
from oodscen.errors import LLMError
from oodscen.judging._novelty import novelty_ranks
from oodscen.protocols import Completion, Request


class AspectOption(Data):
    """One option of the closed question: a leaf of the tree, or nothing unusual."""

    id: str
    label: str
    leaves: tuple[str, ...] = ()
    """Ids of the leaves that it stands for, where frames cannot tell several apart; else only `id`."""

    def holds(self, leaf: str) -> bool:
        """Return whether a leaf is meant."""
        return leaf == self.id or leaf in self.leaves


@dataclass(frozen=True, repr=False)
class Case(Brief):
    """One item to be judged, as a reference sees it."""

    episode: Episode
    """The episode with its outcomes, which only the oracle may use."""
    path: Sequence[str] = ()
    """Labels from the root to the leaf of the scene."""
    leaf: str = ""
    options: Sequence[AspectOption] = ()
    """Options of the closed question, as shown."""
    frames: Mapping[str, str] = field(default_factory=dict)
    """File names of the pictures, by moment."""


class Answers(Data):
    """A reference's answers to one case."""

    noun: ClassVar[str] = "answers"

    is_ood: bool
    aspect: str = ""
    confidence: float | None = Field(default=None, ge=0, le=1)
    choice: str | None = None
    action: str | None = None

    @field_validator("action")
    @classmethod
    def _is_known(cls, action: str | None) -> str | None:
        if action not in (None, *ACTIONS):
            raise ValueError(f"unknown action; the actions are {', '.join(ACTIONS)}")
        return action


@runtime_checkable
class Reference(Protocol):
    """An answerer that takes cases instead of prompts: a reference, or a person's recorded answers."""

    name: str
    kind: Literal["reference", "model"]

    def judge(self, case: Case) -> Answers:
        """Answer both tasks about one case."""
        ...


def is_reference(model: object) -> bool:
    """Return whether a model is a reference answerer, built-in or registered."""
    kind: object = optional(model, "kind", "model")
    return isinstance(kind, str) and kind == "reference"


def kind_of_answerer(model: object) -> Literal["model", "reference"]:
    """Return the kind of an answerer, as verdicts state it."""
    return "reference" if is_reference(model) else "model"


def takes_cases(model: object) -> TypeGuard[Reference]:
    """Return whether an answerer takes cases: every reference, and a person's recorded answers."""
    says_so = is_reference(model) or optional(model, "takes_cases", False) is True
    return says_so and isinstance(model, Reference)


class CaseAnswerer(Brief):
    """An answerer that takes cases only."""

    _repr_fields = ("name",)

    kind: ClassVar[Literal["reference", "model"]] = "reference"
    name: str

    def complete(self, request: Request) -> Completion:
        """Refuse to answer a prompt.

        Raises:
            LLMError: Always.
        """
        raise LLMError(f"{self.name} takes cases, not prompts", model=self.name)


class Oracle(CaseAnswerer):
    """Knows the truth: right about every aspect, and safe if any action is."""

    name = "oracle"

    def judge(self, case: Case) -> Answers:
        """Answer from the ground truth."""
        action = best_action(case.episode.actions) or "emergency_brake"
        if case.episode.is_ordinary:
            return Answers(is_ood=False, confidence=1.0, choice=NOTHING, action=action)
        label = case.path[-1] if case.path else ""
        choice = next((option.id for option in case.options if option.holds(case.leaf)), case.leaf)
        return Answers(
            is_ood=True, aspect=label, confidence=1.0, choice=choice or None, action=action
        )


class Blind(CaseAnswerer):
    """Sees the questions but no picture, and gives the answers that are most often right.

    It calls everything OOD with a confidence of one half, names the most frequent leaf of the other paths, picks the
    option of the list whose leaves are the most frequent, and chooses the action that is most often safe in the scenes
    and twins of other paths. This is the score within reach of a model that has read about the benchmark and never
    looks.

    Args:
        episodes: Episodes of the study, for the prior.
        leaves: Leaf and its label of every scene, by scene id.
    """

    name = "blind"

    def __init__(self, episodes: Sequence[Episode], leaves: Mapping[str, tuple[str, str]]) -> None:
        self._safe: Counter[str] = Counter()
        self._safe_of: dict[str, Counter[str]] = {}
        self._count: Counter[str] = Counter()
        self._labels = dict(leaves.values())
        for episode in episodes:
            if episode.status != "ok":
                continue
            leaf = leaves.get(scene_of(episode.scene_id), ("", ""))[0]
            self._safe.update(episode.safe_set)
            self._safe_of.setdefault(leaf, Counter()).update(episode.safe_set)
            self._count[leaf] += not episode.is_ordinary

    def judge(self, case: Case) -> Answers:
        """Return the same answers everywhere, up to the list and the prior from the other paths."""
        safe_on_path = self._safe_of.get(case.leaf, Counter[str]())
        action = max(ACTIONS, key=lambda name: self._safe[name] - safe_on_path[name])
        others = [leaf for leaf in sorted(self._count) if leaf != case.leaf]
        leaf = max(others, key=lambda name: self._count[name], default=case.leaf)
        listed = {
            option.id: sum(self._count[name] for name in {option.id, *option.leaves})
            for option in case.options
            if option.id != NOTHING
        }
        choice = max(sorted(listed), key=lambda name: listed[name], default=leaf)
        aspect = self._labels.get(leaf, "")
        return Answers(
            is_ood=True, aspect=aspect, confidence=0.5, choice=choice or None, action=action
        )


class NoveltyReference(CaseAnswerer):
    """Measures the novelty of the last frame with classical vision, without any model.

    A frame is called OOD if its novelty exceeds the median novelty of the ordinary frames, each measured the same
    way by `novelty_ranks`; the answer is then to stop, else to keep the speed. It cannot name what is unusual.

    Args:
        pictures: File of the last frame by scene id, of scenes and twins.
        maps: Map by scene id.

    Raises:
        MissingExtra: If OpenCV is not installed.
    """

    name = "novelty"

    def __init__(self, pictures: Mapping[str, Path], maps: Mapping[str, str]) -> None:
        self._share = novelty_ranks(pictures, maps)

    def judge(self, case: Case) -> Answers:
        """Answer from the novelty of the last frame."""
        share = self._share.get(case.episode.scene_id, 0.5)
        is_ood = share > 0.5
        confidence = round(share if is_ood else 1.0 - share, 6)
        if is_ood:
            return Answers(is_ood=True, confidence=confidence, action="stop")
        return Answers(is_ood=False, confidence=confidence, choice=NOTHING, action="keep_speed")


NAMED = (*(f"constant:{action}" for action in ACTIONS), "random")
"""References of every study that are made by their names alone."""
ALWAYS = (*NAMED, Blind.name, NoveltyReference.name, Oracle.name)
"""References of every study."""
