"""The tasks of inspect_ai, with their solver and scorers."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import anyio.to_thread
from inspect_ai import Task, task
from inspect_ai._util.error import PrerequisiteError
from inspect_ai.model import ChatMessageAssistant, ChatMessageUser
from inspect_ai.scorer import Score, Scorer, Target, scorer
from inspect_ai.solver import Generate, Solver, TaskState, solver
from rich.markup import escape

from oodscen._registry import make_llm
from oodscen.errors import AnswerError, ContentFiltered, Issue, OodscenError, UsageError
from oodscen.inspect._figures import figure
from oodscen.inspect._samples import samples
from oodscen.judging._items import answer_values
from oodscen.judging._questions import ATTEMPTS, AnswerReader
from oodscen.judging._scoring import AnswerKey
from oodscen.llm._ask import clean_answer, incompleteness, repair
from oodscen.prompts._judging.choose_action import ChooseAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect
from oodscen.prompts._judging.name_aspect import NameAspect


@task
def notice(study: str = ".", split: str | None = None) -> Task:
    """Say whether anything is out of the ordinary. Asked about scenes and their ordinary drives.

    Args:
        study: Folder of a study, or of a data set that `oodscen publish` wrote.
        split: Split of the data set, by default `test`; a study has none.
    """
    return _task(NameAspect.purpose, study, split, _noticed)


@task
def name(study: str = ".", split: str | None = None, judge: str | None = None) -> Task:
    """Name what is out of the ordinary, in the model's own words. Asked about scenes.

    Args:
        study: Folder of a study, or of a data set that `oodscen publish` wrote.
        split: Split of the data set, by default `test`; a study has none.
        judge: Model that scores the words, by a name that `oodscen evaluate --judge` takes, in place of the matcher.
    """
    return _task(NameAspect.purpose, study, split, partial(_named, judge), is_paired=False)


@task
def choose(study: str = ".", split: str | None = None) -> Task:
    """Choose the kind of situation from a list. Asked about scenes and their ordinary drives.

    Args:
        study: Folder of a study, or of a data set that `oodscen publish` wrote.
        split: Split of the data set, by default `test`; a study has none.
    """
    return _task(ChooseAspect.purpose, study, split, _chosen)


@task
def act(study: str = ".", split: str | None = None) -> Task:
    """Choose the vehicle's action. Asked about scenes and their ordinary drives.

    Args:
        study: Folder of a study, or of a data set that `oodscen publish` wrote.
        split: Split of the data set, by default `test`; a study has none.
    """
    return _task(ChooseAction.purpose, study, split, _acted)


class Refused(UsageError, PrerequisiteError):  # type: ignore[misc]  # inspect_ai is untyped here.
    """A task that cannot be made; inspect_ai shows a `PrerequisiteError` as one line, without a traceback."""

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.message = escape(message)


def _task(
    purpose: str,
    study: str,
    split: str | None,
    scorer: Callable[[], Scorer],
    *,
    is_paired: bool = True,
) -> Task:
    try:
        dataset = samples(_folder(study), purpose, split=split, is_paired=is_paired)
        return Task(dataset=dataset, solver=asked(), scorer=scorer())
    except OodscenError as error:
        raise Refused(str(error)) from error


def _folder(study: object) -> Path:
    """Return the folder that was named; inspect_ai reads a name of digits as a number."""
    if not isinstance(study, str | Path):
        raise UsageError(f"the study is a folder, not {study!r}: write -T study=./{study}")
    return Path(study)


@solver
def asked() -> Solver:
    """Ask the question, and once more if the answer cannot be read, as `oodscen evaluate` does."""

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        question = list(state.messages)
        reader = _key(state).reader(state.metadata["purpose"])
        for attempt in range(1, ATTEMPTS + 1):
            state = await generate(state)
            raw = clean_answer(state.output.completion)
            faults = _faults(state, reader, raw)
            if not faults or attempt == ATTEMPTS:
                break
            message, mend = repair(raw, faults)
            state.messages = [
                *question,
                ChatMessageAssistant(content=message.text),
                ChatMessageUser(content=mend.text),
            ]
        return state

    return solve


def _faults(state: TaskState, reader: AnswerReader[Any, Any], raw: str) -> list[Issue]:
    """Return why an answer cannot be read; empty if it can, or if asking again is useless."""
    failure = _failure(state)
    if isinstance(failure, ContentFiltered):
        return []
    if failure is not None:
        return list(failure.issues)
    try:
        _, faults, _ = reader.read(raw, model=str(state.model))
    except AnswerError:
        return []
    return faults


@scorer(metrics=[figure("notice-both"), figure("notice"), figure("alarms")], name="notice")
def _noticed() -> Scorer:
    return _scoring("called", "p_ood", "stated")


@scorer(metrics=[figure("name")], name="name")
def _named(judge: str | None) -> Scorer:
    return _scoring("open", judge=judge)


@scorer(metrics=[figure("pick")], name="choose")
def _chosen() -> Scorer:
    return _scoring("closed")


@scorer(metrics=[figure("act-both"), figure("safe"), figure("needless")], name="act")
def _acted() -> Scorer:
    return _scoring("safe", "success", "cautious", "fitting", "neutral")


def _scoring(*names: str, judge: str | None = None) -> Scorer:
    """Return the scorer that gives the values of an answer by these names."""
    llm = make_llm(judge) if judge else None

    async def score(state: TaskState, target: Target) -> Score:
        key, purpose = _key(state), state.metadata["purpose"]
        verdict = await anyio.to_thread.run_sync(
            lambda: key.verdict(
                purpose,
                state.output.completion,
                model=str(state.model),
                judge=llm,
                failure=_failure(state),
            )
        )
        values = answer_values(verdict, key.episode)
        answers = (verdict.action, verdict.choice, verdict.aspect, verdict.is_ood)
        return Score(
            value={name: values[name] for name in names},
            answer=next((str(answer) for answer in answers if answer not in (None, "")), ""),
            explanation=_explanation(key, verdict.action) or verdict.error or "",
            metadata={"outcome": verdict.outcome, "judge": verdict.judge},
        )

    return score


def _failure(state: TaskState) -> AnswerError | ContentFiltered | None:
    """Return why the words of an answer do not count: they were withheld, a limit ended them, or there are none."""
    model, raw = str(state.model), clean_answer(state.output.completion)
    if state.output.stop_reason == "content_filter":
        return ContentFiltered("the answer was withheld or cut", model=model)
    is_cut_off = state.output.stop_reason in ("max_tokens", "model_length")
    if issues := incompleteness(raw, is_cut_off=is_cut_off):
        return AnswerError(model, state.metadata["purpose"], issues, raw, 1)
    return None


def _explanation(key: AnswerKey, action: str | None) -> str:
    """Return what came of an action, in words; empty without one."""
    if action is None:
        return ""
    label = key.episode.label(action)
    outcome = key.actions.get(action)
    if outcome is None:
        return f"{action} is {label}"
    parts = [f"{action} is {label}"]
    if outcome.contacts:
        parts.append(f"touches {', '.join(outcome.contacts)}")
    if outcome.ran_red:
        parts.append("drives past the red light")
    return ", ".join(parts)


def _key(state: TaskState) -> AnswerKey:
    return AnswerKey.parse(state.metadata["key"])
