"""One scene as it was staged, with the outcome of running it: a line of `staged.jsonl`."""

from collections.abc import Sequence
from typing import Any, ClassVar

from oodscen.data._base import Data, digest
from oodscen.data._claim import Claim
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene


def text_digest(text: Scenario, claims: Sequence[Claim] | None, made: Sequence[str] = ()) -> str:
    """Return the digest of what a scene is staged from.

    Args:
        text: The text of the scene.
        claims: Those of the text, or `None` if they could not be read.
        made: Digests of the designs that were made for its path.
    """
    dumped = None if claims is None else [claim.model_dump(mode="json") for claim in claims]
    content: list[object] = [text.text, text.path, dumped]
    if made:
        content.append(list(made))
    return digest(content)


class Staging(Data):
    """One scene as staged by the augmenter or edited by hand, and the scene that was finally run."""

    noun: ClassVar[str] = "staging"

    id: str
    made_from: str = ""
    """SHA-256 digest of the text, its claims and the designs made for it; see `text_digest`."""
    scene: Scene
    """The scene as it was staged."""
    how: str | None = None
    """The re-staging that was applied, empty if none; `None` until the scene has been run."""
    run: Scene | None = None
    """The scene that was run instead, if it was re-staged."""
    tried: tuple[dict[str, str], ...] = ()
    """Failed attempts to re-stage the scene, each with `how` and `why`."""
    demand: Scene | None = None
    """The scene's ordinary demand; `None` until it has been run, or if none fits."""

    @property
    def ran(self) -> Scene:
        """The scene that was run, or will be run."""
        return self.run or self.scene

    def after(self, how: str, run: Scene | None, tried: tuple[dict[str, str], ...]) -> "Staging":
        """Return a copy with the outcome of running the scene, and without a demand; see the fields of these names."""
        outcome = {"how": how, "run": run, "tried": tried, "demand": None}
        return self.model_copy(update=outcome)

    def demanding(self, demand: Scene | None) -> "Staging":
        """Return a copy with the scene's ordinary demand."""
        return self.model_copy(update={"demand": demand})

    def restaging(self) -> dict[str, Any] | None:
        """Return the line of `restaged.jsonl`, or `None` if the scene needed no re-staging."""
        if not self.how and not self.tried:
            return None
        line = {"id": self.id, "how": self.how, "tried": list(self.tried)}
        return {**line, "scene": self.run.model_dump(mode="json")} if self.run else line
