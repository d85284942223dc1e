"""Augment a text with everything a simulator needs: the scene (paper, section III-B)."""

from collections.abc import Callable, Sequence

from pydantic import ValidationError

from oodscen._data import issues_of
from oodscen.ask import ATTEMPTS, ask
from oodscen.catalogue import Catalogue
from oodscen.errors import Issue
from oodscen.prompts import CatalogueDigest, SceneDraft, StageScene
from oodscen.protocols import LLM
from oodscen.scenario import Scenario
from oodscen.scene import Scene


class Augmenter:
    """Asks the augmenter-LLM to stage texts; what it returns has passed validation and runs.

    Args:
        llm: The augmenter-LLM.
        catalogue: What the simulator offers.
        check: Finds faults in a scene; they are fed back to the model. The default checks the
            catalogue's vocabulary, places on the road, overlap and reachability.
        attempts: Largest number of calls per scene.
    """

    def __init__(
        self,
        llm: LLM,
        catalogue: Catalogue,
        *,
        check: Callable[[Scene, Catalogue], Sequence[Issue]] | None = None,
        attempts: int = ATTEMPTS,
    ) -> None:
        if check is None:
            from oodscen.driving import check_scene

            check = check_scene
        self.llm = llm
        self.catalogue = catalogue
        self.digest = CatalogueDigest.of(catalogue)
        self.check = check
        self.attempts = attempts

    def run(self, scenario: Scenario) -> Scene:
        """Return the scene for one text; its id is the scenario's.

        Raises:
            AnswerError: When the model does not arrive at a scene that runs; it lists the faults.
            LLMError: When the model cannot be reached.
        """
        prompt = StageScene(text=scenario.text, path=scenario.path, catalogue=self.digest)
        draft = ask(
            self.llm,
            prompt,
            check=lambda draft: self._faults(scenario, draft),
            attempts=self.attempts,
        )
        return _staged(scenario, draft)

    def _faults(self, scenario: Scenario, draft: SceneDraft) -> Sequence[Issue]:
        try:
            scene = _staged(scenario, draft)
        except ValidationError as error:
            return issues_of(error)
        return self.check(scene, self.catalogue)


def _staged(scenario: Scenario, draft: SceneDraft) -> Scene:
    return Scene(
        id=scenario.id,
        scenario_id=scenario.id,
        map=draft.map,
        ego=draft.ego,
        weather=draft.weather,
        actors=tuple(draft.actors),
        hazard=draft.hazard,
        decision=draft.decision,
        horizon_s=draft.horizon_s,
    )
