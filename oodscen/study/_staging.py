"""A scene as it was staged, and what running it came to: a line of `staged.jsonl`."""

from typing import Any, ClassVar

from oodscen.data._base import Data
from oodscen.data._scene import Scene


class Staging(Data):
    """One scene, from the augmenter or from whoever changed it by hand, to what was run in the end."""

    noun: ClassVar[str] = "staging"

    id: str
    made_from: str = ""
    """SHA-256 of the text and its claims."""
    scene: Scene
    """As it was staged."""
    how: str | None = None
    """How it was re-staged, empty where it was not; `None` until it has been run."""
    run: Scene | None = None
    """What was run instead, where it was re-staged."""
    tried: tuple[dict[str, str], ...] = ()
    """What was tried in vain, and why: `how`, `why`."""

    @property
    def ran(self) -> Scene:
        """The scene that was run, or will be."""
        return self.run or self.scene

    def after(self, how: str, run: Scene | None, tried: tuple[dict[str, str], ...]) -> "Staging":
        """Return the same with the outcome of running the scene, by the fields of those names."""
        return Staging(
            id=self.id,
            made_from=self.made_from,
            scene=self.scene,
            how=how,
            run=run,
            tried=tried,
        )

    def restaging(self) -> dict[str, Any] | None:
        """Return the line of `restaged.jsonl`; `None` where the scene tells actions apart as it is."""
        if not self.how and not self.tried:
            return None
        line = {"id": self.id, "how": self.how, "tried": list(self.tried)}
        return {**line, "scene": self.run.model_dump(mode="json")} if self.run else line
