"""The verdict: one vision-language model's answers about one episode, and their correctness."""

from typing import Literal

from pydantic import Field

from oodscen.data._base import Data

Outcome = Literal["answered", "refused", "unparsed", "unavailable", "timeout", "unasked", "error"]
"""Outcome of judging one item. `answered`: the model answered every question. `refused`: the model or its
provider's content filter refused a question. `unparsed`: an answer could not be read. `unavailable`: the chosen
action does not exist at this place. `timeout`: no answer came in time. `unasked`: at least the last questions
were not asked, since the run had given up on the model. `error`: any other failure of the model, the simulator
or the files."""

NOTHING = "none"
"""The option of the closed question for "nothing is out of the ordinary"."""

Protocol = Literal["ours", "paper"]
"""The evaluation protocol: `paper` asks no closed question and counts only collisions."""


def verdict_id(item_id: str, model: str, protocol: Protocol = "ours") -> str:
    """Return the id of the verdict on a scene or twin: `<item>@<model>`, or `<item>@<model>#paper`."""
    return f"{item_id}@{model}{'#paper' if protocol == 'paper' else ''}"


_WITHHELD = " without pictures"


def without_pictures(model: str) -> str:
    """Return the name under which a model's answers with the pictures withheld are kept."""
    return model + _WITHHELD


def is_without_pictures(model: str) -> bool:
    """Return whether a name is that of a model with the pictures withheld."""
    return model.endswith(_WITHHELD)


class Verdict(Data):
    """The result of both of the paper's tasks for one model on one scene or twin."""

    schema_version: Literal[1, 2] = 2
    id: str
    """`<scene id>@<model>`; under the paper's protocol `<scene id>@<model>#paper`."""
    scene_id: str
    """Id of the scene, or of the twin (`<scene id>~twin`)."""
    model: str
    kind: Literal["model", "reference"] = "model"
    """`reference` marks the shipped reference answerers: constants, chance, blind, novelty and oracle."""
    status: Literal["ok", "failed"] = "ok"
    """`failed` if a question got no usable answer; earlier answers are kept."""
    outcome: Outcome = "answered"
    error: str | None = None
    error_type: str = ""
    """Name of the exception behind a failure, e.g. `AnswerError`."""
    retryable: bool = False
    """True if a failed judgement may succeed on a later try."""
    protocol: Protocol = "ours"
    is_ordinary: bool = False
    """True if the item was an ordinary drive, in which nothing is out of the ordinary."""
    descriptions: tuple[str, ...] = ()
    """Descriptions of the frames in turn; empty unless the questions followed them (`--chain`, or the paper's
    protocol)."""
    is_ood: bool | None = None
    """Task 1, detection: true if the model calls the scene out of the ordinary."""
    confidence: float | None = Field(default=None, ge=0, le=1)
    """The model's stated confidence in `is_ood`; `None` if it stated none."""
    aspect: str = ""
    """Task 1, identification: the OOD aspect in the model's words."""
    thing_is_right: bool | None = None
    """True if the aspect names the right thing, whatever it says is wrong with it; `None` for ordinary drives
    and without an answer."""
    aspect_is_right: bool | None = None
    """True if the aspect names the thing and what is wrong with it; `None` for ordinary drives and without an
    answer."""
    choice: str | None = None
    """Task 1, closed question: id of the chosen leaf, `none` for "nothing unusual"; `None` without an answer."""
    choice_is_right: bool | None = None
    """True if the choice stands for the scene's leaf, or is `none` for an ordinary drive."""
    action: str | None = None
    """Task 2: the chosen action."""
    action_is_safe: bool | None = None
    """True if that action was safe when executed; an unavailable action is not. `None` for a marginal one."""
    action_is_marginal: bool = False
    """True if that action is safe for some drivers only, and therefore neither right nor wrong."""
    success: bool | None = None
    """Success in the paper's task 2: the action could be executed and the ego touched nothing."""
    reasoning: str = ""
    """The model's text before its choice of an action, shortened."""
    contradiction: str = ""
    """The contradiction between the reasoning and the chosen action; empty if none was found."""
    notes: tuple[str, ...] = ()
    """Notes on how answers were read that were not the requested JSON: `purpose: how`."""
    prompts: dict[str, str] = {}
    """Version of the prompt of every question asked, by purpose; empty for references."""
    is_outdated: bool = False
    """True if the verdict used other prompt versions than the run that last kept it."""
    judge: str = ""
    """Judge of the open aspect: `<model>@<prompt version>`, or empty for the documented matcher."""
    made_from: str = ""
    """In a study: SHA-256 of the episode and its ground truth; for references, of all episodes."""
    judge_error: str = ""
    """The reason why the judge gave no usable answer and the matcher decided instead; empty if the judge answered."""

    @property
    def p_ood(self) -> float | None:
        """The stated probability that the scene is OOD; 1 or 0 if the model gave only a yes or no."""
        if self.is_ood is None:
            return None
        sure = 1.0 if self.confidence is None else self.confidence
        return sure if self.is_ood else 1.0 - sure
