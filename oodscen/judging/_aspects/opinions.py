"""Scores open aspects with a judge model, asked once per distinct answer and path."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from oodscen._words.redaction import redact
from oodscen.data._base import Data, digest
from oodscen.data._scene import Visible
from oodscen.data._verdict import Verdict
from oodscen.errors import LLMError
from oodscen.judging._aspects.matching import is_same_wording, score_naming
from oodscen.llm._ask import ask
from oodscen.prompts._judging.judge_aspect import JudgeAspect
from oodscen.protocols import LLM

_LONGEST_ERROR = 2_000
_LONGEST_REASONING = 600
"""Maximum lengths of stored texts, in characters."""


class Opinion(Data):
    """A judge's opinion on whether one aspect names what one path is about."""

    id: str
    """Identifies the judge, aspect and path; see `opinion_id`."""
    judge: str
    """The judge, as `<model>@<prompt version>`."""
    aspect: str
    path: tuple[str, ...]
    """Labels from the root to the leaf."""
    status: Literal["ok", "failed"] = "ok"
    is_thing: bool | None = None
    """True if the aspect names the right thing; `None` if the judge gave no usable answer."""
    is_same: bool | None = None
    """True if the aspect names the thing and what is wrong with it; `None` if the judge gave no usable answer."""
    reasoning: str = ""
    error: str | None = None
    error_type: str = ""
    retryable: bool = False


def judge_label(judge: LLM) -> str:
    """Return the judge's label in verdicts: its name and the version of its question."""
    return f"{judge.name}@{JudgeAspect.version()}"


def is_open(verdict: Verdict) -> bool:
    """Return whether a verdict holds an aspect that must be compared with the path's label."""
    return not verdict.is_ordinary and verdict.is_ood is True and bool(verdict.aspect.strip())


def opinion_id(
    label: str, aspect: str, path: Sequence[str], visible: Sequence[Visible] = ()
) -> str:
    """Return the id of a judge's opinion; equal answers about equal truths share one."""
    content: list[Any] = [label, aspect, list(path)]
    if visible:
        content.append([thing.model_dump() for thing in visible])
    return digest(content)[:20]


def ask_opinion(
    judge: LLM, aspect: str, path: Sequence[str], visible: Sequence[Visible] = ()
) -> Opinion:
    """Ask a judge whether an aspect names what a path is about.

    An aspect that repeats the leaf's label word for word names it, so the judge is not asked. If the judge gives
    no usable answer, the opinion is marked as failed and no exception is raised.
    """
    label = judge_label(judge)
    blank = Opinion(
        id=opinion_id(label, aspect, path, visible), judge=label, aspect=aspect, path=tuple(path)
    )
    if path and is_same_wording(aspect, path[-1]):
        return blank.model_copy(update={"is_thing": True, "is_same": True})
    question = JudgeAspect(aspect=aspect, path=blank.path[1:] or blank.path, visible=tuple(visible))
    try:
        answer = ask(judge, question)
    except LLMError as error:
        failure = {
            "status": "failed",
            "error": redact(str(error))[:_LONGEST_ERROR],
            "error_type": type(error).__name__,
            "retryable": bool(getattr(error, "retryable", False)),
        }
        return blank.model_copy(update=failure)
    fields = {
        "is_thing": answer.is_same_thing,
        "is_same": answer.is_same_thing and answer.is_same_fault,
        "reasoning": answer.reasoning[:_LONGEST_REASONING],
    }
    return blank.model_copy(update=fields)


def rescore_verdict(
    verdict: Verdict,
    path: Sequence[str],
    opinions: Mapping[str, Opinion],
    label: str,
    visible: Sequence[Visible] = (),
) -> Verdict:
    """Return a verdict with its open aspect scored by a judge, or by the matcher without one.

    Args:
        verdict: The verdict of a model or a reference, on a scene or a twin.
        path: Labels from the root to the leaf of its scene.
        opinions: The judge's opinions, by id.
        label: The judge's label; empty for the matcher alone.
        visible: Everything that can be seen of the hazard.
    """
    if not is_open(verdict):
        return verdict
    judged = opinions.get(opinion_id(label, verdict.aspect, path, visible)) if label else None
    if judged is not None and judged.is_same is not None:
        scores = _scores(judged.is_thing, judged.is_same, judge=label)
    else:
        by_rule = score_naming(verdict.aspect, path, visible)
        scores = _scores(by_rule.thing, by_rule.right, error=_why_unjudged(label, judged))
    if all(getattr(verdict, name) == value for name, value in scores.items()):
        return verdict
    return verdict.model_copy(update=scores)


def _scores(
    is_thing: bool | None, is_right: bool, *, judge: str = "", error: str = ""
) -> dict[str, object]:
    """Return the fields of a verdict about its open aspect."""
    return {
        "thing_is_right": is_thing,
        "aspect_is_right": is_right,
        "judge": judge,
        "judge_error": error,
    }


def _why_unjudged(label: str, judged: Opinion | None) -> str:
    """Return why a judge did not score an aspect; empty if no judge is to score it."""
    if not label:
        return ""
    return (judged.error if judged else None) or "it was not asked"
