"""What one vision-language model said about one episode, and whether it was right."""

from typing import ClassVar, Literal

from pydantic import Field

from oodscen.data._base import Data

Outcome = Literal["answered", "refused", "unparsed", "unavailable", "timeout", "unasked", "error"]
"""How judging one item ended: `answered` every question; `refused` to answer one, or its provider's
content filter did; one answer was `unparsed`; chose an action that is `unavailable` at this place; no answer
in time (`timeout`); `unasked`, at least to the end, since the model was given up; any other failure of
the model, the simulator or the files (`error`)."""

NOTHING = "none"
"""The choice of the closed question that says that nothing is out of the ordinary."""

Protocol = Literal["ours", "paper"]
"""How a model is judged: `paper` asks no closed question, and counts collisions only."""


def verdict_id(item_id: str, model: str, protocol: Protocol = "ours") -> str:
    """Return the id of the verdict on one scene or twin: `<item>@<model>`, or `<item>@<model>#paper`."""
    return f"{item_id}@{model}{'#paper' if protocol == 'paper' else ''}"


class Verdict(Data):
    """Both of the paper's tasks for one model and one scene, or one twin."""

    noun: ClassVar[str] = "verdict"

    schema_version: Literal[1, 2] = 2
    id: str
    """`<scene id>@<model>`; under the paper's protocol `<scene id>@<model>#paper`."""
    scene_id: str
    """Of the scene, or of the twin (`<scene id>~twin`)."""
    model: str
    kind: Literal["model", "reference"] = "model"
    """`reference` marks the shipped answerers: constants, chance, blind, novelty and oracle."""
    status: Literal["ok", "failed"] = "ok"
    """`failed` where a question stayed without a usable answer; what was answered is kept."""
    outcome: Outcome = "answered"
    error: str | None = None
    error_type: str = ""
    """Name of the exception behind a failure, e.g. `AnswerError`."""
    retryable: bool = False
    """Whether a failed judgement may succeed at another time."""
    protocol: Protocol = "ours"
    is_twin: bool = False
    """Whether the item was an ordinary twin: nothing is out of the ordinary there."""
    descriptions: tuple[str, ...] = ()
    """Of the first, middle and last frame; empty for references, which write none."""
    is_ood: bool | None = None
    """Task 1, detection: whether the model calls the scene out of the ordinary."""
    confidence: float | None = Field(default=None, ge=0, le=1)
    """Stated, in `is_ood`; `None` where none was stated."""
    aspect: str = ""
    """Task 1, identification: the OOD aspect in the model's words."""
    aspect_is_right: bool | None = None
    """Whether the aspect matches the path's label; `None` for twins and without an answer."""
    choice: str | None = None
    """Task 1, closed: the id of the chosen leaf, `none` for "nothing unusual"; `None` without an answer."""
    choice_is_right: bool | None = None
    """Whether it is the scene's leaf; for a twin, whether it is `none`."""
    action: str | None = None
    """Task 2: the action it chose."""
    action_is_safe: bool | None = None
    """Whether that action was safe when executed; an unavailable one is not."""
    success: bool | None = None
    """The paper's success in task 2: the action could be executed, and the ego touched nothing."""
    reasoning: str = ""
    """What the model wrote before its choice of an action, shortened."""
    contradiction: str = ""
    """Where reasoning and answer disagree: what each says; empty where nothing was found."""
    notes: tuple[str, ...] = ()
    """How answers were read where they were not the JSON that was asked for: `purpose: how`."""
    prompts: dict[str, str] = {}
    """Version of every question that was put, by purpose; empty for references."""
    is_outdated: bool = False
    """Whether it was made with other prompt versions than those of the run that last kept it."""
    judge: str = ""
    """Who scored the open aspect: `<model>@<prompt version>`, empty for the documented matcher."""
    made_from: str = ""
    """In a study: SHA-256 of the episode and of what is true of it; for references, of all episodes."""
    judge_error: str = ""
    """Why the judge gave no usable answer about the aspect, so that the matcher decided; empty where it did."""

    @property
    def p_ood(self) -> float | None:
        """The stated probability that the scene is OOD; 1 or 0 where only a yes or no was given."""
        if self.is_ood is None:
            return None
        sure = 1.0 if self.confidence is None else self.confidence
        return sure if self.is_ood else 1.0 - sure
