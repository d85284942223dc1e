"""Asking a language model one typed question for a typed answer."""

from collections.abc import Callable, Sequence
from typing import TypeVar, cast

from pydantic import BaseModel

from oodscen._arguments import checked
from oodscen._io.json import is_object
from oodscen._members import optional
from oodscen._numbers import whole_number
from oodscen._seeding import MAX_SEED
from oodscen._words.redaction import redact_keys
from oodscen._words.text import whole
from oodscen.data._messages import Message
from oodscen.errors import AnswerError, Issue, ReplayMiss
from oodscen.llm._check import complete
from oodscen.llm._reading import CUT_OFF, EMPTY, ONLY, read_answer
from oodscen.prompts._base import Prompt
from oodscen.protocols import LLM, Request

Answer = TypeVar("Answer", bound=BaseModel)

ATTEMPTS = 3
"""Maximum number of attempts, including the first, before an answer counts as invalid."""

SHOWN_ISSUES = 12
"""Maximum number of faults that are fed back at once."""

QUOTED = 8_000
"""Maximum length of an invalid answer that is quoted back to the model, in characters."""

Check = Callable[[Answer], Sequence[Issue]]
Read = Callable[[str], tuple[Answer | None, list[Issue]]]


@checked
def ask(
    llm: LLM,
    prompt: Prompt[Answer],
    sample: int = 0,
    *,
    check: Check[Answer] | None = None,
    attempts: int = ATTEMPTS,
    read: Read[Answer] | None = None,
) -> Answer:
    """Ask a question, parse and validate the answer, and feed faults back until it is valid.

    Args:
        llm: The model to ask.
        prompt: The typed question.
        sample: Index of the draw, for several independent draws.
        check: Further requirements, beyond those of the prompt itself.
        attempts: Maximum number of calls, at least 1.
        read: Parses the text instead of `read_answer` and the checks; it may raise `AnswerError` if asking
            again would be useless.

    Raises:
        AnswerError: When the last answer is still invalid; the error keeps the raw text and the faults.
        UsageError: When `sample` or `attempts` is not a whole number of this range.
        LLMError: When the model cannot be reached, or its implementation raises anything else.
    """
    whole_number("sample", sample, 0, MAX_SEED)
    whole_number("attempts", attempts, 1)
    checks: list[Check[Answer]] = [prompt.check, *([check] if check else [])]
    answer_type = cast(type[Answer], prompt.answer)
    question = messages = prompt.messages()
    schema = prompt.answer_schema()
    issues: list[Issue] = []
    raw, name = "", llm.name
    for attempt in range(1, attempts + 1):
        try:
            completion = complete(llm, Request(prompt, messages, schema, sample, attempt))
        except ReplayMiss as miss:
            refused = [Issue("the answer before", str(issue)) for issue in issues]
            raise ReplayMiss(miss.model, miss.purpose, [*refused, *miss.differences]) from None
        raw, name = clean_answer(completion.text), completion.answered_by or llm.name
        issues = incompleteness(raw, is_cut_off=completion.is_cut_off, instead=completion.instead)
        if not issues:
            answer, issues = read(raw) if read else read_answer(raw, answer_type, checks)
            if answer is not None:
                return answer
        messages = (*question, *repair(raw, issues))
    raise AnswerError(name, prompt.purpose, issues, raw, attempts)


def clean_answer(text: str) -> str:
    """Return a model's text as it is read: whole characters, and no credentials."""
    return redact_keys(whole(text))


def incompleteness(raw: str, *, is_cut_off: bool, instead: str | None = None) -> list[Issue]:
    """Return the faults of an answer that has no text, or that a limit cut off before the end of its object.

    Args:
        raw: The text.
        is_cut_off: As for `Completion`.
        instead: As for `Completion`.
    """
    issues = []
    if not raw.strip():
        issues.append(ONLY.get(instead or "", EMPTY))
    if is_cut_off and not is_object(raw.encode()):
        issues.append(CUT_OFF)
    return issues


def speaker(llm: LLM) -> str:
    """Return the name of the model that produced the words; for a replay, the recorded model."""
    name = optional(llm, "speaks_for", None)
    return name if isinstance(name, str) else llm.name


def repair(raw: str, issues: Sequence[Issue]) -> tuple[Message, Message]:
    """Return the turns that quote an answer and ask for a better one."""
    faults = "\n".join(f"- {issue}" for issue in issues[:SHOWN_ISSUES])
    rest = len(issues) - SHOWN_ISSUES
    more = f"\n- and {rest} more" if rest > 0 else ""
    quoted = raw if len(raw) <= QUOTED else f"{raw[:QUOTED]} ..."
    return (
        Message(role="assistant", text=quoted.strip() or "(nothing)"),
        Message(
            role="user",
            text=f"That answer cannot be used:\n{faults}{more}\n\nMend these faults and answer "
            "again with the complete JSON object and nothing else.",
        ),
    )
