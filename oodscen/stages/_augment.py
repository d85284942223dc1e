"""Augment a text with everything a simulator needs: the scene (paper, section III-B)."""

from collections.abc import Callable, Sequence

from pydantic import ValidationError

from oodscen.data._base import issues_of
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.errors import Issue
from oodscen.llm._ask import ATTEMPTS, ask
from oodscen.prompts import CatalogueDigest, SceneDraft, StageScene
from oodscen.prompts._fitting import fitted
from oodscen.protocols import LLM


class Augmenter:
    """Asks the augmenter-LLM to stage texts; what it returns has passed validation and runs.

    Before a text is staged, its claims are read from the text alone, and every scene is compared with them; what
    a scene contradicts is fed back to the model, claim by claim.

    Args:
        llm: The augmenter-LLM.
        catalogue: What the simulator offers.
        check: Finds faults in a scene; they are fed back to the model. The default checks the
            catalogue's vocabulary, places on the road, overlap and reachability.
        attempts: Largest number of calls per scene.
        claims: Whether scenes must hold to what their texts say.
        reader: Reads the claims; the augmenter-LLM if left out.
        context: Tokens that the model can read and write, where the whole catalogue is too long for it.
    """

    def __init__(
        self,
        llm: LLM,
        catalogue: Catalogue,
        *,
        check: Callable[[Scene, Catalogue], Sequence[Issue]] | None = None,
        attempts: int = ATTEMPTS,
        claims: bool = True,
        reader: LLM | None = None,
        context: int | None = None,
    ) -> None:
        if check is None:
            from oodscen.driving import check_scene

            check = check_scene
        self.llm = llm
        self.catalogue = catalogue
        self.digest = CatalogueDigest.of(catalogue)
        self.check = check
        self.attempts = attempts
        self.claims = claims
        self.reader = reader or llm
        self.context = context

    def read(self, scenario: Scenario) -> tuple[Claim, ...]:
        """Return what a text says, none where claims are not asked for.

        Raises:
            AnswerError: When the model does not arrive at valid claims; it lists the faults.
            LLMError: When the model cannot be reached.
        """
        if not self.claims:
            return ()
        from oodscen.claims import extract_claims

        return extract_claims(self.reader, scenario.text, attempts=self.attempts)

    def run(self, scenario: Scenario, claims: Sequence[Claim] | None = None) -> Scene:
        """Return the scene for one text; its id is the scenario's.

        Args:
            scenario: With the text.
            claims: What the text says, where that has been read before.

        Raises:
            AnswerError: When the model does not arrive at a scene that runs and holds to the text;
                it lists the faults, and every claim that is contradicted.
            LLMError: When the model cannot be reached.
        """
        told = self.read(scenario) if claims is None else tuple(claims)
        prompt = StageScene(text=scenario.text, path=scenario.path, catalogue=self.digest)
        draft = ask(
            self.llm,
            fitted(prompt, self.context),
            check=lambda draft: self._faults(scenario, told, draft),
            attempts=self.attempts,
        )
        return _staged(scenario, draft)

    def _faults(
        self, scenario: Scenario, claims: Sequence[Claim], draft: SceneDraft
    ) -> Sequence[Issue]:
        try:
            scene = _staged(scenario, draft)
        except ValidationError as error:
            return issues_of(error)
        faults = self.check(scene, self.catalogue)
        if faults or not claims:
            return faults
        from oodscen.claims import check_claims

        found = check_claims(claims, scene, self.catalogue)
        return [Issue(mismatch.path, str(mismatch)) for mismatch in found]


def _staged(scenario: Scenario, draft: SceneDraft) -> Scene:
    """Make the scene; a decision that names no actor is measured to the first of the hazard's."""
    decision = draft.decision
    if decision.kind != "time" and decision.actor is None:
        first = next(iter(draft.hazard.actors), None)
        decision = decision.model_copy(update={"actor": first})
    return Scene(
        id=scenario.id,
        scenario_id=scenario.id,
        map=draft.map,
        ego=draft.ego,
        weather=draft.weather,
        actors=tuple(draft.actors),
        hazard=draft.hazard,
        decision=decision,
        horizon_s=draft.horizon_s,
    )
