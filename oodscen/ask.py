"""Ask a language model one typed question and get a typed answer."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

import json_repair
from pydantic import BaseModel, ValidationError

from oodscen._data import issues_of
from oodscen.errors import AnswerError, Issue
from oodscen.messages import Message
from oodscen.prompts.base import Prompt
from oodscen.protocols import LLM, Request

Answer = TypeVar("Answer", bound=BaseModel)

ATTEMPTS = 3
"""How often a question is put before its answer counts as invalid, the first time included."""

SHOWN_ISSUES = 12
"""How many faults are fed back at once."""


def ask(
    llm: LLM,
    prompt: Prompt[Answer],
    sample: int = 0,
    *,
    check: Callable[[Answer], Sequence[Issue]] | None = None,
    attempts: int = ATTEMPTS,
) -> Answer:
    """Put a question; parse and validate the answer; feed faults back until it is valid.

    Args:
        llm: Who is asked.
        prompt: The typed question.
        sample: Which of several independent draws this is.
        check: Further requirements, beyond those of the prompt itself.
        attempts: Largest number of calls.

    Raises:
        AnswerError: When the last answer is still invalid; it keeps the raw text and the faults.
        LLMError: When the model cannot be reached.
    """
    messages = prompt.messages()
    schema = prompt.answer_schema()
    issues: list[Issue] = []
    raw = ""
    for attempt in range(1, attempts + 1):
        completion = llm.complete(Request(prompt, messages, schema, sample, attempt))
        raw = completion.text
        answer, issues = _read(raw, cast(type[Answer], prompt.answer))
        if answer is not None:
            issues = [*prompt.check(answer), *(check(answer) if check else ())]
            if not issues:
                return answer
        messages = (*messages, *_repair(raw, issues))
    raise AnswerError(llm.name, prompt.purpose, issues, raw, attempts)


def _read(raw: str, kind: type[Answer]) -> tuple[Answer | None, list[Issue]]:
    value = find_object(raw)
    if value is None:
        return None, [Issue("", "no JSON object was found in the answer")]
    try:
        return kind.model_validate(value), []
    except ValidationError as error:
        return None, issues_of(error)


def find_object(text: str) -> dict[str, Any] | None:
    """Find the JSON object in a model's words: in a fence, in prose, or with small faults.

    Returns:
        The last complete object, since models that think aloud answer at the end; `None` if
        there is none.
    """
    text = text.rpartition("</think>")[2]
    value = json_repair.loads(text, skip_json_loads=False) if "{" in text else None
    if isinstance(value, list):
        value = next((item for item in reversed(value) if isinstance(item, dict)), None)
    return value if isinstance(value, dict) else None


def _repair(raw: str, issues: Sequence[Issue]) -> tuple[Message, Message]:
    faults = "\n".join(f"- {issue}" for issue in issues[:SHOWN_ISSUES])
    rest = len(issues) - SHOWN_ISSUES
    more = f"\n- and {rest} more" if rest > 0 else ""
    return (
        Message(role="assistant", text=raw),
        Message(
            role="user",
            text=f"That answer cannot be used:\n{faults}{more}\n\nMend these faults and answer "
            "again with the complete JSON object and nothing else.",
        ),
    )
