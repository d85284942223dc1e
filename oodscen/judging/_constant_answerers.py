"""Answerers that ignore the pictures: the constant and random baselines shown beside real models.

They answer only the questions of the evaluation (describe a frame, name the aspect, choose an
action) and never look at a picture. Tables list them under their `kind`, "reference".
"""

import json
from typing import Any, ClassVar, Literal

from oodscen._display import Brief
from oodscen._seeding import stream
from oodscen.data._episode import ACTIONS
from oodscen.data._verdict import NOTHING
from oodscen.errors import LLMError, UnknownComponent
from oodscen.judging._questions import NOTHING_UNUSUAL
from oodscen.judging._references import Answers, Case
from oodscen.prompts._judging.choose_action import ChooseAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._judging.name_aspect import NameAspect
from oodscen.prompts._judging.name_ood_aspect import NameOodAspect
from oodscen.protocols import Completion, Request

ASPECT = "A pedestrian crossing where none is expected"
"""The aspect named whenever one of them calls a scene OOD: right by luck for that kind of scene."""
_DESCRIPTION = "A road ahead of the ego vehicle."
"""The description of every frame."""

_Question = NameAspect | NameOodAspect | ChooseAspect | ChooseAction


class _Sightless(Brief):
    """An answerer of the questions of the evaluation that never looks at a picture."""

    kind: ClassVar[Literal["reference"]] = "reference"
    name: str

    def complete(self, request: Request) -> Completion:
        """Answer without looking.

        Raises:
            LLMError: If the question is not part of the evaluation.
        """
        prompt = request.prompt
        if isinstance(prompt, DescribeFrame):
            answer: dict[str, Any] = {"description": _DESCRIPTION}
        elif isinstance(prompt, _Question):
            answer = self._answer(prompt, request.sample)
        else:
            raise LLMError(
                f"{self.name} is a reference answerer for evaluation; it cannot answer {prompt.purpose!r}",
                model=self.name,
            )
        return Completion(text=json.dumps(answer))

    def _answer(self, prompt: _Question, sample: int) -> dict[str, Any]:
        raise NotImplementedError


class ConstantAnswerer(_Sightless):
    """Always calls the scene OOD, names the same aspect and chooses the same action.

    Of the listed kinds it chooses the alphabetically first, which does not depend on the order of the list.

    Args:
        action: One of `oodscen.data._episode.ACTIONS`.
        seed: Ignored; accepted because every registered model takes one.

    Raises:
        UnknownComponent: If there is no such action.
    """

    _repr_fields = ("action",)

    def __init__(self, action: str = "stop", *, seed: int = 0) -> None:
        if action not in ACTIONS:
            raise UnknownComponent("action", action, ACTIONS)
        self.name = f"constant:{action}"
        self.action = action

    def judge(self, case: Case) -> Answers:
        """Answer both tasks about one case without looking."""
        listed = (option.id for option in case.options if option.id != NOTHING)
        return Answers(
            is_ood=True, aspect=ASPECT, choice=min(listed, default=None), action=self.action
        )

    def _answer(self, prompt: _Question, sample: int) -> dict[str, Any]:
        if isinstance(prompt, ChooseAspect):
            nothing = NOTHING_UNUSUAL.label
            listed = (label for label in prompt.labels if label != nothing)
            return {"choice": prompt.labels.index(min(listed, default=nothing)) + 1}
        if isinstance(prompt, NameAspect):
            return {"is_ood": True, "aspect": ASPECT}
        if isinstance(prompt, NameOodAspect):
            return {"aspect": ASPECT}
        return {"action": self.action}


class RandomAnswerer(_Sightless):
    """Flips a coin for OOD and draws one of the offered actions with equal probability.

    The draw depends on the seed, the question, the names of its frames and the sample only, so it is the same
    in every process and independent of earlier questions.
    """

    _repr_fields = ("seed",)

    def __init__(self, *, seed: int = 0) -> None:
        self.name = "random"
        self.seed = seed

    def judge(self, case: Case) -> Answers:
        """Answer both tasks about one case at random."""
        draw = stream(self.seed, "reference", case.episode.scene_id)
        is_ood = bool(draw.integers(2))
        action = ACTIONS[int(draw.integers(len(ACTIONS)))]
        names = [option.id for option in case.options]
        choice = names[int(draw.integers(len(names)))] if names else None
        return Answers(is_ood=is_ood, aspect=ASPECT if is_ood else "", choice=choice, action=action)

    def _answer(self, prompt: _Question, sample: int) -> dict[str, Any]:
        frames = (image.name for image in prompt.frames)
        draw = stream(self.seed, prompt.purpose, *frames, sample)
        if isinstance(prompt, NameAspect):
            is_ood = bool(draw.integers(2))
            return {"is_ood": is_ood, "aspect": ASPECT if is_ood else ""}
        if isinstance(prompt, NameOodAspect):
            return {"aspect": ASPECT if draw.integers(2) else "none"}
        if isinstance(prompt, ChooseAspect):
            return {"choice": 1 + int(draw.integers(len(prompt.labels)))}
        return {"action": prompt.options[int(draw.integers(len(prompt.options)))].id}
