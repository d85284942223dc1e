"""Faithfulness of scenes to texts, for scenes and texts of any author."""

from oodscen.claims._checking import check_claims
from oodscen.claims._findings import ClaimFinding
from oodscen.claims._matching import likeness_of
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._scene import Scene
from oodscen.llm._ask import ATTEMPTS, ask
from oodscen.prompts._scenario.extract_claims import ExtractClaims
from oodscen.protocols import LLM, Encoder


class Faithfulness(Data):
    """The comparison of a scene with its text."""

    id: str
    """Id of the scene."""
    findings: tuple[ClaimFinding, ...]
    """One finding per claim of the text, in its order."""

    @property
    def mismatches(self) -> tuple[ClaimFinding, ...]:
        """Findings on the claims that the scene contradicts."""
        return tuple(finding for finding in self.findings if finding.status == "fails")

    @property
    def is_faithful(self) -> bool:
        """True if the scene contradicts no claim of the text."""
        return not self.mismatches


def extract_claims(llm: LLM, text: str, *, attempts: int = ATTEMPTS) -> tuple[Claim, ...]:
    """Read the claims of a text from its words alone.

    Args:
        llm: The model that reads the text.
        text: The text of a scenario.
        attempts: Largest number of calls.

    Raises:
        AnswerError: If the model gives no valid answer; the error lists the faults.
        LLMError: If the model cannot be reached.
    """
    return tuple(ask(llm, ExtractClaims(text=text), attempts=attempts).claims)


def compare_text(
    llm: LLM,
    text: str,
    scene: Scene,
    catalogue: Catalogue,
    *,
    encoder: Encoder | None,
) -> Faithfulness:
    """Compare a scene of any author with a text.

    Args:
        llm: The model that reads the text; it does not see the scene.
        text: The text that the scene should show.
        scene: A scene without faults by `Scene.check`.
        catalogue: The catalogue of the scene's simulator.
        encoder: Compares the things of the text with the actors that the scene says stand for them; without one, a
            noun that no asset is known by may be any of them.

    Raises:
        AnswerError: If the claims cannot be read; the error lists the faults.
        LLMError: If the model cannot be reached.
    """
    claims = extract_claims(llm, text)
    likeness = likeness_of(encoder, catalogue)
    findings = check_claims(claims, scene, catalogue, likeness=likeness)
    return Faithfulness(id=scene.id, findings=tuple(findings))
