"""Verdicts: answers about one drive, compared with the truth about it."""

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

from oodscen.data._episode import Episode
from oodscen.data._scene import Visible
from oodscen.data._verdict import NOTHING, Outcome, Protocol, Verdict, verdict_id
from oodscen.errors import (
    AnswerError,
    ContentFiltered,
    LLMTimeout,
    ModelSkipped,
    OodscenError,
)
from oodscen.judging._aspects.matching import naming
from oodscen.judging._aspects.opinions import is_open, opinion, rescored
from oodscen.judging._parsing import is_refusal
from oodscen.judging._references import AspectOption, is_reference
from oodscen.protocols import LLM


class Truth(NamedTuple):
    """The ground truth of the first task."""

    path: tuple[str, ...]
    """Labels from the root to the leaf."""
    leaf: str
    visible: tuple[Visible, ...] = ()
    """Everything that can be seen of the hazard."""


def scored(
    episode: Episode,
    model: LLM,
    truth: Truth,
    options: Sequence[AspectOption],
    fields: dict[str, Any],
    protocol: Protocol,
    failures: Sequence[OodscenError],
    judge: LLM | None,
    is_closed_asked: bool = False,
) -> Verdict:
    """Compare the answers with the ground truth."""
    is_ood, action, choice = fields.get("is_ood"), fields.get("action"), fields.get("choice")
    if is_ood is not None and not episode.is_ordinary:
        named = naming(fields["aspect"] if is_ood else "", truth.path, truth.visible)
        fields |= {"thing_is_right": named.thing, "aspect_is_right": named.right}
    if choice is not None or is_closed_asked:
        right = NOTHING if episode.is_ordinary else truth.leaf
        right = next((one.id for one in options if one.holds(right)), right)
        fields["choice_is_right"] = choice == right
    outcome = episode.actions.get(action) if action else None
    if outcome is not None:
        touched = bool(outcome.contacts)
        fields["success"] = not outcome.unavailable and not touched and episode.is_deterministic
        is_marginal = outcome.marginal and protocol != "paper"
        fields["action_is_marginal"] = is_marginal
        is_safe = fields["success"] if protocol == "paper" else outcome.safe
        fields["action_is_safe"] = None if is_marginal else is_safe
    error = failures[0] if failures else None
    ended: Outcome = _outcome(error)
    if error is None and outcome is not None and outcome.unavailable:
        ended = "unavailable"
    verdict = Verdict(
        id=verdict_id(episode.scene_id, model.name, protocol),
        scene_id=episode.scene_id,
        model=model.name,
        kind=kind_of_answerer(model),
        status="failed" if error else "ok",
        outcome=ended,
        error=str(error)[:2_000] if error else None,
        error_type=type(error).__name__ if error else "",
        retryable=any(getattr(one, "retryable", False) for one in failures),
        protocol=protocol,
        is_twin=episode.is_ordinary,
        **fields,
    )
    if judge is None or not is_open(verdict):
        return verdict
    found = opinion(judge, verdict.aspect, truth.path, truth.visible)
    return rescored(verdict, truth.path, {found.id: found}, found.judge, truth.visible)


def _outcome(error: OodscenError | None) -> Outcome:
    if error is None:
        return "answered"
    if isinstance(error, AnswerError):
        return "refused" if is_refusal(error.raw) else "unparsed"
    if isinstance(error, ContentFiltered):
        return "refused"
    if isinstance(error, ModelSkipped):
        return "unasked"
    words = str(error).casefold()
    is_late = isinstance(error, LLMTimeout) or any(
        word in words for word in ("timeout", "timed out", "time is up", "in time", "deadline")
    )
    return "timeout" if is_late else "error"


def kind_of_answerer(model: LLM) -> Literal["model", "reference"]:
    return "reference" if is_reference(model) else "model"
