"""The pruning prompts: judge whether a simulator can show what one branch, or each of several, describes."""

from collections import Counter
from typing import ClassVar

from pydantic import BaseModel, Field, model_validator
from pydantic.json_schema import SkipJsonSchema

from oodscen._display import Brief
from oodscen._words.wording import is_left_out
from oodscen.data._additions import Addition
from oodscen.data._weather import WEATHER_KINDS
from oodscen.errors import Issue, close_matches
from oodscen.prompts._base import Prompt, without_blanks
from oodscen.prompts._digest import CatalogueDigest
from oodscen.tree._labels import label_fault, same_words

_MOST = 40
"""Largest number of entries of one kind."""


class Substitute(Brief, BaseModel):
    """An asset that stands in for what the simulator does not have."""

    asset: str = Field(description="id of the asset that is shown instead")
    stands_for: str = Field(max_length=160, description="what it stands for")


class BranchJudgement(Brief, BaseModel):
    """Answer: whether a branch can be simulated, with what, or what is missing."""

    @model_validator(mode="before")
    @classmethod
    def _plain(cls, value: object) -> object:
        return without_blanks(value)

    reasoning: str = Field(default="", description="one or two sentences")
    simulatable: bool
    assets: list[str] = Field(
        default=[], max_length=_MOST, description="ids of the assets that realise it"
    )
    states: list[str] = Field(
        default=[], max_length=_MOST, description="`asset: state`, where a state matters"
    )
    behaviours: list[str] = Field(
        default=[], max_length=_MOST, description="ids of the behaviours that realise it"
    )
    weather: list[str] = Field(
        default=[],
        max_length=_MOST,
        description="night, fog, rain, snow or ice, where it is needed",
    )
    traits: list[str] = Field(
        default=[], max_length=_MOST, description="traits that the map must have"
    )
    substitutes: list[Substitute] = Field(
        default=[], max_length=_MOST, description="assets that are near, and not the thing itself"
    )
    label: str = Field(
        default="", description="a narrower label, where only a part of it can be shown; else empty"
    )
    missing: list[Addition] = Field(
        default=[],
        max_length=_MOST,
        description="everything that would have to be added; all of it together restores the branch",
    )
    instead: SkipJsonSchema[list[list[Addition]]] = Field(default=[], max_length=200)
    """Other additions that would restore a branch, each list together; no model is asked for them."""


class JudgeBranch(Prompt[BranchJudgement]):
    """Prune to what the simulator's assets can show (paper, section III-B)."""

    purpose: ClassVar[str] = "judge-branch"
    template: ClassVar[str] = "judge_branch.md"
    answer: ClassVar[type[BaseModel]] = BranchJudgement

    path: tuple[str, ...]
    """Labels from the root down to the leaf."""
    catalogue: CatalogueDigest
    exact: bool = False
    """Only the thing itself counts, no substitute."""

    def check(self, answer: BranchJudgement) -> list[Issue]:
        """Return faults: named entries that do not exist, missing ones that do, or an invalid narrower label."""
        vocabulary = self._vocabulary()
        issues = []
        for field in ("assets", "states", "behaviours", "weather", "traits"):
            for index, name in enumerate(getattr(answer, field)):
                issues += _unknown(f"{field}[{index}]", name, vocabulary[field])
        for index, substitute in enumerate(answer.substitutes):
            issues += _unknown(
                f"substitutes[{index}].asset", substitute.asset, vocabulary["assets"]
            )
        for index, addition in enumerate(answer.missing):
            if is_left_out(addition.name):
                issues.append(
                    Issue(f"missing[{index}]", "leave the list empty if nothing is missing")
                )
            if self._is_offered(addition):
                message = f"{addition.words} is in the list: it is not missing"
                issues.append(Issue(f"missing[{index}]", message))
        issues += self._contradictions(answer)
        if answer.label and answer.simulatable:
            issues += self._check_label(answer)
        return issues

    def _contradictions(self, answer: BranchJudgement) -> list[Issue]:
        """Return faults if the means of a judgement do not go with its yes or no."""
        if not answer.simulatable:
            return [] if answer.missing else [Issue("missing", "say what would have to be added")]
        issues = []
        if answer.missing and not (answer.label or answer.substitutes):
            message = "nothing is missing where all can be shown; where only a part can, name it in `label`"
            issues.append(Issue("missing", message))
        means = (answer.assets, answer.states, answer.behaviours, answer.weather, answer.traits)
        if not any((*means, answer.substitutes)):
            issues.append(Issue("assets", "name what shows it"))
        return issues

    def _check_label(self, answer: BranchJudgement) -> list[Issue]:
        if fault := label_fault(answer.label):
            return [Issue("label", fault)]
        before = self.path[-1] if self.path else ""
        if same_words(answer.label) == same_words(before):
            return [Issue("label", "is the label as it was: leave it empty where all can be shown")]
        if not answer.missing:
            return [Issue("missing", "say what the part that cannot be shown would need")]
        return []

    def _vocabulary(self) -> dict[str, list[str]]:
        """Return the names that an answer may use, by field."""
        return {
            "assets": [asset.id for asset in self.catalogue.assets],
            "states": [
                f"{asset.id}: {state}" for asset in self.catalogue.assets for state in asset.states
            ],
            "behaviours": [behaviour.id for behaviour in self.catalogue.behaviours],
            "weather": [kind for kind in WEATHER_KINDS if self.catalogue.limits.offers(kind)],
            "traits": list(
                dict.fromkeys(trait for road in self.catalogue.maps for trait in road.features)
            ),
        }

    def _is_offered(self, addition: Addition) -> bool:
        """Return whether the catalogue has something that an answer calls missing."""
        catalogue = self.catalogue
        if addition.kind == "asset":
            return bool(catalogue.called(addition.name))
        if addition.kind == "behaviour":
            return addition.name in {behaviour.id for behaviour in catalogue.behaviours}
        if addition.kind == "weather":
            return catalogue.limits.offers(addition.name)
        if addition.kind == "state":
            return addition.name in self._vocabulary()["states"]
        return False


class NumberedJudgement(BranchJudgement):
    """The judgement of one of several branches."""

    number: int = Field(description="number of the kind, counted from 1")


class BranchJudgements(Brief, BaseModel):
    """Answer: one judgement per branch."""

    judgements: list[NumberedJudgement] = Field(description="one for every kind")


class JudgeBranches(Prompt[BranchJudgements]):
    """Judge several branches in one call; the catalogue is read once for all of them."""

    purpose: ClassVar[str] = "judge-branches"
    template: ClassVar[str] = "judge_branches.md"
    answer: ClassVar[type[BaseModel]] = BranchJudgements

    paths: tuple[tuple[str, ...], ...]
    """Labels from the root down to the leaf, for every branch."""
    catalogue: CatalogueDigest
    exact: bool = False
    """Only the things themselves count, no substitutes."""

    def single(self, number: int) -> JudgeBranch:
        """Return the question about one of the branches, counted from 1, alone."""
        path = self.paths[number - 1]
        return JudgeBranch(path=path, catalogue=self.catalogue, exact=self.exact)

    def check(self, answer: BranchJudgements) -> list[Issue]:
        """Return faults: missing, repeated or unknown numbers, and those of every judgement."""
        counts = Counter(judgement.number for judgement in answer.judgements)
        wanted = range(1, len(self.paths) + 1)
        issues = [
            Issue("judgements", f"give exactly one for number {number}, not {counts[number]}")
            for number in wanted
            if counts[number] != 1
        ]
        for index, judgement in enumerate(answer.judgements):
            path = f"judgements[{index}]"
            if judgement.number not in wanted:
                issues.append(Issue(f"{path}.number", f"there is no kind {judgement.number}"))
                continue
            issues += [
                Issue(f"{path}.{fault.path}", fault.message)
                for fault in self.single(judgement.number).check(judgement)
            ]
        return issues


def _unknown(path: str, name: str, known: list[str]) -> list[Issue]:
    if name in known:
        return []
    matches = close_matches(name, known)
    hint = f"; did you mean {' or '.join(matches)}?" if matches else ""
    return [Issue(path, f"{name[:80]!r} is not in the list{hint}")]
