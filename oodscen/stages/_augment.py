"""The augmenter, which turns a text into a complete scene for a simulator (paper, section III-B)."""

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
    """Asks the augmenter-LLM to stage texts; every scene it returns is valid and runs.

    Before staging, the claims of a text are extracted from the text alone. Every scene is checked against
    them, and each contradicted claim is fed back to the model.

    Args:
        llm: The augmenter-LLM.
        catalogue: The assets and abilities of the simulator.
        check: Returns the faults of a scene, which are fed back to the model. The default checks the
            catalogue's vocabulary, places on the road, overlap and reachability.
        attempts: Maximum number of calls per scene.
        claims: Require scenes to satisfy the claims of their texts.
        reader: Model that extracts the claims; the augmenter-LLM if left out.
        context: Context window of the model in tokens, if the whole catalogue is too long for it.
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
        """Return the claims of a text, or none if claims are switched off.

        Raises:
            AnswerError: When the model gives no valid claims; the error lists the faults.
            LLMError: When the model cannot be reached.
        """
        if not self.claims:
            return ()
        from oodscen.claims import extract_claims

        return extract_claims(self.reader, scenario.text, attempts=self.attempts)

    def run(self, scenario: Scenario, claims: Sequence[Claim] | None = None) -> Scene:
        """Return the scene of one text, with the scenario's id.

        Args:
            scenario: The scenario with the text.
            claims: Claims of the text, if already extracted.

        Raises:
            AnswerError: When the model gives no scene that runs and satisfies the claims; the error lists the
                faults and every contradicted claim.
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
    """Return the scene; a decision without an actor refers to the first actor of the hazard."""
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
