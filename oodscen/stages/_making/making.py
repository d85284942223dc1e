"""Making things that a catalogue lacks, so that dropped branches can be shown after all."""

from collections.abc import Callable, Sequence
from threading import Lock
from typing import Literal, Self

from oodscen._io.study_files import ASSETS
from oodscen._words.text import one_line
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._category import Category
from oodscen.data._designs.prop import Prop, check_prop
from oodscen.errors import DataError, Issue, LLMError, OodscenError, SceneError
from oodscen.llm._ask import ask, speaker
from oodscen.prompts._scenario.design_prop import DesignedProp, DesignProp, KnownPart
from oodscen.protocols import LLM, Simulator
from oodscen.stages._making.looking import PropLook, ShownProp, look_at
from oodscen.stages._making.recognition import PropRecogniser
from oodscen.stages._making.wanted import WantedThing


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
        keep: Callable[[ShownProp], None] = lambda shown: None,
        recogniser: PropRecogniser | None = None,
    ) -> None:
        self.llm = llm
        self.simulator = simulator
        self.keep = keep
        self.recogniser = recogniser
        self.catalogue: Catalogue = simulator.catalogue()
        self._drawing = Lock()

    def make(self, wanted: WantedThing) -> MadeProp:
        """Return the design of a thing, or the reason why there is none."""
        question = DesignProp(
            name=wanted.name,
            category=wanted.category,
            path=wanted.path,
            known=self._parts(wanted.category),
        )
        provenance = {"model": speaker(self.llm), "prompt": question.citation()}
        shown: dict[str, ShownProp] = {}
        try:
            answer = ask(self.llm, question, check=lambda answer: self._faults(answer, shown))
        except LLMError as error:
            return MadeProp.failed(wanted.name, error, **provenance)
        if answer.prop is None:
            return MadeProp(id=wanted.name, reason=one_line(answer.cannot_make), **provenance)
        drawn = answer.prop.digest()
        look = shown[drawn].look
        if look.taken_for:
            reason = f"{look.recognised}, which took it for: {look.taken_for}"
            return MadeProp(id=wanted.name, reason=reason, **provenance)
        self.keep(shown[drawn])
        return MadeProp(id=wanted.name, prop=answer.prop, look=look, drawn=drawn, **provenance)

    def draw(self, thing: MadeProp) -> MadeProp:
        """Look at a design as it is now; one that was changed counts as not shown to be recognised.

        Raises:
            DataError: When the simulator cannot show it, or it has another id than its line.
        """
        prop = thing.prop
        if prop is None:
            return thing
        source = f"{ASSETS}, {thing.id}"
        if prop.id != thing.id:
            raise DataError(Prop.noun, [Issue("prop.id", f"must be {thing.id}")], source=source)
        try:
            (shown,) = look_at([prop], self.simulator)
        except SceneError as error:
            raise DataError(Prop.noun, error.issues, source=source) from None
        self.keep(shown)
        is_unchanged = thing.drawn in ("", prop.digest())
        look = thing.look if is_unchanged else shown.look
        return thing.model_copy(update={"look": look, "drawn": prop.digest()})

    def _parts(self, category: Category) -> tuple[KnownPart, ...]:
        """Return what may be a part: things that stand, and bodies of the same category."""
        return tuple(
            KnownPart(
                id=asset.id, length_m=asset.length, width_m=asset.width, height_m=asset.height
            )
            for asset in self.catalogue.assets
            if asset.category in ("object", "work_zone", "vegetation", "signal", category)
        )

    def _faults(self, answer: DesignedProp, shown: dict[str, ShownProp]) -> Sequence[Issue]:
        """Return the faults of a design, and add its pictures to those `shown` by digest."""
        prop = answer.prop
        if prop is None:
            return []
        faults = check_prop(prop, self.catalogue.assets)
        if faults:
            return [Issue(f"prop.{issue.path}", issue.message) for issue in faults]
        try:
            with self._drawing:
                (pictured,) = look_at([prop], self.simulator)
        except OodscenError as error:
            return [Issue("prop", f"the simulator cannot show it: {one_line(str(error))}")]
        if pictured.look.faults or self.recogniser is None:
            shown[prop.digest()] = pictured
            return [Issue("prop.parts", fault) for fault in pictured.look.faults]
        was_mistaken = any(earlier.look.taken_for for earlier in shown.values())
        taken_for = self.recogniser.mistake(prop, pictured)
        verdict = f"{'not ' if taken_for else ''}named by {self.recogniser.name}"
        shown[prop.digest()] = pictured.with_verdict(verdict, taken_for)
        if was_mistaken or not taken_for:
            return []
        fault = (
            f"whoever saw it without its name took it for: {taken_for}. Make what tells it apart larger and "
            "clearer"
        )
        return [Issue("prop.parts", fault)]
