"""Inspection of a whole knowledge base: faults that appear only when its hazards are combined.

`validation` checks single entries. Inspection compares hazards with each other, with the recogniser
that must tell them apart, and with the catalogues that must show them.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from itertools import combinations
from pathlib import Path

from oodscen._arguments import checked
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._knowledge.designs import load_motions
from oodscen.author._knowledge.loading import (
    KnowledgeFiles,
    file_of,
    gather,
    load_knowledge,
    own_files,
)
from oodscen.author._knowledge.validation import validate_knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._reading.stemming import stems
from oodscen.author._realisation import NO_RECIPE, realise
from oodscen.author._staging.drafting import Stager
from oodscen.data._catalogue import Catalogue
from oodscen.data._scenario import Scenario
from oodscen.errors import AnswerError, Issue, LLMError
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._scenario.stage_scene import StageScene
from oodscen.protocols import Completion, Request
from oodscen.stages._augment import Augmenter

_NEAR_SHARE = 0.7
"""Share of common words from which two phrasings of one hazard count as duplicates."""
_TYPO_RATIO = 0.82
"""Similarity from which an unknown name counts as a misspelling."""
_DISTANCE = "about 40 metres ahead"


@dataclass(frozen=True)
class Inspection:
    """The result of an inspection."""

    faults: tuple[Issue, ...]
    """Faults to fix, each with file, line and hazard."""
    notes: tuple[Issue, ...]
    """Possible faults that may be intended."""
    hazards: int
    """Number of inspected hazards that could be read in full: those of the file, or all shipped ones."""
    families: int
    recipes: int
    shown: Mapping[str, int]
    """Number of hazards that can be shown and staged, by catalogue name."""


@checked
def inspect_knowledge(
    path: str | Path | None = None, catalogues: Mapping[str, Catalogue] | None = None
) -> Inspection:
    """Find all faults of a knowledge base.

    Args:
        path: A user's file or folder, read on top of the shipped knowledge base; only its hazards
            are inspected. `None` inspects the shipped ones.
        catalogues: Catalogues of simulators, by name. Each recipe is tried on the first catalogue
            that has everything the hazard needs and the files of its maps.
    """
    faults = validate_knowledge(path)
    nothing = Inspection(tuple(faults), (), 0, 0, 0, {})
    is_unreadable = any(not issue.path for issue in faults)
    if is_unreadable:
        return nothing
    shelf, knowledge = gather(path, salvaged=True)
    if knowledge is None:
        return nothing
    own = None if path is None else own_files(Path(path))

    def is_own(where: str) -> bool:
        return own is None or file_of(where) in own

    places = {hazard.id: where for where, hazard in shelf.hazards if is_own(where)}
    hazards = [hazard for hazard in knowledge.hazards if hazard.id in places]
    whole = [hazard for hazard in hazards if places[hazard.id] not in shelf.salvaged]
    findings = _Findings(shelf, places, [issue for issue in faults if is_own(issue.path)])
    recogniser, owners = Recogniser(knowledge), _owners(knowledge)
    for hazard in hazards:
        findings.add(hazard, _wording(hazard, recogniser))
        findings.notes += findings.at(hazard, _blurred(hazard, owners))
    catalogues = catalogues or {}
    offered = {name: CatalogueDigest.of(catalogue) for name, catalogue in catalogues.items()}
    _check_needs(findings, hazards, list(offered.values()), knowledge)
    recipes = [hazard for hazard in hazards if hazard.stage is not None]
    able = {
        name: [recipe for recipe in recipes if not realise(recipe, digest, knowledge).missing]
        for name, digest in offered.items()
    }
    _check_staging(findings, recipes, able, catalogues, _StagingLLM(Stager(knowledge, recogniser)))
    return Inspection(
        faults=tuple(findings.faults),
        notes=tuple(findings.notes),
        hazards=len(whole),
        families=len({hazard.family for hazard in whole}),
        recipes=sum(hazard.stage is not None for hazard in whole),
        shown={name: len(hazards) for name, hazards in able.items()},
    )


def showable_kinds(catalogue: Catalogue) -> tuple[int, int]:
    """Return how many of the shipped hazards that have a recipe a catalogue can show, and their number."""
    return _showable(CatalogueDigest.of(catalogue))


@lru_cache(maxsize=8)
def _showable(digest: CatalogueDigest) -> tuple[int, int]:
    knowledge = load_knowledge()
    kinds = [hazard for hazard in knowledge.hazards if hazard.stage is not None]
    realisations = [realise(hazard, digest, knowledge) for hazard in kinds]
    return sum(
        not realisation.missing and not realisation.substitutes for realisation in realisations
    ), len(kinds)


class _Findings:
    """Faults and notes, each with file, line and hazard; none about parts of an entry that could not be read."""

    def __init__(
        self, shelf: KnowledgeFiles, places: Mapping[str, str], faults: list[Issue]
    ) -> None:
        self.faults = faults
        self.notes: list[Issue] = []
        self._shelf, self._places = shelf, places

    def at(self, hazard: HazardKind, issues: Iterable[Issue]) -> list[Issue]:
        """Return issues with the place of their hazard."""
        where = self._places[hazard.id]
        located = (Issue(f"{where}: {issue.path}", issue.message) for issue in issues)
        return [issue for issue in located if not self._shelf.is_broken(issue)]

    def add(self, hazard: HazardKind, issues: Iterable[Issue]) -> None:
        """Record the faults of a hazard."""
        self.faults += self.at(hazard, issues)


class _StagingLLM:
    """A stub model that only stages, for knowledge bases that an author would reject."""

    name = "builtin"

    def __init__(self, stager: Stager) -> None:
        self._stager = stager

    def complete(self, request: Request) -> Completion:
        prompt = request.prompt
        if not isinstance(prompt, StageScene):
            raise LLMError(f"nothing but scenes, no {prompt.purpose!r}", model=self.name)
        draft = self._stager.stage(prompt, 0, request.attempt - 1)
        return Completion(text=draft.model_dump_json())


def _wording(hazard: HazardKind, recogniser: Recogniser) -> Iterator[Issue]:
    """Yield phrasings that duplicate each other or are recognised as another hazard."""
    bare = [frozenset(stems(event.replace("{where}", ""))) for event in hazard.events]
    for (earlier, words), (later, others) in combinations(enumerate(bare), 2):
        share = len(words & others) / max(1, len(words | others))
        if share >= _NEAR_SHARE:
            message = (
                f"shares {share:.0%} of its words with events[{earlier}]: rephrase one of them"
            )
            yield Issue(f"events[{later}]", message)
    for index, event in enumerate(hazard.events):
        kind = recogniser.recognise(event.replace("{where}", _DISTANCE)).hazard
        if kind is None:
            yield Issue(f"events[{index}]", "is not recognised: use the hazard's own words")
        elif kind.id != hazard.id:
            yield Issue(f"events[{index}]", f"reads like {kind.id!r} ({kind.label})")
    seen: set[str] = set()
    for index, word in enumerate(hazard.words):
        if word.casefold() in seen:
            yield Issue(f"words[{index}]", f"{word!r} occurs twice")
        seen.add(word.casefold())
    if any(len(clause.split()) < 3 for clause in hazard.ordinary):
        yield Issue("ordinary", "say in a clause what the ordinary counterpart is")


def _owners(knowledge: Knowledge) -> dict[str, set[str]]:
    """Return the ids of the hazards with each distinctive word, by its stem."""
    owners: dict[str, set[str]] = {}
    for hazard in knowledge.hazards:
        for word in hazard.words:
            owners.setdefault(" ".join(stems(word)), set()).add(hazard.id)
    return owners


def _blurred(hazard: HazardKind, owners: Mapping[str, set[str]]) -> Iterator[Issue]:
    """Yield a note if a hazard shares all of its distinctive words with others."""
    sharing = [owners[" ".join(stems(word))] - {hazard.id} for word in hazard.words]
    if sharing and all(sharing):
        others = ", ".join(sorted(set().union(*sharing))[:4])
        yield Issue("words", f"none is its own; shared with {others}")


def _check_needs(
    findings: _Findings,
    hazards: Sequence[HazardKind],
    offered: Sequence[CatalogueDigest],
    knowledge: Knowledge,
) -> None:
    """Find needs that no catalogue meets, which are faults if a similar name exists, and things without a category."""
    known = {
        "asset": {
            name
            for digest in offered
            for asset in digest.assets
            for name in (asset.id, *asset.names)
        },
        "behaviour": {kind.id for digest in offered for kind in digest.behaviours},
        "map": {trait for digest in offered for road in digest.maps for trait in road.features},
    }
    unmet: dict[str, list[str]] = {}
    for hazard in hazards:
        lacks = [set(realise(hazard, digest, knowledge).missing) for digest in offered]
        lacked = set.intersection(*lacks) - {NO_RECIPE} if lacks else set()
        used = hazard.stage.behaviours if hazard.stage else ()
        for need in sorted(lacked, key=lambda addition: addition.words):
            names = sorted(known.get(need.kind, ()))
            matches = get_close_matches(need.name, names, 2, _TYPO_RATIO)
            is_own = knowledge.category(need.name) is not None
            if matches and not is_own and need.kind in ("asset", "behaviour"):
                fault = f"{need.words}: did you mean {' or '.join(matches)}?"
                findings.add(hazard, [Issue("needs", fault)])
            elif need.kind == "behaviour" and need.name in used and need.name not in load_motions():
                fault = f"{need.words}: no catalogue has it to stage this with"
                findings.add(hazard, [Issue("stage.actors", fault)])
            else:
                unmet.setdefault(need.words, []).append(hazard.id)
    for words, wanting in sorted(unmet.items()):
        message = f"no catalogue has it; wanted by {', '.join(sorted(wanting))}"
        findings.notes.append(Issue(words, message))
    for name in _uncategorised(hazards, knowledge):
        findings.notes.append(Issue(name, "has no category: add it to [[things]]"))


def _uncategorised(hazards: Iterable[HazardKind], knowledge: Knowledge) -> list[str]:
    """Return the things that hazards need but that have no category."""
    recipes = [hazard.stage for hazard in hazards if hazard.stage]
    named = {name for hazard in hazards for name in hazard.needs.assets}
    named |= {name for recipe in recipes for actor in recipe.actors for name in actor.asset}
    return sorted(name for name in named if knowledge.category(name) is None)


def _check_staging(
    findings: _Findings,
    recipes: Sequence[HazardKind],
    able: Mapping[str, Sequence[HazardKind]],
    catalogues: Mapping[str, Catalogue],
    author: _StagingLLM,
) -> None:
    """Compare the recipes with the first catalogue that has map files, and try each once where it is `able` to show it."""
    with_files = {
        name: catalogue
        for name, catalogue in catalogues.items()
        if any(road.file for road in catalogue.maps)
    }
    first = next(iter(with_files.values()), None)
    if first is not None:
        digest = CatalogueDigest.of(first)
        for hazard in recipes:
            findings.add(hazard, _unfit(hazard, first, digest))
    tried: set[str] = set()
    for name, catalogue in with_files.items():
        augmenter = Augmenter(author, catalogue, claims=False)
        for hazard in able[name]:
            if hazard.id not in tried:
                tried.add(hazard.id)
                findings.add(hazard, _unstaged(hazard, augmenter, name))


def _unfit(hazard: HazardKind, catalogue: Catalogue, digest: CatalogueDigest) -> Iterator[Issue]:
    """Yield states, parameters and behaviours of a recipe that its assets do not have, which staging ignores."""
    kinds = {kind.id: kind for kind in catalogue.behaviours}
    for index, actor in enumerate(hazard.stage.actors if hazard.stage else ()):
        where = f"stage.actors[{index}]"
        assets = [asset for name in actor.asset for asset in digest.called(name)]
        if assets and actor.state and not any(actor.state in asset.states for asset in assets):
            known = ", ".join(assets[0].states) or "none"
            yield Issue(f"{where}.state", f"{assets[0].id} has no {actor.state!r}; known: {known}")
        kind = kinds.get(actor.behaviour)
        if kind is None:
            continue
        if assets and not any(asset.category in kind.categories for asset in assets):
            able = ", ".join(kind.categories)
            message = f"{kind.id} is for {able}; {assets[0].id} is {assets[0].category}"
            yield Issue(f"{where}.behaviour", message)
        for name, drawn in actor.parameters.items():
            allowed = kind.parameters.get(name)
            if allowed is None:
                known = ", ".join(kind.parameters) or "none"
                message = f"{kind.id} has no parameter {name!r}; known: {known}"
                yield Issue(f"{where}.parameters", message)
            elif drawn != "ego" and not allowed.minimum <= drawn[0] <= drawn[1] <= allowed.maximum:
                message = f"outside {allowed.minimum:g} to {allowed.maximum:g}"
                yield Issue(f"{where}.parameters.{name}", message)


def _unstaged(hazard: HazardKind, augmenter: Augmenter, catalogue: str) -> Iterator[Issue]:
    """Stage the hazard from its first phrasing and report any failures."""
    text = hazard.events[0].replace("{where}", "").replace("  ", " ").strip() + "."
    scenario = Scenario(id="check", text=text, path=("x", "y", hazard.family, hazard.label))
    try:
        augmenter.run(scenario)
    except AnswerError as error:
        for issue in error.issues:
            yield Issue(f"stage: on {catalogue}: {issue.path}", issue.message)
    except LLMError as error:
        yield Issue(f"stage: on {catalogue}", str(error))
