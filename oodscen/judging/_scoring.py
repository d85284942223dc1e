"""Verdicts: answers about one drive, compared with the truth about it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Self

from oodscen._words.redaction import redact
from oodscen.data._base import Data
from oodscen.data._episode import ActionOutcome, Episode
from oodscen.data._pairing import is_ordinary, scene_of
from oodscen.data._scene import Visible
from oodscen.data._verdict import NOTHING, Outcome, Protocol, Verdict, verdict_id
from oodscen.errors import AnswerError, ContentFiltered, LLMTimeout, ModelSkipped, OodscenError
from oodscen.judging._aspects.matching import score_naming
from oodscen.judging._aspects.opinions import (
    Opinion,
    ask_opinion,
    is_open,
    rescore_verdict,
)
from oodscen.judging._items import Items
from oodscen.judging._parsing import is_refusal
from oodscen.judging._questions import AnswerReader, acting_reader, choosing_reader, naming_reader
from oodscen.judging._references import AspectOption
from oodscen.llm._ask import clean_answer
from oodscen.protocols import LLM

_LONGEST_ERROR = 2_000
"""Maximum length of a stored error, in characters."""


class AnswerKey(Data):
    """Everything that the answers about one drive are scored by."""

    item: str
    """Id of the scene or of its ordinary drive."""
    path: tuple[str, ...] = ()
    """Labels from the root to the leaf of the scene."""
    leaf: str = ""
    visible: tuple[Visible, ...] = ()
    """Everything that can be seen of the hazard."""
    options: tuple[AspectOption, ...] = ()
    """Options of the closed question, as shown."""
    actions: dict[str, ActionOutcome] = {}
    """Outcomes by action."""
    is_deterministic: bool = True

    @classmethod
    def of(
        cls,
        episode: Episode,
        *,
        path: tuple[str, ...],
        leaf: str,
        visible: tuple[Visible, ...],
        options: tuple[AspectOption, ...],
    ) -> Self:
        """Return the key to the answers about an episode."""
        return cls(
            item=episode.scene_id,
            path=path,
            leaf=leaf,
            visible=visible,
            options=options,
            actions=episode.actions,
            is_deterministic=episode.is_deterministic,
        )

    @property
    def episode(self) -> Episode:
        """The episode, as far as answers are scored by it."""
        return Episode(
            id=self.item,
            scene_id=self.item,
            status="ok",
            actions=self.actions,
            is_deterministic=self.is_deterministic,
        )

    def reader(self, purpose: str) -> AnswerReader[Any, Any]:
        """Return the reader of the answers to the question of this purpose."""
        readers = {reader.purpose: reader for reader in (naming_reader(), acting_reader())}
        return readers[purpose] if purpose in readers else choosing_reader(self.options)

    def verdict(
        self,
        purpose: str,
        raw: str,
        *,
        model: str = "",
        judge: LLM | None = None,
        failure: OodscenError | None = None,
    ) -> Verdict:
        """Return the verdict on one answer in a model's words to the question of a purpose, e.g. `name-aspect`.

        A judge decides whether an open aspect is right, instead of the documented matcher. A failure is why the words
        do not count, whatever they say.
        """
        if failure is None:
            answers = self._read(purpose, clean_answer(raw), model)
        else:
            answers = GivenAnswers(model, {}, [failure])
        return score_answers(self, answers, judge)

    def _read(self, purpose: str, raw: str, model: str) -> "GivenAnswers":
        """Return one answer in a model's words as fields of a verdict, or why it has none."""
        reader = self.reader(purpose)
        try:
            answer, issues, _ = reader.read(raw, model=model)
            if answer is None:
                raise AnswerError(model, purpose, issues, raw, 1)
            return GivenAnswers(model, reader.fields(answer))
        except AnswerError as error:
            return GivenAnswers(model, {}, [error])


def items_of(keys: Sequence[AnswerKey]) -> Items:
    """Return the items that some keys are about."""
    return Items.of([key.episode for key in keys], {scene_of(key.item): key for key in keys})


@dataclass(frozen=True)
class GivenAnswers:
    """One answerer's answers about one drive."""

    answerer: str
    """The answerer's name."""
    fields: Mapping[str, Any]
    """The verdict's fields about the answers; a field is missing where no answer could be read."""
    failures: Sequence[OodscenError] = ()
    """Errors of the questions without an answer."""
    protocol: Protocol = "ours"
    kind: Literal["model", "reference"] = "model"


def score_answers(key: AnswerKey, answers: GivenAnswers, judge: LLM | None = None) -> Verdict:
    """Compare answers with the truth about the drive; a judge decides about open aspects instead of the matcher."""
    error = answers.failures[0] if answers.failures else None
    verdict = Verdict(
        id=verdict_id(key.item, answers.answerer, answers.protocol),
        status="failed" if error else "ok",
        outcome=_outcome(error) if error else _answered(key, answers.fields.get("action")),
        error=redact(str(error))[:_LONGEST_ERROR] if error else None,
        error_type=type(error).__name__ if error else "",
        retryable=any(getattr(failure, "retryable", False) for failure in answers.failures),
        **_given(key, answers),
        **_scores(key, answers),
    )
    if judge is None or not is_open(verdict):
        return verdict
    opinion = ask_opinion(judge, verdict.aspect, key.path, key.visible)
    return rescore_verdict(verdict, key.path, {opinion.id: opinion}, opinion.judge, key.visible)


def rescored(verdict: Verdict, key: AnswerKey, answers: GivenAnswers) -> Verdict:
    """Return a stored verdict with everything that follows from its answers computed again.

    The score of an open aspect is left to `rescore_verdict`. A reference's verdict has nothing else to keep.
    """
    if answers.kind == "reference":
        verdict = Verdict(**verdict.model_dump(include=_KEPT_OF_REFERENCES))
    verdict = verdict.model_copy(update=_given(key, answers))
    scores = dict[str, Any]()
    if is_open(verdict):
        answers = replace(answers, fields={**answers.fields, "is_ood": None})
    else:
        scores = {"thing_is_right": None, "aspect_is_right": None}
    if verdict.status == "ok":
        scores["outcome"] = _answered(key, verdict.action)
    return verdict.model_copy(update=scores | _scores(key, answers))


_KEPT_OF_REFERENCES = {
    *("id", "scene_id", "model", "made_from"),
    *("thing_is_right", "aspect_is_right", "judge", "judge_error", "is_outdated"),
}
"""Fields of a reference's stored verdict that do not follow from its answers here."""


def answers_in(verdict: Verdict) -> dict[str, Any]:
    """Return the answers that a stored verdict holds, by its fields."""
    names = ("is_ood", "aspect", "choice", "action")
    values = {name: getattr(verdict, name) for name in names}
    return {name: value for name, value in values.items() if value is not None}


def is_scored(verdict: Verdict, key: AnswerKey, opinions: Mapping[str, Opinion]) -> bool:
    """Return whether a stored verdict is scored as its answers are, by the truth or its judge's opinion.

    `opinions` are those of judges, by id.
    """
    fields = answers_in(verdict)
    if verdict.choice_is_right is False:
        # A person or a reference that chose none of the options is wrong.
        fields.setdefault("choice", None)
    answers = GivenAnswers(verdict.model, fields, protocol=verdict.protocol)
    scored = rescore_verdict(
        rescored(verdict, key, answers), key.path, opinions, verdict.judge, key.visible
    )
    return all(getattr(verdict, name) == getattr(scored, name) for name in _SCORES)


_SCORES = (
    *("thing_is_right", "aspect_is_right", "judge", "choice_is_right"),
    *("action_is_safe", "action_is_marginal", "success", "outcome", "is_ordinary"),
)
"""Fields of a verdict that follow from its answers."""


def _given(key: AnswerKey, answers: GivenAnswers) -> dict[str, Any]:
    """Return the verdict's fields about what was answered, by whom, and about which drive."""
    return {
        "scene_id": key.item,
        "model": answers.answerer,
        "kind": answers.kind,
        "protocol": answers.protocol,
        "is_ordinary": is_ordinary(key.item),
        **answers.fields,
    }


def _scores(key: AnswerKey, answers: GivenAnswers) -> dict[str, Any]:
    """Return the verdict's fields about what is right; those of an open aspect only if it is scored here."""
    fields, is_usual = answers.fields, is_ordinary(key.item)
    is_ood, action = fields.get("is_ood"), fields.get("action")
    scores: dict[str, Any] = {
        "choice_is_right": None,
        "action_is_safe": None,
        "action_is_marginal": False,
        "success": None,
    }
    if is_ood is not None and not is_usual:
        named = score_naming(fields["aspect"] if is_ood else "", key.path, key.visible)
        scores |= {"thing_is_right": named.thing, "aspect_is_right": named.right}
    if "choice" in fields:
        leaf = NOTHING if is_usual else key.leaf
        right = next((option.id for option in key.options if option.holds(leaf)), leaf)
        scores["choice_is_right"] = fields["choice"] == right
    outcome = key.actions.get(action or "")
    if outcome is not None:
        is_paper = answers.protocol == "paper"
        success = not outcome.unavailable and not outcome.contacts and key.is_deterministic
        is_marginal = outcome.marginal and not is_paper
        is_safe = success if is_paper else outcome.safe
        scores |= {
            "success": success,
            "action_is_marginal": is_marginal,
            "action_is_safe": None if is_marginal else is_safe,
        }
    return scores


def _answered(key: AnswerKey, action: str | None) -> Outcome:
    """Return the outcome of judging where every question was answered."""
    outcome = key.actions.get(action or "")
    return "unavailable" if outcome is not None and outcome.unavailable else "answered"


def _outcome(error: OodscenError) -> Outcome:
    """Return the outcome of judging that an error ended."""
    if isinstance(error, AnswerError):
        return "refused" if is_refusal(error.raw) else "unparsed"
    if isinstance(error, ContentFiltered):
        return "refused"
    if isinstance(error, ModelSkipped):
        return "unasked"
    return "timeout" if isinstance(error, LLMTimeout) else "error"
