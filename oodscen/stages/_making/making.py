"""Making what a catalogue lacks, so that dropped branches can be shown after all."""

from collections.abc import Callable, Collection, Iterable, Sequence
from threading import Lock
from typing import Literal, NamedTuple, Self

from oodscen._study_files import ASSETS
from oodscen._text import one_line
from oodscen.data._additions import Addition
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._category import Category
from oodscen.data._prop import Prop, check_prop
from oodscen.errors import DataError, Issue, LLMError, OodscenError, SceneError
from oodscen.llm._ask import ask, speaker
from oodscen.prompts._scenario.design_prop import DesignedProp, DesignProp, KnownPart
from oodscen.protocols import LLM, Simulator
from oodscen.stages._making.looking import PropLook, ShownProp, look_at
from oodscen.stages._making.recognition import PropRecogniser
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.pruner import Pruner
from oodscen.tree._scenario_tree import ScenarioTree


class Made(Data):
    """Something that was to be made: a subclass has its design."""

    id: str
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    retryable: bool = False
    reason: str = ""
    """Why it could not be made."""
    model: str = ""
    """Name of the model that designed it."""
    prompt: str = ""
    """The question that the model was asked: `purpose@version`."""

    @classmethod
    def failed(cls, name: str, error: LLMError, *, model: str, prompt: str) -> Self:
        """Return something that was not made because its model failed."""
        return cls(
            id=name,
            status="failed",
            error=one_line(str(error)),
            retryable=error.retryable,
            model=model,
            prompt=prompt,
        )


class MadeProp(Made):
    """A thing that was to be made: its design and look, or the reason why there is none."""

    prop: Prop | None = None
    """`None` if it could not be made."""
    look: PropLook | None = None
    """Its size in the simulator's pictures."""
    drawn: str = ""
    """SHA-256 digest of the design that the pictures show."""


class Wanted(NamedTuple):
    """A thing that dropped leaves lack."""

    name: str
    category: Category
    path: tuple[str, ...]
    """Labels of the first leaf that lacks it."""


class PropMaker:
    """Asks for the designs of things that a catalogue lacks, and looks at them.

    A design that the simulator refuses, or that is too small or too faint in its pictures, is sent back with its
    faults. So is one, once, that a vision model does not name; what it does not name then is dropped.

    Args:
        llm: The model that designs.
        simulator: Shows the designs.
        keep: Receives the pictures of every thing that is made.
        recogniser: Names things without knowing what they are to be; without it they are marked as not recognised.
    """

    def __init__(
        self,
        llm: LLM,
        simulator: Simulator,
        keep: Callable[[ShownProp], None] = lambda seen: None,
        recogniser: PropRecogniser | None = None,
    ) -> None:
        self.llm = llm
        self.simulator = simulator
        self.keep = keep
        self.recogniser = recogniser
        self.catalogue: Catalogue = simulator.catalogue()
        self._drawing = Lock()

    def make(self, wanted: Wanted) -> MadeProp:
        question = DesignProp(
            name=wanted.name,
            category=wanted.category,
            path=wanted.path,
            known=self._parts(wanted.category),
        )
        asked = {"model": speaker(self.llm), "prompt": question.citation()}
        looks: dict[str, ShownProp] = {}
        try:
            answer = ask(self.llm, question, check=lambda answer: self._faults(answer, looks))
        except LLMError as error:
            return MadeProp.failed(wanted.name, error, **asked)
        if answer.prop is None:
            return MadeProp(id=wanted.name, reason=one_line(answer.cannot_make), **asked)
        seen = looks[answer.prop.digest()]
        if seen.look.taken_for:
            reason = f"{seen.look.recognised}, which took it for: {seen.look.taken_for}"
            return MadeProp(id=wanted.name, reason=reason, **asked)
        self.keep(seen)
        drawn = answer.prop.digest()
        return MadeProp(id=wanted.name, prop=answer.prop, look=seen.look, drawn=drawn, **asked)

    def draw(self, made: MadeProp) -> MadeProp:
        """Look at a design as it is now; one that was changed counts as not shown to be recognised.

        Raises:
            DataError: When the simulator cannot show it, or it has another id than its line.
        """
        prop = made.prop
        if prop is None:
            return made
        source = f"{ASSETS}, {made.id}"
        if prop.id != made.id:
            raise DataError(Prop.noun, [Issue("prop.id", f"must be {made.id}")], source=source)
        try:
            (seen,) = look_at([prop], self.simulator)
        except SceneError as error:
            raise DataError(Prop.noun, error.issues, source=source) from None
        self.keep(seen)
        is_same = made.drawn in ("", prop.digest())
        look = made.look if is_same else seen.look
        return made.model_copy(update={"look": look, "drawn": prop.digest()})

    def _parts(self, category: Category) -> tuple[KnownPart, ...]:
        """Return what may be a part: things that stand, and bodies of the same category."""
        return tuple(
            KnownPart(
                id=asset.id, length_m=asset.length, width_m=asset.width, height_m=asset.height
            )
            for asset in self.catalogue.assets
            if asset.category in ("object", "work_zone", "vegetation", "signal", category)
        )

    def _faults(self, answer: DesignedProp, looks: dict[str, ShownProp]) -> Sequence[Issue]:
        prop = answer.prop
        if prop is None:
            return []
        faults = check_prop(prop, self.catalogue.assets)
        if faults:
            return [Issue(f"prop.{issue.path}", issue.message) for issue in faults]
        try:
            with self._drawing:
                (seen,) = look_at([prop], self.simulator)
        except OodscenError as error:
            return [Issue("prop", f"the simulator cannot show it: {one_line(str(error))}")]
        if seen.look.faults or self.recogniser is None:
            looks[prop.digest()] = seen
            return [Issue("prop.parts", fault) for fault in seen.look.faults]
        taken_for = self.recogniser.mistakes(prop, seen)
        verdict = f"{'not ' if taken_for else ''}named by {self.recogniser.name}"
        is_first = not any(shown.look.taken_for for shown in looks.values())
        looks[prop.digest()] = seen.judged(verdict, taken_for)
        if not (taken_for and is_first):
            return []
        fault = f"whoever saw it without its name took it for: {taken_for}. Make what tells it apart larger and clearer"
        return [Issue("prop.parts", fault)]


def is_makeable(decision: PruneDecision) -> bool:
    """Return whether a dropped leaf lacks nothing but things and movements, which can be made."""
    return (
        not decision.keep
        and decision.status == "ok"
        and not decision.made
        and bool(decision.lacks)
        and all(lack.kind in ("asset", "behaviour") for lack in decision.lacks)
    )


def additions_to_make(decision: PruneDecision) -> tuple[Addition, ...]:
    """Return what is to be made for a leaf, or was made for it."""
    return decision.lacks if is_makeable(decision) else decision.made_as


def wanted_things(
    tree: ScenarioTree, decisions: Iterable[PruneDecision], catalogue: Catalogue
) -> list[Wanted]:
    """Return the things whose making may restore dropped leaves, each once, in the order of the tree."""
    by_id = {prune_decision.id: prune_decision for prune_decision in decisions}
    known = {asset.id for asset in catalogue.assets}
    found: dict[str, Wanted] = {}
    for leaf in tree.leaves:
        decision = by_id.get(leaf.id)
        if decision is not None:
            for addition in additions_to_make(decision):
                if addition.kind == "asset" and is_id(addition) and addition.name not in known:
                    category = addition.category or "object"
                    found.setdefault(addition.name, Wanted(addition.name, category, decision.path))
    return list(found.values())


def judged_again(
    pruner: Pruner,
    tree: ScenarioTree,
    decisions: Sequence[PruneDecision],
    made: Collection[str],
) -> list[PruneDecision]:
    """Judge the leaves again whose lacking things and movements have all been `made`.

    The pruner's catalogue must have them. A leaf is kept only if it is shown with a thing that was made for it.
    """
    names = {
        decision.id: tuple(lack.name for lack in decision.lacks)
        for decision in decisions
        if is_makeable(decision) and all(lack.name in made for lack in decision.lacks)
    }
    others = {leaf.id for leaf in tree.leaves if leaf.id not in names}
    before = {decision.id: decision for decision in decisions}
    found = []
    for decision in pruner.decisions(tree, others):
        if decision.status == "ok":
            lacks = decision.lacks if decision.keep else decision.lacks or before[decision.id].lacks
            made_as = before[decision.id].lacks
            update = {"made": names[decision.id], "made_as": made_as, "lacks": lacks}
            found.append(decision.model_copy(update=update))
    return found


def is_id(addition: Addition) -> bool:
    """Return whether an addition has a name that can be an id."""
    name = addition.name
    return (
        2 <= len(name) <= 40
        and name[0].isalpha()
        and name.replace("_", "").isalnum()
        and name.isascii()
    )
