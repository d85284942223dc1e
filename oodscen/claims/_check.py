"""Whether a scene is faithful to a text, whoever wrote either."""

from typing import ClassVar

from oodscen.claims._checking import Finding, judge_claims
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._scene import Scene
from oodscen.driving._trace import Trace
from oodscen.llm._ask import ATTEMPTS, ask
from oodscen.prompts._scenario.extract_claims import ExtractClaims
from oodscen.protocols import LLM


class Faithfulness(Data):
    """How a scene compares with its text."""

    noun: ClassVar[str] = "faithfulness"

    id: str
    """Of the scene."""
    findings: tuple[Finding, ...]
    """One per claim of the text, in its order."""

    @property
    def mismatches(self) -> tuple[Finding, ...]:
        """Return what the scene contradicts."""
        return tuple(one for one in self.findings if one.status == "fails")

    @property
    def is_faithful(self) -> bool:
        """Whether the scene contradicts nothing of the text."""
        return not self.mismatches


class Unjudged(Data):
    """A line of a file that could not be compared with a text."""

    noun: ClassVar[str] = "unjudged scene"

    id: str
    """Of the scene, or file and number of the line where it holds none."""
    faults: tuple[str, ...]
    """What stands in the way."""


def extract_claims(llm: LLM, text: str, *, attempts: int = ATTEMPTS) -> tuple[Claim, ...]:
    """Read the claims of a text from its words alone.

    Args:
        llm: Who reads it.
        text: Of a scenario.
        attempts: Largest number of calls.

    Raises:
        AnswerError: When no valid answer comes; it lists the faults.
        LLMError: When the model cannot be reached.
    """
    return tuple(ask(llm, ExtractClaims(text=text), attempts=attempts).claims)


def check_faithful(
    llm: LLM, text: str, scene: Scene, catalogue: Catalogue, trace: Trace | None = None
) -> Faithfulness:
    """Compare a scene that anybody wrote with a text.

    Args:
        llm: Reads the text; it does not see the scene.
        text: What the scene shall show.
        scene: One that `oodscen.driving.check_scene` accepts.
        catalogue: Of the simulator that it is for.
        trace: What happens in it; watched if left out.

    Raises:
        AnswerError: When the claims cannot be read; it lists the faults.
        LLMError: When the model cannot be reached.
    """
    claims = extract_claims(llm, text)
    return Faithfulness(id=scene.id, findings=tuple(judge_claims(claims, scene, catalogue, trace)))
