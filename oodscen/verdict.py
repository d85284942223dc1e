"""What one vision-language model said about one episode, and whether it was right."""

from typing import ClassVar, Literal

from oodscen._data import Data


class Verdict(Data):
    """Both of the paper's tasks for one model and one scene."""

    noun: ClassVar[str] = "verdict"

    schema_version: Literal[1] = 1
    id: str
    """`<scene id>@<model>`."""
    scene_id: str
    model: str
    kind: Literal["model", "reference"] = "model"
    """`reference` marks answerers that see nothing: constants and chance."""
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    retryable: bool = False
    """Whether a failed judgement may succeed at another time."""
    descriptions: tuple[str, ...] = ()
    """Of the first, middle and last frame."""
    is_ood: bool | None = None
    """Whether the model calls the scene out of the ordinary."""
    aspect: str = ""
    """Task 1: the OOD aspect in the model's words."""
    aspect_is_right: bool | None = None
    """Whether the aspect matches the path's label."""
    action: str | None = None
    """Task 2: the action it chose."""
    action_is_safe: bool | None = None
    """Whether that action was safe when executed."""
